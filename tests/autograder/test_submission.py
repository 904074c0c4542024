"""Reading a stranger's notebook: a submission, or one plain sentence that says why not."""

import copy
import json
import os

import nbformat
import pytest

from autograder import submission
from autograder.samples import filled_notebook
from autograder.submission import Rejected, read

NAME = "sphere_tracing"


@pytest.fixture
def notebook():
    """A complete submission as plain data, to be damaged."""
    return json.loads(nbformat.writes(filled_notebook(NAME)))


@pytest.fixture
def handed_in(tmp_path):
    """Reads data, text or bytes as a file of this name."""

    def run(content, name=f"{NAME}.ipynb"):
        if isinstance(content, dict):
            content = json.dumps(content)
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8", "surrogatepass"))
        return read(path)

    return run


@pytest.fixture
def refused(handed_in):
    """The sentence with which a file is refused."""

    def run(content, **how):
        with pytest.raises(Rejected) as said:
            handed_in(content, **how)
        sentence = str(said.value)
        assert sentence and len(sentence) < 200 and "\n" not in sentence
        return sentence

    return run


def cell_of(notebook, grade_id):
    return next(c for c in notebook["cells"] if c["metadata"].get("nbgrader", {}).get("grade_id") == grade_id)


def test_the_solution_cells_are_read_in_the_released_order(notebook, handed_in):
    notebook["cells"].reverse()
    found = handed_in(notebook)
    assert list(found.cells) == list(submission.release_of(NAME).cells)
    assert found.changed == frozenset(found.cells)


def test_the_released_notebook_is_unchanged_everywhere(handed_in):
    released = (submission.ROOT / "assignments" / NAME / f"{NAME}.ipynb").read_bytes()
    found = handed_in(released)
    assert found.changed == frozenset() and found.assignment == NAME and found.version


def test_blanks_alone_are_no_change(handed_in):
    notebook = json.loads((submission.ROOT / "assignments" / NAME / f"{NAME}.ipynb").read_bytes())
    cell = cell_of(notebook, "blend")
    cell["source"] = "\r\n\r\n".join("".join(cell["source"]).split("\n")) + "   \n\n"
    assert handed_in(notebook).changed == frozenset()


def test_nothing_but_solution_cells_is_taken(notebook, handed_in):
    notebook["cells"].insert(
        0, {"cell_type": "code", "metadata": {}, "source": "raise SystemExit", "outputs": []}
    )
    for cell in notebook["cells"]:
        if cell["metadata"].get("nbgrader", {}).get("grade"):
            cell["source"] = "score = 100"
    assert not any("score = 100" in s or "SystemExit" in s for s in handed_in(notebook).cells.values())


def test_a_cell_that_was_split_is_put_together_in_order(notebook, handed_in):
    cell = cell_of(notebook, "blend")
    second, place = copy.deepcopy(cell), notebook["cells"].index(cell)
    cell["source"], second["source"] = "half = 0.5", "def blend(d1, d2, t):\n    return d1"
    notebook["cells"].insert(place + 1, second)
    assert handed_in(notebook).cells["blend"] == "half = 0.5\n\ndef blend(d1, d2, t):\n    return d1"


def test_of_a_cell_that_was_copied_the_later_one_is_run_later(notebook, handed_in):
    later = copy.deepcopy(cell_of(notebook, "blend"))
    later["source"] = "blend = None"
    notebook["cells"].append(later)
    assert handed_in(notebook).cells["blend"].endswith("\n\nblend = None")


def test_a_missing_cell_leaves_the_others(notebook, handed_in):
    notebook["cells"].remove(cell_of(notebook, "blend"))
    found = handed_in(notebook)
    assert "blend" not in found.cells and "sdf_box" in found.cells


def test_a_solution_turned_to_text_is_a_missing_cell(notebook, handed_in):
    cell_of(notebook, "blend")["cell_type"] = "markdown"
    assert "blend" not in handed_in(notebook).cells


def test_magics_and_syntax_errors_are_kept_as_they_are(notebook, handed_in):
    source = "%matplotlib inline\n!rm -rf /\ndef blend(:"
    cell_of(notebook, "blend")["source"] = source
    assert handed_in(notebook).cells["blend"] == source


@pytest.mark.parametrize(
    ("source", "text"),
    [
        ("a = 1\nb = 2", "a = 1\nb = 2"),
        (["a = 1\n", "b = 2"], "a = 1\nb = 2"),
        (["a = 1\n", 5, None, "b = 2"], "a = 1\nb = 2"),
        ([], ""),
        (None, ""),
        (7, ""),
        ({"a": 1}, ""),
        ("\ud800 \x00", "\ud800 \x00"),
    ],
    ids=["text", "list", "mixed", "empty", "null", "number", "object", "surrogate"],
)
def test_a_source_is_text_or_a_list_of_it(notebook, handed_in, source, text):
    cell_of(notebook, "blend")["source"] = source
    assert handed_in(notebook).cells["blend"] == text


def test_a_byte_order_mark_does_no_harm(notebook, handed_in):
    assert handed_in(b"\xef\xbb\xbf" + json.dumps(notebook).encode()).assignment == NAME


ODD = [None, True, 3, "text", [], ["nbgrader"], {}, {"a": []}]


@pytest.mark.parametrize("odd", ODD, ids=repr)
@pytest.mark.parametrize(
    "place", ["metadata", "course", "assignment", "version", "cell", "nbgrader", "grade_id", "type"]
)
def test_odd_types_anywhere_cost_at_most_the_cell_that_has_them(notebook, handed_in, place, odd):
    cell = cell_of(notebook, "blend")
    if place == "metadata":
        notebook["metadata"] = odd
    elif place == "course":
        notebook["metadata"]["course"] = odd
    elif place in ("assignment", "version"):
        notebook["metadata"]["course"][place] = odd
    elif place == "cell":
        notebook["cells"][notebook["cells"].index(cell)] = odd
    elif place == "nbgrader":
        cell["metadata"]["nbgrader"] = odd
    elif place == "grade_id":
        cell["metadata"]["nbgrader"]["grade_id"] = odd
    else:
        cell["cell_type"] = odd
    found = handed_in(notebook)
    assert found.assignment == NAME and "sdf_box" in found.cells
    assert isinstance(found.version, str) and len(found.version) <= 40


def test_a_long_or_strange_version_is_cut_to_plain_text(notebook, handed_in):
    notebook["metadata"]["course"]["version"] = "1.\ud800é" + "9" * 100_000
    assert handed_in(notebook).version.startswith("1.??99") and len(handed_in(notebook).version) == 40


def test_the_metadata_decides_before_the_name_of_the_file(notebook, handed_in, refused):
    assert handed_in(notebook, name="homework (3).ipynb").assignment == NAME
    notebook["metadata"]["course"]["assignment"] = "../../etc/passwd"
    assert handed_in(notebook).assignment == NAME
    assert "which assignment" in refused(notebook, name="homework.ipynb")


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x00" * 100,
        b"{",
        b"[]",
        b"null",
        b'"text"',
        b"{}",
        b'{"cells": {}}',
        b'{"cells": null, "metadata": {}}',
        b'{"worksheets": [{"cells": []}], "metadata": {}, "nbformat": 3}',
        b"\xff\xfe{\x00}\x00",
        b"PK\x03\x04" + bytes(range(256)),
        b"1" * 10_000,
        b"[" * 200_000,
        b'{"cells": ' + b"[" * 100_000 + b"]" * 100_000 + b"}",
        b'{"metadata": ' + b'{"a": ' * 100_000,
    ],
    ids=lambda content: repr(content[:20]),
)
def test_what_is_no_notebook_is_refused_in_one_sentence(refused, content):
    assert "not a notebook" in refused(content)


def test_a_notebook_without_solution_cells_is_refused(refused):
    assert "none of the assignment's solution cells" in refused({"cells": [], "metadata": {}})


def test_a_huge_file_is_refused_before_it_is_parsed(refused):
    assert "larger than 30 MB" in refused(b'{"cells": "' + b"x" * submission.MAX_BYTES)


def test_links_folders_and_pipes_are_refused(tmp_path, notebook):
    real = tmp_path / "real.ipynb"
    real.write_text(json.dumps(notebook))
    (tmp_path / "link.ipynb").symlink_to(real)
    (tmp_path / "folder.ipynb").mkdir()
    os.mkfifo(tmp_path / "pipe.ipynb")
    for name in ("link", "folder", "pipe", "absent"):
        with pytest.raises(Rejected, match="not a regular file"):
            read(tmp_path / f"{name}.ipynb")


def test_the_same_bytes_have_the_same_hash(notebook, handed_in):
    assert handed_in(notebook, name="a.ipynb").sha256 == handed_in(notebook, name="b.ipynb").sha256
