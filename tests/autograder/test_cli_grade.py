"""The instructor's ways: points of one's own, one student or one task anew, a contested mark, an old notebook."""

import json

import nbformat
import pytest

from autograder import cli, sandbox
from autograder.samples import filled_notebook

STUBS = dict.fromkeys(("sdf_box", "sdf_torus", "smooth_union", "estimate_normal", "sphere_trace"))
WRONG = {"blend": "def blend(d1, d2, t):\n    return d1"}


def hand_in(folder, student, replacements, version=None):
    notebook = filled_notebook("sphere_tracing", STUBS | replacements)
    if version:
        notebook.metadata.course.version = version
    path = folder / student / "sphere_tracing.ipynb"
    path.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, path)
    return path


@pytest.fixture
def course(tmp_path):
    """Two submissions with two functions each; runs `course grade` on them, and gives what it wrote."""
    hand_in(tmp_path / "in", "amy", {})
    hand_in(tmp_path / "in", "eve", WRONG)

    def run(*more):
        command = ["grade", tmp_path / "in", "--out", tmp_path / "out", "--jobs", 1, "--allow-weak-isolation", *more]
        code = cli.main([str(word) for word in command])
        return code if code else {
            path.parent.name: json.loads(path.read_text()) for path in (tmp_path / "out").glob("results/*/*.json")
        }  # fmt: skip

    run.folder = tmp_path
    return run


def test_points_are_the_instructors(course):
    (course.folder / "points.toml").write_text('[sphere_tracing]\n"1.1" = 7.5\n"1.4" = 0\n')
    results = course("--points", course.folder / "points.toml")
    checks = {check["id"]: check for check in results["eve"]["checks"]}
    assert (checks["1.1"]["score"], checks["1.1"]["max_score"]) == (7.5, 7.5)
    assert (checks["1.4"]["max_score"], checks["1.4"]["status"]) == (0, "not_attempted")
    assert "does not count" in checks["1.4"]["message"]
    assert results["eve"]["score"] == results["amy"]["score"] == 7.5 and results["amy"]["max_score"] == 20 - 2 - 1 + 7.5


@pytest.mark.parametrize(("text", "words"), [
    ("[sphere_tracing", "cannot be read"), ("[shadows]\na = 1", "no assignment 'shadows'"),
    ('[sphere_tracing]\n"9.9" = 1', "no task '9.9'"), ('[sphere_tracing]\n"1.1" = -1', "at least 0"),
])  # fmt: skip
def test_points_that_make_no_sense_are_refused(course, capsys, text, words):
    (course.folder / "points.toml").write_text(text)
    assert course("--points", course.folder / "points.toml") == 2
    assert words in capsys.readouterr().err


def test_one_student_or_one_task_is_graded_anew_and_the_rest_is_kept(course):
    before = course()
    path = course.folder / "out" / "results" / "eve" / "sphere_tracing.json"
    spoiled = json.loads(path.read_text())
    for check in spoiled["checks"]:
        check["score"] = 0.5
    path.write_text(json.dumps(spoiled))
    amys = (course.folder / "out" / "results" / "amy" / "sphere_tracing.json").read_bytes()

    after = course("--task", "1.1")["eve"]
    assert [check["score"] for check in after["checks"]] == [2.0, *[0.5] * 6]
    assert after["score"] == 5.0
    after = course("--regrade", "eve")["eve"]
    times = ("cpu_seconds", "cpu_seconds_reference")
    assert after["checks"] == [check | {key: new[key] for key in times if key in new}
                               for check, new in zip(before["eve"]["checks"], after["checks"], strict=True)]  # fmt: skip
    assert course()["amy"]["score"] == before["amy"]["score"]
    assert json.loads(amys)["score"] == 3.0


def test_students_and_tasks_that_do_not_exist_are_refused(course, capsys):
    assert course("--regrade", "zoe") == 2 and course("--task", "9.9") == 2
    said = capsys.readouterr().err
    assert "no submission of that student" in said and "no such task" in said


def test_a_contested_mark_is_reproduced(course, capsys):
    secret = course.folder / "secret"
    secret.write_text("one")
    course("--secret", secret)
    result = course.folder / "out" / "results" / "eve" / "sphere_tracing.json"

    def replay(*more):
        code = cli.main(["replay", str(result), "--allow-weak-isolation", *map(str, more)])
        return code, "".join(capsys.readouterr())

    code, said = replay("--secret", secret)
    assert code == 0 and "the same marks" in said and "1.4 blend: 0 of 1, fail (the same inputs)" in said
    code, said = replay()
    assert code == 2 and "another secret" in said
    notebook = course.folder / "in" / "eve" / "sphere_tracing.ipynb"
    notebook.rename(course.folder / "moved.ipynb")
    code, said = replay("--secret", secret)
    assert code == 2 and "--notebook" in said
    assert replay("--secret", secret, "--notebook", course.folder / "moved.ipynb")[0] == 0
    (course.folder / "moved.ipynb").write_text("{}")
    code, said = replay("--secret", secret, "--notebook", course.folder / "moved.ipynb")
    assert code == 2 and "its bytes are others" in said


def test_a_changed_mark_is_told(course, capsys):
    course()
    path = course.folder / "out" / "results" / "eve" / "sphere_tracing.json"
    result = json.loads(path.read_text())
    result["checks"][3] |= {"status": "pass", "score": 1.0}
    path.write_text(json.dumps(result))
    assert cli.main(["replay", str(path), "--allow-weak-isolation"]) == 1
    assert "1 of 1, pass then, now 0 of 1, fail" in capsys.readouterr().out


def test_a_notebook_of_another_release_gets_a_sentence_and_no_mark(course):
    hand_in(course.folder / "in", "old", {}, version="0.0.7")
    hand_in(course.folder / "in", "patch", {}, version="0.1.9")
    results = course()
    assert results["old"]["status"] == "rejected" and "made from release 0.0.7" in results["old"]["message"]
    assert results["patch"]["status"] == "graded"


def test_isolation_is_recorded(course):
    assert course()["amy"]["isolation"] == sandbox.strongest_level()
