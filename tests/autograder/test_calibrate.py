"""Known answers and tolerances: right ones keep all marks with room to spare, wrong ones do not, and the records say so."""

import json

import numpy as np
import pytest

from autograder import calibrate, calibration_report, checks, cli, mistakes
from autograder.calibrate import MARGIN, Extreme, Run

NAMES = checks.available()
TASKS = [(name, task.id) for name in NAMES for task in checks.assignment(name).tasks]
SLOW = {"4.5", "5.3"}
RECORDS = json.loads(calibration_report.RECORDS.read_text(encoding="utf-8"))


def answers(name, task_id):
    return [a for a in mistakes.right_answers(name) + mistakes.mistakes(name) if a.task == task_id]


@pytest.mark.parametrize(("name", "task_id"), TASKS)
def test_right_answers_and_mistakes_lie_on_their_sides_of_every_tolerance(name, task_id):
    seeds = 1 if task_id in SLOW else 2
    judged = [(answer, calibrate.judge(answer, seeds)) for answer in answers(name, task_id)]
    assert calibrate.compare(checks.assignment(name).find(task_id), judged).problems == []


@pytest.mark.drill
def test_every_known_answer_has_its_marks_and_its_margin_with_many_inputs(capsys):
    code = cli.main(["calibrate"])
    print(capsys.readouterr().out)
    assert code == 0


@pytest.mark.parametrize("name", NAMES)
def test_every_function_has_wrong_answers_and_every_task_three_right_ones_besides_the_reference(name):
    right, wrong = mistakes.right_answers(name), mistakes.mistakes(name)
    for task in checks.assignment(name).tasks:
        assert sum(a.task == task.id and a.verdict == mistakes.RIGHT for a in right) >= 3 + len(
            task.functions
        )
        for function in task.functions:
            assert sum(a.function == function.name for a in wrong) >= 5
            assert sum(a.function == function.name and a.verdict == mistakes.RIGHT for a in right) >= 3


def test_every_mistake_has_its_own_name_a_symptom_and_a_hint():
    every = [mistake for name in NAMES for mistake in mistakes.mistakes(name)]
    assert len({m.id for m in every}) == len(every) >= 60
    for m in every:
        assert m.symptom.endswith(".") and m.hint[-1] in ".?" and m.symptom != m.hint, m.id


@pytest.mark.parametrize(("name", "task_id"), TASKS)
def test_every_measure_has_a_record_of_what_was_measured(name, task_id):
    known = {a.id for a in answers(name, task_id)}
    for measure, record in RECORDS[task_id].items():
        assert record["metric"] and len(record["reason"]) > 20, measure
        assert record["right_way"] in known and record["wrong_way"] in known | {None}, measure
        if measure == "work":
            continue
        tolerance = record["tolerance"]
        if tolerance and record["right"] > 0:
            assert (
                record["right_margin"] == pytest.approx(tolerance / record["right"], rel=0.02)
                and record["right_margin"] >= MARGIN
            )
        if tolerance and record["wrong"]:
            assert (
                record["wrong_margin"] == pytest.approx(record["wrong"] / tolerance, rel=0.02)
                and record["wrong_margin"] >= MARGIN
            )


def answer(verdict):
    return mistakes.Answer("soft_shadows", "2.2", "penumbra", "penumbra-x", np.add, verdict)


def problems(verdict, *runs):
    return calibrate.compare(
        checks.assignment("soft_shadows").find("2.2"), [(answer(verdict), list(runs))]
    ).problems


def run(fraction, over, failure=""):
    return Run(fraction, failure, {"map": (over, 1.0)}, {"map"} if over > 1 else set())


def test_a_right_answer_must_stay_clear_of_the_tolerance_in_every_run():
    assert problems(mistakes.RIGHT, run(1.0, 0.6), run(1.0, 0.6)) == []
    assert "near the tolerance" in problems(mistakes.RIGHT, run(1.0, 0.6), run(1.0, 0.7))[0]
    assert "loses marks" in problems(mistakes.RIGHT, run(1.0, 0.6), run(0.9, 1.2))[0]


def test_a_mistake_must_exceed_a_tolerance_clearly_in_every_run():
    assert problems(mistakes.WRONG, run(0.5, 1.6), run(0.0, 0.0, "not a number")) == []
    assert "only 1.40 times" in problems(mistakes.WRONG, run(0.5, 1.6), run(0.5, 1.4))[0]
    assert "keeps 100% of the marks" in problems(mistakes.WRONG, run(0.5, 1.6), run(1.0, 0.2))[0]
    assert "keeps 97% of the marks" in problems(mistakes.WRONG, run(0.5, 1.6), run(0.97, 1.6))[0]


def test_the_nearest_mistake_of_a_measure_is_one_that_it_catches_in_every_run():
    near = [run(0.5, 1.6), run(0.5, 1.4)], [run(0.5, 1.8), run(0.5, 1.7)]
    table = calibrate.compare(
        checks.assignment("soft_shadows").find("2.2"), [(answer(mistakes.WRONG), runs) for runs in near]
    )
    assert table.rows[0].wrong == Extreme("penumbra-x", 1.7, 1.0)


def test_the_command_prints_the_table_of_a_task_and_refuses_a_name_that_is_none(capsys):
    assert cli.main(["calibrate", "blend", "--seeds", "1"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("1.4 blend:") and "smallest margin of wrong answers" in out
    assert cli.main(["calibrate", "9.9"]) == 2


def test_a_record_that_is_written_keeps_its_tolerance_and_its_reason(tmp_path, monkeypatch):
    copy = tmp_path / "tolerances.json"
    copy.write_text(calibration_report.RECORDS.read_text(encoding="utf-8"), encoding="utf-8")
    monkeypatch.setattr(calibration_report, "RECORDS", copy)
    task = checks.assignment("sphere_tracing").find("1.4")
    calibration_report.write(
        [calibrate.compare(task, [(a, calibrate.judge(a, 1)) for a in answers("sphere_tracing", "1.4")])]
    )
    fresh = json.loads(copy.read_text(encoding="utf-8"))
    for measure, record in fresh["1.4"].items():
        old = RECORDS["1.4"][measure]
        assert (record["tolerance"], record["reason"]) == (old["tolerance"], old["reason"])
        assert 0 < record["right"] < record["tolerance"] / MARGIN and record["wrong_margin"] > MARGIN
    assert {k: v for k, v in fresh.items() if k != "1.4"} == {k: v for k, v in RECORDS.items() if k != "1.4"}
