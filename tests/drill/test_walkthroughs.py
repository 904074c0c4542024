"""Every walkthrough executes from its script, and opens in JupyterLab with its pictures and a slider that draws."""

import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

from framework import compiled
from notebooks import build

pytestmark = pytest.mark.drill

# Nine of them are to take six minutes on two free cores; what is bound here is what nobody would wait for.
SECONDS_A_WALKTHROUGH = 240


@pytest.fixture(scope="module", autouse=True)
def kernels():
    """Compiled before, or the first walkthrough would say on stderr that it compiles."""
    if not compiled.is_complete():
        compiled.prepare()


def pictures_in(notebook):
    """How many pictures its cells left behind."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return sum("image/png" in output.get("data", {}) for output in outputs)


@pytest.mark.parametrize("source", build.sources(), ids=lambda source: source.stem)
def test_it_executes_without_a_complaint(source, tmp_path):
    notebook = build.read(source)
    begun = time.monotonic()
    build.execute(notebook, source.stem, tmp_path)
    seconds = time.monotonic() - begun
    print(f"{source.stem}: {seconds:.0f} s")
    assert seconds < SECONDS_A_WALKTHROUGH
    assert pictures_in(notebook) == pictures_in(build.nbformat.read(source.with_suffix(".ipynb"), as_version=4)) > 0


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """The address of a JupyterLab that serves a copy of the walkthroughs."""
    folder = tmp_path_factory.mktemp("lab")
    for path in build.HERE.glob("*.ipynb"):
        shutil.copy(path, folder)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = subprocess.Popen(
        [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", f"--port={port}",
         "--IdentityProvider.token=", "--ServerApp.password="],
        cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env=os.environ | {"JUPYTER_CONFIG_DIR": str(folder / "config"), "PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin"},
    )  # fmt: skip
    address = f"http://127.0.0.1:{port}"
    try:
        for _ in range(240):
            assert server.poll() is None, "JupyterLab ended"
            try:
                urllib.request.urlopen(f"{address}/api/status", timeout=2).close()
                break
            except OSError:
                time.sleep(0.25)
        yield address
    finally:
        server.terminate()
        server.wait(20)


LOADED = """() => [...document.querySelectorAll('.jp-OutputArea img')].map(
  (image) => image.complete && image.naturalWidth > 0)"""


@pytest.mark.parametrize("source", build.sources(), ids=lambda source: source.stem)
def test_it_opens_in_jupyterlab_with_its_pictures_and_a_slider_changes_one(source, lab, browser, tmp_path):
    pictures = pictures_in(build.nbformat.read(source.with_suffix(".ipynb"), as_version=4))
    # A page as high as the notebook: JupyterLab draws only the cells that are in sight.
    page = browser.new_page(viewport={"width": 1280, "height": 30_000})
    try:
        page.goto(f"{lab}/lab/workspaces/{source.stem}/tree/{source.stem}.ipynb")  # no tabs of others
        page.locator(".jp-OutputArea img").first.wait_for(timeout=60_000)
        page.wait_for_function(f"document.querySelectorAll('.jp-OutputArea img').length >= {pictures}", timeout=60_000)
        page.wait_for_function(f"({LOADED})().every(Boolean)", timeout=60_000)
        assert page.locator(".jp-RenderedMarkdown img").evaluate_all("all => all.every((i) => i.naturalWidth > 0)")

        page.get_by_role("menuitem", name="Run", exact=True).click()
        page.get_by_text("Run All Cells", exact=True).click()
        drawn = page.locator(".widget-image").first
        drawn.wait_for(timeout=SECONDS_A_WALKTHROUGH * 1000)
        page.wait_for_function("document.querySelector('.widget-image').naturalWidth > 0")
        before = pixels(drawn)
        handle = page.locator(".widget-slider .noUi-handle").first
        handle.focus()
        for _ in range(4):
            page.keyboard.press("ArrowRight")
        page.wait_for_function("(old) => document.querySelector('.widget-image').src !== old", arg=before[0], timeout=60_000)
        page.wait_for_function("document.querySelector('.widget-image').complete")
        page.wait_for_timeout(500)
        assert pixels(drawn)[1] != before[1]
        drawn.screenshot(path=tmp_path / "moved.png")
        print(tmp_path / "moved.png")
    finally:
        page.close()


def pixels(image):
    """Where an image element's picture lies, and the picture."""
    return image.evaluate("""(image) => {
      const canvas = Object.assign(document.createElement('canvas'), {width: image.naturalWidth, height: image.naturalHeight});
      canvas.getContext('2d').drawImage(image, 0, 0);
      return [image.src, canvas.toDataURL()];
    }""")
