"""The pages in a real browser: on a phone and a desk, in the dark, without a network, and under attack."""

import importlib.util
import json
import re
import time
from pathlib import Path

import pytest

from autograder.report import write_grades, write_index, write_page

pytestmark = pytest.mark.drill
_SPEC = importlib.util.spec_from_file_location(
    "report_samples", Path(__file__).parents[1] / "autograder" / "report_samples.py"
)
samples = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(samples)

CONTRAST = """() => {
  const linear = (v) => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  const light = (c) => { const [r, g, b] = c.map(linear); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const parse = (text) => text.match(/[\\d.]+/g).map(Number);
  const ground = (node) => {
    const c = parse(getComputedStyle(node).backgroundColor);
    return c.length < 4 || c[3] > 0 ? c.slice(0, 3) : ground(node.parentElement);
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), faint = [];
  while (walker.nextNode()) {
    const node = walker.currentNode.parentElement;
    if (!walker.currentNode.data.trim() || ["STYLE", "SCRIPT"].includes(node.tagName)) continue;
    const [a, b] = [light(parse(getComputedStyle(node).color).slice(0, 3)), light(ground(node))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) faint.push([walker.currentNode.data.trim().slice(0, 40), ratio]);
  }
  return faint;
}"""


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """An output directory with every status, pictures, an evil result and names that are hard to lay out."""
    out = tmp_path_factory.mktemp("out")
    checks = samples.sample_checks()
    for check in checks[:3]:
        check["images"] = samples.paint(out / "pages" / "amy" / "sphere_tracing", check["id"])
    evil = samples.poison(samples.result(checks=samples.sample_checks())) | {"status": "graded"}
    evil["checks"][5]["traceback"] = samples.EVIL * 20
    long = samples.result("W" * 3000, checks=[samples.check("1.1", "f" * 90, "fail", 0, message="y" * 3000)])
    long["checks"][0] |= {
        "traceback": "z" * 3000,
        "likely_mistake": "m" * 900,
        "measures": samples.MISTAKE["measures"],
    }
    weak = samples.result("bob", "soft_shadows", [samples.check("2.1", "safe_angle")], isolation="subprocess")
    amy = samples.result("amy", checks=checks)
    for folder, data in {"amy": amy, "evil": evil, "long": long, "bob": weak}.items():
        path = samples.store(out, data | {"assignment": "sphere_tracing"}, folder)
        write_page(data, path, out)
    (out / "results" / "bob" / "broken.json").write_text("{")
    write_index(out)
    return out


def pages(out):
    return [out / "index.html", *sorted((out / "pages").glob("*/*.html"))]


def visit(browser, path, width=1280, scheme="light", javascript=True):
    """An open page, with what it logged and asked the network for."""
    context = browser.new_context(
        viewport={"width": width, "height": 900}, color_scheme=scheme, java_script_enabled=javascript
    )
    page = context.new_page()
    page.complaints, page.asked = [], []
    page.on("console", lambda message: page.complaints.append(message.text))
    page.on("pageerror", lambda error: page.complaints.append(str(error)))
    page.on("dialog", lambda dialog: (page.complaints.append("a dialog"), dialog.dismiss()))
    page.on("request", lambda request: page.asked.append(request.url))
    page.goto(path.as_uri())
    return page


@pytest.mark.parametrize("width", [320, 400, 768, 1280])
def test_no_page_is_wider_than_its_window(browser, out, width):
    for path in pages(out):
        page = visit(browser, path, width)
        page.evaluate("document.querySelectorAll('details').forEach((d) => (d.open = true))")
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (path, width)
        page.context.close()


def test_pictures_load_at_a_whole_zoom(browser, out):
    page = visit(browser, out / "pages" / "amy" / "sphere_tracing.html", 400)
    sizes = page.evaluate(
        "[...document.images].map((i) => [i.naturalWidth, i.getBoundingClientRect().width])"
    )
    assert sorted({width for _, width in sizes}) == [0, 256]  # yours and expected lie hidden below the slider
    assert len(sizes) == 15 and sum(width == 256 for _, width in sizes) == 9
    page.context.close()


def test_nothing_runs_complains_or_asks_the_network(browser, out):
    for path in pages(out):
        page = visit(browser, path)
        page.wait_for_timeout(100)
        assert page.complaints == [] and [u for u in page.asked if not u.startswith("data:")] == [
            path.as_uri()
        ]
        page.context.close()


def test_the_policy_stops_a_script_that_got_into_the_markup(browser, out, tmp_path):
    for source in (out / "pages" / "amy" / "sphere_tracing.html", out / "index.html"):
        broken = tmp_path / source.name
        attack = (
            "<script>document.title = 'run'</script><img src=x onerror=\"document.title = 'run'\"></main>"
        )
        broken.write_text(source.read_text(encoding="utf-8").replace("</main>", attack), encoding="utf-8")
        page = visit(browser, broken)
        page.wait_for_timeout(100)
        assert page.title() != "run" and any("Content Security Policy" in text for text in page.complaints)
        page.context.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_all_text_stands_out_from_its_ground_by_4_5_to_1(browser, out, scheme):
    for path in pages(out):
        page = visit(browser, path, scheme=scheme)
        assert page.evaluate(CONTRAST) == [], path
        page.context.close()


def test_the_index_sorts_and_filters_by_keyboard_and_is_whole_without_its_script(browser, out):
    page = visit(browser, out / "index.html")
    page.get_by_role("button", name="Score").focus()
    page.keyboard.press("Enter")
    visible = "[...document.querySelectorAll('tbody tr')].filter((row) => row.offsetParent)"
    shown = f"{visible}.map((row) => row.cells[3].dataset.v)"
    up = page.evaluate(shown)
    assert up == sorted(up, key=float) and len(up) == 5
    page.keyboard.press("Enter")
    assert page.evaluate(shown) == up[::-1]
    assert page.locator("[aria-sort=descending]").inner_text().startswith("Score")
    page.get_by_label("Filter").fill("BOB unread")
    assert len(page.evaluate(shown)) == 1 and page.locator("output").inner_text() == "1 of 5"
    page.context.close()
    page = visit(browser, out / "index.html", javascript=False)
    assert page.locator("tbody tr").count() == 5 and not page.get_by_label("Filter").is_visible()
    page.context.close()


def test_a_screen_reader_hears_verdicts_pictures_and_marks(browser, out):
    page = visit(browser, out / "pages" / "amy" / "sphere_tracing.html")
    tree = page.locator("body").aria_snapshot()
    for words in (
        'link "1.2 Partial"',
        'region "1.6 estimate_normal"',
        'img "Expected: A slice',
        "within it",
        "Timeout",
    ):
        assert words in tree, words
    page.context.close()
    page = visit(browser, out / "index.html", 400)
    tree = page.locator("body").aria_snapshot()
    assert 'img "1.1 pass, 1.2 partial, 1.3 fail, 1.4 not attempted' in tree and "row" in tree
    page.context.close()


def test_a_page_prints_on_few_sheets_in_ink_on_white(browser, out):
    page = visit(browser, out / "pages" / "amy" / "sphere_tracing.html", scheme="dark")
    sheets = re.findall(rb"/Type\s*/Page\b", page.pdf(format="A4"))
    assert 2 <= len(sheets) <= 5
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert page.evaluate("getComputedStyle(document.body).color") == "rgb(28, 33, 39)"
    page.context.close()


def test_ten_thousand_results_are_written_in_30_s_and_still_open(browser, tmp_path):
    checks = [samples.check(f"1.{i}", "sdf_sphere", "pass") for i in range(1, 8)]
    body = json.dumps(samples.result("NAME", checks=checks))
    for i in range(10_000):
        folder = tmp_path / "results" / f"student{i:05d}"
        folder.mkdir(parents=True)
        (folder / "sphere_tracing.json").write_text(body.replace("NAME", folder.name))
    start = time.monotonic()
    write_index(tmp_path)
    write_grades(tmp_path)
    assert time.monotonic() - start < 30
    page = visit(browser, tmp_path / "index.html")
    page.get_by_label("Filter").fill("student09999")
    assert page.locator("output").inner_text() == "1 of 10000"
    page.context.close()
