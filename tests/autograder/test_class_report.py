"""The report on a class: a small real one, graded, and 300 made-up results."""

import gc
import html
import json
import re
import tracemalloc
from pathlib import Path

import a_class
import numpy as np
import pytest
from report_samples import EVIL, check, poison, result, sample_checks, store

from autograder import class_figures, class_report, cli, likeness
from autograder import report_view as view


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """The folder of a graded class with its report, and the known mistakes in it."""
    out = tmp_path_factory.mktemp("class")
    known = a_class.write(out / "submissions")
    weak = ["--allow-weak-isolation", "--call-cpu-seconds", "1"]
    assert cli.main(["grade", str(out / "submissions"), "--out", str(out / "graded"), *weak]) == 0
    assert cli.main(["report", str(out / "graded"), "--submissions", str(out / "submissions")]) == 0
    return out / "graded", known


def entries(graded):
    return [class_figures.entry(path, result, True) for path, result, _ in view.results(graded)]


def page_of(graded):
    return html.unescape((graded / "report.html").read_text(encoding="utf-8"))


def students(rows):
    return {name for row in rows for name, _ in row["students"]}


def test_the_most_frequent_mistakes_are_counted_with_their_hint_and_students(course):
    graded, known = course
    rows = {row["named"]: row for row in class_figures.mistakes(entries(graded))}
    for id, mistake in known.items():
        row = rows[id.replace("-", " ")]
        had = {student for student, ids in a_class.MISTAKEN.items() if id in ids}
        assert {name for name, _ in row["students"]} == had and row["hint"] == mistake.hint
        assert row["what"] == mistake.symptom and mistake.hint in page_of(graded)
    counts = [len(row["students"]) for row in class_figures.mistakes(entries(graded))]
    assert counts == sorted(counts, reverse=True) and counts[0] == 3


def test_marks_by_task_count_every_graded_submission_once(course):
    tasks = {task["id"]: task for task in class_figures.tasks(entries(course[0]))}
    assert list(tasks) == [f"1.{k}" for k in range(1, 8)]
    assert {sum(task["counts"]) for task in tasks.values()} == {11}  # of 13, one empty and one rejected
    assert tasks["1.4"]["counts"] == [4, 0, 0, 0, 0, 0, 7]  # three swapped, one crash


def test_accidents_want_a_persons_look_and_right_answers_do_not(course):
    rows = {row["student"]: " ".join(row["reasons"]) for row in class_figures.for_a_person(entries(course[0]))
            if not any("NOT ISOLATED" in reason for reason in row["reasons"])}  # fmt: skip
    assert "1.5 smooth_union ran out of time" in rows["finn"] and "1.4 blend crashed" in rows["lea"]
    assert "not valid JSON" in rows["max"] and not {"ada", "gus", "hal"} & set(rows)


def test_a_copy_with_other_names_and_comments_is_a_pair_shown_side_by_side(course):
    page = page_of(course[0])
    pair = re.search(r"<details><summary><b>100 %</b> ben and kim<.*?</details>", page, re.S)[0]
    assert "not a verdict" in page
    assert "nearest_face" in pair and "face = d.max(axis=-1)" in pair and "slope" in pair
    listed = re.findall(r"<b>\d+ %</b> (\w+) and (\w+)<", page)
    assert ("ada", "ben") not in listed and ("ben", "eve") not in listed  # another way; an empty notebook


def test_every_dot_links_to_its_page_and_lies_where_its_figures_say(course):
    graded, page = course[0], page_of(course[0])
    plot = re.search(r'<svg class="plane".*?</svg>', page, re.S)[0]
    links = re.findall(r'<a href="([^"]+)"', plot)
    assert len(links) == 11 and all((graded / link).is_file() for link in links) and "The reference" in plot
    plane = class_figures.cost_against_error(entries(graded))
    at = {p["student"]: p for p in plane["points"] if p["kind"] == "you"}
    assert at["gus"]["y"] < plane["limit"] < at["ada"]["y"] and at["ben"]["x"] > at["ada"]["x"]
    assert (at["finn"]["judged"], at["ada"]["judged"]) == (6, 7)


def test_without_the_notebooks_solutions_are_not_compared_and_a_changed_one_is_told(course, tmp_path, capsys):
    graded = course[0]
    before = page_of(graded)
    class_report.write(graded)
    assert "Not compared" in page_of(graded) and "<details>" not in page_of(graded)
    a_class.write(tmp_path)
    with (tmp_path / "kim" / "sphere_tracing.ipynb").open("a") as file:
        file.write("\n")
    assert cli.main(["report", str(graded), "--submissions", str(tmp_path)]) == 0
    page = page_of(graded)
    assert "Not compared, for their graded notebook is not in PATH: 1." in page and "ben and kim" not in page
    (graded / "report.html").write_text(before, encoding="utf-8")
    assert cli.main(["report", str(tmp_path)]) == 2 and "holds no results/" in capsys.readouterr().err


# Likeness ---------------------------------------------------------------------------------------------------------
LOOP = '''
def f(sdf, origin, direction):
    """March."""
    t = np.zeros(len(origin))
    for step in range(64):
        distance = sdf(origin + t[:, None] * direction)
        t = np.where(distance < 1e-4, t, t + distance)
    return np.where(t < 20.0, t, np.inf), np.minimum(t, 20.0)
'''


@pytest.mark.parametrize(
    "other, same",
    [
        (LOOP.replace("distance", "d").replace("step", "_"), True),  # names
        (LOOP.replace('"""March."""', "# march\n"), True),  # texts
        (LOOP.replace("1e-4", "1e-3"), False),  # a constant
        (LOOP.replace("np.minimum", "np.maximum"), False),  # a library's function
        (LOOP.replace("t + distance", "t - distance"), False),  # an operator
    ],
)
def test_names_and_texts_do_not_count_and_what_the_code_does_does(other, same):
    assert (likeness.runs(LOOP) == likeness.runs(other)) == same
    assert len(likeness.runs(LOOP)) > likeness.LEAST_RUNS


def test_what_was_released_is_no_likeness_and_broken_code_no_accident():
    assert likeness.pairs([{"f": LOOP}, {"f": LOOP}], {"f": LOOP}) == []
    assert likeness.runs("def f(:") == likeness.runs("(" * 5000) == frozenset()
    [pair] = likeness.pairs([{"f": LOOP}, {"f": "def f(:"}, {"f": LOOP}], {"f": "def f(): pass"})
    assert (pair.first, pair.second, pair.share, pair.tasks) == (0, 2, 1.0, ("f",))


def test_the_share_is_what_two_sets_have_in_common_across_blocks_of_runs(monkeypatch):
    monkeypatch.setattr(likeness, "BLOCK", 16)
    rng = np.random.default_rng(3)
    sets = [frozenset(rng.choice(200, 150, replace=False).tolist()) for _ in range(6)]
    sets.append(sets[2] - {min(sets[2])})
    got = {(i, j): share for i, j, share in likeness._alike(sets)}
    assert got == pytest.approx({(2, 6): 149 / 150})


# Figures ----------------------------------------------------------------------------------------------------------
def test_a_correlation_is_numpys_and_its_interval_fishers():
    rng = np.random.default_rng(1)
    a = rng.normal(size=50)
    b = a + rng.normal(size=50)
    r = class_figures.correlation(a, b)
    assert r == pytest.approx(np.corrcoef(a, b)[0, 1])
    low, high = class_figures.interval(r, 50)
    assert np.arctanh([low, high]) == pytest.approx(np.arctanh(r) + np.array([-1, 1]) * 1.96 / np.sqrt(47))
    assert class_figures.correlation(a, np.ones(50)) is None and class_figures.interval(None, 50) == (None, None)


def test_a_task_that_the_strong_do_and_the_weak_do_not_separates_them():
    made = []
    for i in range(40):
        strong, coin = i % 2, i // 2 % 2
        checks = [check("1.1", "f", "pass", 2 * strong, 2), check("1.2", "g", "pass", 2 * strong, 2),
                  check("1.3", "h", "pass", 2 * coin, 2)]  # fmt: skip
        made.append(class_figures.entry(Path("r/s/a.json"), result(f"s{i}", checks=checks), False))
    verdicts = {task["id"]: task["verdict"] for task in class_figures.tasks(made)}
    assert verdicts["1.1"] == "separates strong from weak" and verdicts["1.3"] == "no clear relation to the rest"
    few = {task["verdict"] for task in class_figures.tasks(made[:12])}
    assert few == {"12 submissions are too few to tell"}


@pytest.mark.parametrize("error, near", [(0.7, False), (0.9, True), (1.1, True), (1.4, False)])
def test_an_error_near_its_limit_wants_a_look(error, near):
    measure = {"name": "inside", "error": error, "tolerance": 1.0}
    one = result(checks=[check("1.1", "f", measures=[measure])])
    rows = class_figures.for_a_person([class_figures.entry(Path("r/s/a.json"), one, False)])
    assert bool(rows) == near and all(f"“inside” at {error:.2f} of its limit" in row["reasons"][0] for row in rows)


def test_markup_in_results_stays_text(tmp_path):
    data = poison(result(checks=sample_checks())) | {"status": "graded", "assignment": "sphere_tracing"}
    store(tmp_path, data, "evil")
    (tmp_path / "results" / "evil" / "broken.json").write_text(json.dumps(EVIL))
    text = class_report.write(tmp_path).read_text(encoding="utf-8")
    assert "<script" not in text and "<img" not in text and "&lt;script&gt;alert(1)" in text


def test_three_hundred_results_take_memory_far_below_their_size(tmp_path):
    rng = np.random.default_rng(5)

    def spend(start, stop):
        for i in range(start, stop):
            checks = [{**c, "prints": "x" * 4000, "score": rng.integers(0, 3) / 1.0} for c in sample_checks()]
            store(tmp_path, result(f"s{i:03d}", checks=checks), f"s{i:03d}")
        class_report.write(tmp_path)  # what is loaded and kept once
        gc.collect()
        tracemalloc.start()
        class_report.write(tmp_path)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return peak

    first, second = spend(0, 50), spend(50, 300)
    assert second - first < 250 * 15_000  # of 40 kB each
