"""Graded pages as all kinds of readers have them: by axe-core's rules, by keyboard, without a script, on paper."""

import importlib.util
from pathlib import Path

import pytest

from autograder import cli

pytestmark = pytest.mark.drill
_SPEC = importlib.util.spec_from_file_location(
    "five_notebooks", Path(__file__).parents[1] / "autograder" / "five_notebooks.py"
)
five = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(five)


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    out = tmp_path_factory.mktemp("five")
    five.write(out / "submissions")
    limits = ["--allow-weak-isolation", "--call-cpu-seconds", "1"]
    assert cli.main(["grade", str(out / "submissions"), "--out", str(out / "graded"), *limits]) == 0
    assert cli.main(["report", str(out / "graded"), "--submissions", str(out / "submissions")]) == 0
    return out / "graded"


def opened(browser, path, **options):
    context = browser.new_context(**options)
    page = context.new_page()
    page.goto(path.as_uri())
    return page


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [360, 1280])
@pytest.mark.parametrize("kind", [*five.WRONG, "index", "report"])
def test_no_page_breaks_a_rule_of_axe_core(browser, axe, graded, kind, width, scheme):
    path = graded / f"{kind}.html" if kind not in five.WRONG else next((graded / "pages" / kind).glob("*.html"))
    page = opened(browser, path, viewport={"width": width, "height": 900}, color_scheme=scheme)
    page.evaluate("document.querySelectorAll('details').forEach((d) => (d.open = true))")
    assert axe(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert path.stat().st_size < 2_000_000
    page.context.close()


def test_axe_core_finds_a_picture_without_words(browser, axe, graded):
    page = opened(browser, graded / "pages" / "mistake" / "soft_shadows.html")
    page.evaluate("document.querySelector('.difference img').removeAttribute('alt')")
    assert [finding for finding in axe(page) if "image-alt" in finding]
    page.context.close()


def test_the_border_between_yours_and_expected_moves_by_keyboard_and_by_dragging(browser, graded):
    page = opened(browser, graded / "pages" / "mistake" / "soft_shadows.html")
    border = page.get_by_role("slider", name="task 2.2")
    at = "() => getComputedStyle(document.querySelector('#task-2\\\\.2 .stack')).getPropertyValue('--at')"
    border.focus()
    for key, place in {"ArrowRight": "51%", "Home": "0%", "End": "100%"}.items():
        page.keyboard.press(key)
        assert page.evaluate(at) == place
    assert border.get_attribute("aria-valuetext").startswith("yours left of 100 percent")
    stack = page.locator("[id='task-2.2'] .stack")
    stack.scroll_into_view_if_needed()
    box = stack.bounding_box()
    page.mouse.move(box["x"] + 0.75 * box["width"], box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + 50)
    page.mouse.up()
    assert page.evaluate(at) == "25%"
    page.context.close()


def test_without_its_script_the_three_pictures_stand_side_by_side(browser, graded):
    page = opened(browser, graded / "pages" / "mistake" / "soft_shadows.html", java_script_enabled=False)
    card = page.locator("[id='task-2.2']")
    places = [card.locator(f".{kind} img").bounding_box() for kind in ("yours", "reference", "difference")]
    assert len({place["y"] for place in places}) == 1 and len({place["x"] for place in places}) == 3
    assert not card.locator(".slider").is_visible()
    page.context.close()


def test_on_paper_all_is_open_and_the_three_pictures_stand_side_by_side(browser, graded):
    page = opened(browser, graded / "pages" / "mistake" / "soft_shadows.html")
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    card = page.locator("[id='task-2.1']")
    places = [card.locator(f".{kind} img").bounding_box() for kind in ("yours", "reference", "difference")]
    assert len({place["y"] for place in places}) == 1
    assert not card.locator(".slider").is_visible() and card.locator(".measures").is_visible()
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.locator("details[open]").count() == 0
    page.context.close()
