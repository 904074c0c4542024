"use strict";
// Without this script the pictures stand side by side; with it, yours lies over what is expected.
for (const group of document.querySelectorAll(".pictures")) {
  const slider = group.querySelector(".slider"), images = ["yours", "reference"].map((kind) => group.querySelector(`.${kind} img`));
  if (!slider || !images.every(Boolean)) continue;
  const stack = slider.querySelector(".stack"), range = slider.querySelector("input");
  stack.prepend(...images.map((image) => image.cloneNode()));
  const show = () => {
    stack.style.setProperty("--at", `${range.value}%`);
    range.setAttribute("aria-valuetext", `yours left of ${range.value} percent of the width, expected right of it`);
  };
  const drag = (event) => {
    if (!event.buttons) return;
    const edges = stack.getBoundingClientRect();
    range.value = Math.round((100 * (event.clientX - edges.left)) / edges.width);
    show();
  };
  range.addEventListener("input", show);
  stack.addEventListener("pointerdown", (event) => { stack.setPointerCapture(event.pointerId); drag(event); });
  stack.addEventListener("pointermove", drag);
  show();
  slider.hidden = false;
  group.classList.add("sliding");
}
const closed = () => [...document.querySelectorAll("details:not([open])")];
let opened = [];
addEventListener("beforeprint", () => { for (const part of (opened = closed())) part.open = true; });
addEventListener("afterprint", () => { for (const part of opened) part.open = false; });
