"""The samples of the README and of the readers' guides, run in a fresh clone as their reader would."""

import os
import subprocess
import sys

import pytest

from tests.guides import ROOT, environment, follow, samples, shell

pytestmark = pytest.mark.drill
# Commands that take all there is are run on the first of it: a part of it is tested at length elsewhere.
SHORTER = {
    "README.md": {
        "make test ": "make --dry-run test ",
        '-m pytest -m "not drill"': "-m pytest tests/framework/test_arrays.py",
        "course bench --out": "course bench lut --out",
        "course stress ": "course stress vectors ",
        "course references verify ": "course references verify brdf_lut ",
        "course calibrate ": "course calibrate blend --seeds 1 ",
    },
    "docs/self_study.md": {"course bench split_sum": "course bench lut"},
    "notebooks/README.md": {"make notebooks ": "make --dry-run notebooks ", "build.py 03 07": "build.py 03"},
}


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """The course as it is committed, and submissions beside it."""
    folder = tmp_path_factory.mktemp("clone") / "course"
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(folder)], check=True)
    (folder / "submissions" / "amy").mkdir(parents=True)
    released = folder / "assignments" / "sphere_tracing" / "sphere_tracing.ipynb"
    (folder / "submissions" / "amy" / "sphere_tracing.ipynb").write_bytes(released.read_bytes())
    return folder


@pytest.fixture(scope="module")
def reader(clone):
    """The environment of somebody who has just cloned it and has set it up once, by make."""
    path = os.pathsep.join([os.path.join(sys.base_prefix, "bin"), os.environ["PATH"]])
    set_up = environment(PATH=path)
    follow(["make .venv/ready"], clone, set_up, seconds=600)
    return set_up | {"PATH": f"{clone}/.venv/bin{os.pathsep}{path}"}


def shortened(page, blocks):
    """The blocks with the page's long commands on a part of what they take; each of these stands on the page."""
    for whole, part in SHORTER[page].items():
        assert any(whole in block for block in blocks), whole
        blocks = [block.replace(whole, part) for block in blocks]
    return blocks


@pytest.mark.parametrize("page", ["README.md", "docs/self_study.md", "notebooks/README.md"])
def test_the_commands_of_a_page_work(page, clone, reader):
    blocks = shortened(page, shell(page))
    follow([block.replace("python -m venv .venv\n", "") for block in blocks], clone, reader, seconds=1500)


@pytest.mark.parametrize("page", ["README.md", "docs/self_study.md"])
def test_the_notebooks_that_a_page_opens_are_there(page, clone, reader):
    (command,) = shell(page, "stays")
    assert command.startswith("jupyter lab ")
    assert (clone / command.split()[-1]).is_file()


def test_the_program_of_the_guide_draws_its_picture(clone, reader):
    (program,) = [s.text for s in samples("docs/self_study.md") if s.language == "python"]
    (clone / "program.py").write_text(program)
    said = follow(["python program.py"], clone, reader)
    assert "skipped" in said and (clone / "penumbra.png").stat().st_size > 2000
