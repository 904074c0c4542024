"""Results in other tools' formats, held to schemas written down from their documentation."""

import csv
import json
import zipfile
from pathlib import Path

import jsonschema
import pytest

from autograder import cli, export, gradescope
from tests.autograder import report_samples

TEXT, MARK = {"type": "string"}, {"type": "number", "minimum": 0}

# https://gradescope-autograders.readthedocs.io/en/latest/specs/ : "score" of the whole wins over those of the tests.
GRADESCOPE = {
    "type": "object",
    "required": ["score", "tests"],
    "additionalProperties": False,
    "properties": {
        "score": MARK, "execution_time": {"type": "integer", "minimum": 0}, "output": TEXT,
        "output_format": {"enum": ["text", "html", "simple_format", "md", "ansi"]},
        "visibility": {"enum": ["hidden", "after_due_date", "after_published", "visible"]},
        "stdout_visibility": {"enum": ["hidden", "after_due_date", "after_published", "visible"]},
        "tests": {"type": "array", "items": {
            "type": "object", "required": ["score", "max_score", "name"], "additionalProperties": False,
            "properties": {
                "number": TEXT, "name": TEXT, "score": MARK, "max_score": MARK, "output": TEXT,
                "status": {"enum": ["passed", "failed"]}, "visibility": {"enum": ["visible"]},
                "output_format": {"enum": ["text", "html", "simple_format", "md", "ansi"]},
            }}},
    },
}  # fmt: skip
# PrairieLearn, docs/externalGrading.md, "Grading results": the score is a share in [0, 1]; below 1 MB in all.
IMAGE = {"type": "object", "required": ["url"], "additionalProperties": False, "properties": {
    "label": TEXT, "url": {"type": "string", "pattern": "^data:image/png;base64,[A-Za-z0-9+/]+=*$"}}}  # fmt: skip
PRAIRIELEARN = {
    "type": "object",
    "additionalProperties": False,
    "anyOf": [{"required": ["score"]}, {"properties": {"gradable": {"const": False}}, "required": ["gradable"]}],
    "properties": {
        "gradable": {"type": "boolean"}, "score": {"type": "number", "minimum": 0, "maximum": 1}, "message": TEXT,
        "format_errors": {"type": ["string", "array"], "items": TEXT},
        "tests": {"type": "array", "items": {
            "type": "object", "required": ["name"], "additionalProperties": False,
            "properties": {"name": TEXT, "description": TEXT, "points": MARK, "max_points": MARK, "message": TEXT,
                           "output": TEXT, "images": {"type": "array", "items": IMAGE}}}},
    },
}  # fmt: skip


@pytest.fixture
def graded(tmp_path):
    """Four results: all statuses with pictures, one poisoned, one rejected, one with pictures of megabytes."""
    out = tmp_path / "graded"
    checks = report_samples.sample_checks()
    for check in checks:
        check["images"] = report_samples.paint(out / "pages" / "amy" / "sphere_tracing", check["id"])
    report_samples.store(out, report_samples.result(checks=checks))
    poisoned = [report_samples.poison(check) | {"status": check["status"]} for check in report_samples.sample_checks()]
    report_samples.store(out, report_samples.result("=2+5", checks=poisoned), "eve")
    report_samples.store(out, report_samples.result("zoe", status="rejected", message="not JSON", max_score=20.0))
    large = report_samples.check("1.7", "sphere_trace", "fail", 0, 5)
    large["images"] = report_samples.paint(out / "pages" / "max" / "sphere_tracing", "1.7", 700, noise=1.0)
    report_samples.store(out, report_samples.result("max", checks=[large]))
    return out


@pytest.mark.parametrize(("form", "schema"), [("gradescope", GRADESCOPE), ("prairielearn", PRAIRIELEARN)])
def test_every_result_has_the_documented_format_and_size(graded, tmp_path, form, schema):
    assert cli.main(["export", str(graded), "--format", form, "--out", str(tmp_path / "out")]) == 0
    files = sorted((tmp_path / "out").glob("*/*/results.json"))
    assert len(files) == len(list(graded.glob("results/*/*.json"))) == 4
    for file in files:
        jsonschema.validate(json.loads(file.read_text()), schema)
        assert file.stat().st_size < export.PRAIRIELEARN_BYTES


def test_marks_are_those_of_the_results(graded, tmp_path):
    for form in ("gradescope", "prairielearn"):
        cli.main(["export", str(graded), "--format", form, "--out", str(tmp_path / form)])
    for path in graded.glob("results/*/*.json"):
        result = json.loads(path.read_text())
        scope, prairie = (json.loads((tmp_path / form / path.parent.name / path.stem / "results.json").read_text())
                          for form in ("gradescope", "prairielearn"))  # fmt: skip
        assert scope["score"] == result["score"]
        assert [test["score"] for test in scope["tests"]] == [check["score"] for check in result["checks"]]
        if result["status"] == "rejected":
            assert prairie == {"gradable": False, "format_errors": ["not JSON"]}
        else:
            assert prairie["score"] == pytest.approx(result["score"] / result["max_score"])


def test_pictures_go_along(graded):
    folder = graded / "results" / "amy"
    result = json.loads((folder / "sphere_tracing.json").read_text())
    scope = export.gradescope(result, folder, graded / "pages")
    prairie = export.prairielearn(result, folder, graded / "pages")
    for ours, theirs in zip(scope["tests"], prairie["tests"], strict=True):
        assert [image["label"] for image in theirs["images"]] == ["Yours", "Expected", "Difference"]
        assert ours["output"].count("<img alt=") == 3


def test_a_strangers_markup_does_not_run_in_gradescope(graded):
    folder = graded / "results" / "eve"
    result = json.loads((folder / "sphere_tracing.json").read_text())
    shown = export.gradescope(result, folder, graded / "pages")
    text = shown["output"] + "".join(test["output"] for test in shown["tests"])
    assert "alert(1)" in text
    assert not any(tag in text for tag in ("<script", "<img src", "</style", "<b>"))


def test_the_table_has_a_line_for_each_task_and_no_formula(graded, tmp_path):
    cli.main(["export", str(graded), "--format", "csv", "--out", str(tmp_path)])
    with open(tmp_path / "tasks.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    tasks = sum(len(json.loads(p.read_text())["checks"]) for p in graded.glob("results/*/*.json"))
    assert len(rows) == tasks > 0
    assert any(row["student"] == "'=2+5" for row in rows)
    assert not any(value.startswith(("=", "+", "@")) for row in rows for value in row.values())


def test_a_folder_without_results_is_refused(tmp_path, capsys):
    assert cli.main(["export", str(tmp_path), "--format", "csv"]) == 2
    assert "no results/" in capsys.readouterr().err


def test_the_zip_for_gradescope_is_reproducible_and_its_scripts_can_run(tmp_path):
    first, second = (gradescope.package(tmp_path / name).read_bytes() for name in ("a.zip", "b.zip"))
    assert first == second
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        for script in ("setup.sh", "run_autograder"):
            assert archive.getinfo(script).external_attr >> 16 & 0o111
        assert {"autograder/cli.py", "solutions/split_sum.py", "requirements.lock"} <= set(archive.namelist())
        assert not any(Path(name).suffix == ".pyc" for name in archive.namelist())
