"""The walkthroughs as they are committed: built from their scripts as they stand, whole, with pictures and no complaint."""

import json
import re

import nbformat
import pytest

from notebooks import build

HEADINGS = ["The question", "The idea", "The code", "The picture", "Run time against error",
            "What goes wrong, and the cure", "Exercises", "Where to read on"]  # fmt: skip


@pytest.fixture(params=build.sources(), ids=lambda source: source.stem)
def source(request):
    return request.param


@pytest.fixture
def notebook(source):
    return nbformat.read(source.with_suffix(".ipynb"), as_version=4)


def test_every_notebook_comes_from_a_script():
    assert [path.with_suffix(".py") for path in sorted(build.HERE.glob("*.ipynb"))] == build.sources() != []


def test_the_notebook_is_built_from_the_script_as_it_stands(source, notebook):
    expected = build.read(source)
    assert [(c.cell_type, c.source) for c in notebook.cells] == [(c.cell_type, c.source) for c in expected.cells]
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))


def test_outputs_are_there_without_complaints_and_without_what_needs_a_kernel(source, notebook):
    assert source.with_suffix(".ipynb").stat().st_size <= build.LARGEST
    assert build.WIDGET not in json.dumps(notebook)
    for cell in notebook.cells:
        if cell.cell_type != "code":
            continue
        assert not [o for o in cell.outputs if o.output_type == "error" or o.get("name") == "stderr"], cell.source
        kinds = {kind for output in cell.outputs for kind in output.get("data", {output.get("name"): ""})}
        if re.search(r"^(with )?(fw\.(show|interact|plane\.show)\b|plt\.show)", cell.source, re.MULTILINE):
            assert "image/png" in kinds, cell.source
        if re.search(r"^(for .*\n)?\s*print\(", cell.source, re.MULTILINE):
            assert "stdout" in kinds, cell.source


def test_the_sections_come_in_their_order(notebook):
    text = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "markdown")
    found = re.findall(r"^## (.+)$", text, re.MULTILINE)
    assert [heading for heading in found if heading in HEADINGS] == HEADINGS
    exercises = text[text.index("## Exercises") : text.index("## Where to read on")]
    assert exercises.count("<details>") == exercises.count("</details>") == 3


def test_a_notebook_has_a_slider_and_the_plane(notebook):
    code = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "code")
    assert "fw.interact(" in code and "fw.plane.show(" in code


def test_a_cell_that_warns_or_raises_stops_the_build(tmp_path):
    for line, words in (("import warnings; warnings.warn('odd')", "complains"), ("1 / 0", "ZeroDivisionError")):
        script = tmp_path / "99_broken.py"
        script.write_text(f"# %%\n{line}\n")
        with pytest.raises(build.Broken, match=words):
            build.build(script)
    assert [path.name for path in tmp_path.iterdir()] == ["99_broken.py"]


def test_an_unknown_number_is_refused(capsys):
    assert build.main(["77"]) == 2
    assert "no walkthrough '77'" in capsys.readouterr().err
