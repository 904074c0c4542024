"""The site, built and opened from disk in a browser at the widths of a laptop and of a phone."""

import subprocess
import sys

import pytest

from tests.guides import ROOT

pytestmark = pytest.mark.drill
PAGES = ("index.html", "notebooks/03_soft_shadows.html", "docs/glossary.html", "reference/2.html")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    out = tmp_path_factory.mktemp("site") / "site"
    command = [sys.executable, "docs/site/build.py", "--out", str(out)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=400)
    assert done.returncode == 0, done.stderr[-3000:]
    return out


@pytest.fixture
def open_page(browser, site, request):
    """Opens a page at a width; afterwards nothing was asked of the network, and nothing failed."""
    complaints, contexts = [], []

    def go(name, width):
        page = browser.new_page(viewport={"width": width, "height": 900})
        contexts.append(page)
        page.on("request", lambda r: r.url.startswith("http") and complaints.append(r.url))
        page.on("requestfailed", lambda r: complaints.append(r.url))
        page.on("console", lambda m: m.type in ("error", "warning") and complaints.append(m.text))
        page.goto((site / name).as_uri())
        return page

    yield go
    for page in contexts:
        page.close()
    assert complaints == []


@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("name", PAGES)
def test_a_page_fits_its_screen_and_shows_its_pictures(name, width, open_page):
    page = open_page(name, width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate("[...document.images].filter(i => !(i.complete && i.naturalWidth)).map(i => i.src)") == []
    menu = page.locator(".mobile-header .nav-overlay-icon, .mobile-header label[for='__navigation']").first
    assert menu.is_visible() == (width < 500)
    assert page.locator("h1").first.is_visible()


def test_a_walkthrough_has_its_pictures_and_its_mathematics(open_page):
    page = open_page("notebooks/03_soft_shadows.html", 1280)
    assert page.locator("div.cell_output img").count() >= 5
    assert page.locator("svg.mathematics").count() >= 20
    assert "\\frac" not in page.inner_text("article")


def test_answers_are_folded_and_open(open_page):
    page = open_page("notebooks/03_soft_shadows.html", 390)
    answer = page.locator("details").first
    inside = answer.locator("p").first
    assert not inside.is_visible()
    answer.locator("summary").click()
    assert inside.is_visible()


def test_the_search_finds_a_word_from_disk(open_page):
    page = open_page("index.html", 1280)
    page.fill("input[name=q]", "penumbra")
    page.keyboard.press("Enter")
    page.wait_for_selector("#search-results li:has-text('Glossary') a")  # results come one after the other
    assert "penumbra" in page.inner_text("#search-results").lower()
