"""Builds the site: walkthroughs, guides and the reference of the public API as pages that work from disk.

    make site       out/site/index.html

Nothing is executed: the walkthroughs' pictures are those in the notebooks. A warning of Sphinx's stops the build, and so
does a link or a picture that leads nowhere.
"""

import argparse
import importlib
import inspect
import re
import shutil
import sys
import tempfile
from pathlib import Path

import links
import nbformat
from sphinx.cmd.build import build_main

from autograder.checks import ASSIGNMENTS

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
COPIED = ("README.md", "LICENSE", "docs", "notebooks", "benchmarks/README.md", "assignments")
GUIDES = ("student", "self_study", "instructor", "architecture", "glossary")
# the reference: a page each, with the modules whose public names it describes
REFERENCE = {
    "Vectors, sampling, colours": ("framework.arrays", "framework.sampling", "framework.ggx", "framework.metrics"),
    "Images and environments": ("framework.image", "framework.environment", "framework.environment_light", "framework.skies"),
    "Distance fields": ("framework.sdf",),
    "Meshes, cameras, rasterising": ("framework.mesh", "framework.camera", "framework.raster"),
    "Scenes and their pictures": ("framework.scene", "framework.scene_file", "framework.plan", "framework.render"),
    "Showing": ("framework.show", "framework.interact", "framework.plane"),
    "What the assignments ask for": tuple(f"solutions.{name}" for name in ASSIGNMENTS),
    "Compiled twins": ("solutions.fast",),
}  # fmt: skip


def build(out, sources):
    """Build the site.

    Parameters
    ----------
    out : Path          its folder; what is there is replaced
    sources : Path      an empty folder, where its pages are laid out

    Returns
    -------
    list of str         what is wrong with it; empty where all is well
    """
    for name in COPIED:
        _copy(ROOT / name, sources / name)
    _announced(sources / "notebooks")
    _front_page(sources)
    _reference(sources / "reference")
    shutil.rmtree(out, ignore_errors=True)
    doctrees = sources.with_name("doctrees")
    if build_main(["-W", "--keep-going", "-q", "-b", "html", "-c", str(HERE), "-d", str(doctrees), str(sources), str(out)]):
        return ["Sphinx found something, see above"]
    (out / ".buildinfo").unlink(missing_ok=True)
    shutil.copyfile(out / "README.html", out / "index.html")
    return links.problems(out)


def _copy(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, target, ignore=shutil.ignore_patterns("*.py", "__pycache__", ".*", "site"))
    else:
        shutil.copyfile(source, target)


def _announced(folder):
    """A walkthrough that the overview names and nobody has written yet gets a page that says so."""
    for name in re.findall(r"`(\d\d_\w+)`", (folder / "README.md").read_text(encoding="utf-8")):
        if not (folder / f"{name}.ipynb").exists():
            print(f"site: {name} is announced, and not written yet", file=sys.stderr)
            title = f"# {int(name[:2])} · {name[3:].replace('_', ' ').capitalize()}\n\nThis walkthrough is not written yet."
            page = nbformat.v4.new_notebook(cells=[nbformat.v4.new_markdown_cell(title)])
            nbformat.write(page, folder / f"{name}.ipynb")


def _front_page(sources):
    """The README is the front page; what a viewer of repositories need not see is added here."""
    walks = sorted(path.with_suffix("").name for path in (sources / "notebooks").glob("*.ipynb"))
    guides = [name for name in GUIDES if (sources / "docs" / f"{name}.md").is_file()]
    trees = {
        "Walkthroughs": ["notebooks/README", *(f"notebooks/{name}" for name in walks)],
        "Guides": [*(f"docs/{name}" for name in guides), "benchmarks/README"],
        "Assignments": [f"assignments/{name}/{name}" for name in ASSIGNMENTS],
        "Reference": [f"reference/{number}" for number in range(len(REFERENCE))],
    }
    parts = [f"```{{toctree}}\n:hidden:\n:caption: {name}\n\n" + "\n".join(pages) + "\n```" for name, pages in trees.items()]
    page = sources / "README.md"
    page.write_text("\n\n".join([page.read_text(encoding="utf-8"), *parts]), encoding="utf-8")


def _reference(folder):
    folder.mkdir()
    for number, (title, modules) in enumerate(REFERENCE.items()):
        lines = [title, "=" * len(title), ""]
        for name in modules:
            module = importlib.import_module(name)
            lines += [f"``{name}``", "-" * (len(name) + 4), "", f".. automodule:: {name}", "   :no-members:", ""]
            for member in _public(module):
                kind = "class" if inspect.isclass(getattr(module, member)) else "function"
                lines += [f".. auto{kind}:: {name}.{member}", *(["   :members:"] if kind == "class" else []), ""]
        (folder / f"{number}.rst").write_text("\n".join(lines), encoding="utf-8")


def _public(module):
    """Functions and classes of a module that have no underscore and are not from elsewhere."""
    names = getattr(module, "__all__", None) or [
        name for name, value in vars(module).items()
        if getattr(value, "__module__", None) == module.__name__ and not name.startswith("_")
    ]  # fmt: skip
    return [name for name in names if callable(getattr(module, name))]


def main(arguments=None):
    """Build it, say where it is."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", metavar="DIR", type=Path, default=ROOT / "out" / "site", help="default: out/site")
    out = parser.parse_args(arguments).out.resolve()
    with tempfile.TemporaryDirectory() as folder:
        found = build(out, Path(folder).resolve() / "pages")
    for problem in found:
        print(f"site: {problem}", file=sys.stderr)
    if not found:
        print(f"{sum(1 for _ in out.rglob('*.html'))} pages; open {out / 'index.html'}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
