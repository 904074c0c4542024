"use strict";
// Without this script the table is whole, sorted by student; with it, it can be filtered and sorted.
const body = document.querySelector("tbody"), heads = [...document.querySelectorAll("thead th:not(.plain)")];
const entries = [...body.rows].map((row, place) => ({
  row, place, text: [...row.cells].slice(0, 3).map((cell) => cell.textContent).join(" ").toLowerCase(),
  keys: [...row.cells].slice(0, 4).map((cell) => ("v" in cell.dataset ? Number(cell.dataset.v) : cell.textContent.toLowerCase())),
}));

const box = document.getElementById("filter"), shown = document.querySelector("output");
function filter() {
  const words = box.value.toLowerCase().split(/\s+/).filter(Boolean);
  let count = 0;
  for (const { row, text } of entries) {
    row.hidden = !words.every((word) => text.includes(word));
    count += !row.hidden;
  }
  shown.textContent = words.length ? `${count} of ${entries.length}` : "";
}
box.closest(".find").hidden = false;
box.addEventListener("input", filter);
filter();

function sort(column, down) {
  const order = (a, b) => (a.keys[column] < b.keys[column] ? -1 : a.keys[column] > b.keys[column] ? 1 : 0);
  entries.sort((a, b) => (down ? -order(a, b) : order(a, b)) || a.place - b.place);
  const sorted = document.createDocumentFragment();
  for (const { row } of entries) sorted.append(row);
  body.append(sorted);
  heads.forEach((head, i) => (i === column ? head.setAttribute("aria-sort", down ? "descending" : "ascending") : head.removeAttribute("aria-sort")));
}
heads.forEach((head, column) => {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = head.textContent;
  button.addEventListener("click", () => sort(column, head.getAttribute("aria-sort") === "ascending"));
  const printed = document.createElement("span"); // browsers leave buttons out of headings repeated on paper
  printed.className = "printed";
  printed.textContent = head.textContent;
  head.replaceChildren(button, printed);
});
heads[0].setAttribute("aria-sort", "ascending");
