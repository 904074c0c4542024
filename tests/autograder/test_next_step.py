"""The first sentence of a page says what to do next: of five graded notebooks, each wrong in another way."""

import html
import json
import re

import five_notebooks
import pytest
from report_samples import check, result

from autograder import cli
from autograder import report_view as view


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    out = tmp_path_factory.mktemp("five")
    five_notebooks.write(out / "submissions")
    weak = ["--allow-weak-isolation", "--call-cpu-seconds", "1"]
    assert cli.main(["grade", str(out / "submissions"), "--out", str(out / "graded"), *weak]) == 0
    return out / "graded"


FIRST = {
    "nan": r"Mend what comes out of 2\.1 safe_angle for up to \S+ more points: .*numbers that safe_angle returned are NaN; "
           r"the first where the first argument is -0\.\d+",
    "exception": r"Mend line 4 of the cell of 1\.6 estimate_normal for up to 3 more points: ValueError: .*\(768,\)\.",
    "shape": r"Mend what comes out of 1\.2 sdf_box for up to 3 more points: returned an array .* of shape \(4096, 3\), "
             r"not an array of shape \(4096,\)\.",
    "slow": r"Make your code end sooner in 1\.5 smooth_union for up to 3 more points: a call used over 1 s of CPU time",
    "mistake": r"Look again at 2\.2 penumbra for up to 3 more points: [A-Z][^:]{20,}\?$",  # the hint
}  # fmt: skip


@pytest.mark.parametrize("kind", FIRST)
def test_the_first_sentence_alone_tells_what_to_do_next(graded, kind):
    page = next((graded / "pages" / kind).glob("*.html")).read_text(encoding="utf-8")
    main = html.unescape(page.split("<main>")[1])
    first = re.search(r'<p class="first">(.*?)</p>', main)
    assert re.match(FIRST[kind], first[1]), first[1]
    assert not re.search(r"<p class=\"(?!eyebrow|student)", main[: first.start()].split('class="total"')[0])
    assert len(page) < 2_000_000


@pytest.mark.parametrize("kind", FIRST)
def test_only_the_wrong_task_is_named(graded, kind):
    path = next((graded / "results" / kind).glob("*.json"))
    shown = view.submission(view.read(path))
    assert [c["name"] for c in shown["gains"]] == [five_notebooks.WRONG[kind][1]]


def test_a_judged_task_stands_beside_the_reference_on_time_error_and_evaluations(graded):
    path = graded / "results" / "shape" / "sphere_tracing.json"
    checks = {c["id"]: c for c in json.loads(path.read_text())["checks"]}
    against = checks["1.7"]["against_reference"]
    assert against["error"] == against["error_reference"] > 0  # its sphere_trace is the reference's
    assert 0 < checks["1.7"]["cpu_seconds_reference"] < 10 and 0 < checks["1.7"]["cpu_seconds"] < 10
    assert "against_reference" not in checks["1.2"]  # what cannot be judged has no place on the plane
    page = (graded / "pages" / "shape" / "sphere_tracing.html").read_text(encoding="utf-8")
    assert page.count('class="plane"') == 7  # six tasks on time, one of them on evaluations too


def test_the_wrong_answer_lies_above_the_limit_and_the_reference_below(graded):
    path = graded / "results" / "mistake" / "soft_shadows.json"
    shown = {c["id"]: c for c in view.submission(view.read(path))["checks"]}
    [plane] = shown["2.2"]["planes"]
    reference, you = plane["points"]
    assert you["y"] < plane["limit"] < reference["y"]  # an SVG's y runs down


@pytest.mark.parametrize(
    "checks, more, sentence",
    [
        ([check("1.1", "f")], {}, "Nothing is left to gain: every task has full marks."),
        ([], {"status": "rejected", "message": "it is not JSON"}, "Hand the notebook in again: it is not JSON."),
        ([check("1.1", "f", "not_attempted", 0, 1, message="as released: nothing was filled in")], {},
         "Fill in 1.1 f for up to 1 more point: as released: nothing was filled in."),
        ([check("1.1", "f", "fail", 0, 2, error=1, likely_mistake="a-b", hint="Which axis?", message="m"),
          check("1.2", "g", "fail", 1, 2, message="m")], {}, "Look again at 1.1 f for up to 2 more points: Which axis?"),
        ([check("1.7", "f", "partial", 1, 2, error=0.1, message="right, but more work than needed: 9 evaluations")], {},
         "Save evaluations in 1.7 f for up to 1 more point: right, but more work than needed: 9 evaluations."),
        ([check("1.7", "f", "crashed", 0, 2, message="the process died of SIGSEGV")], {},
         "Find what makes Python die in 1.7 f for up to 2 more points: the process died of SIGSEGV."),
    ],
)  # fmt: skip
def test_other_first_sentences(checks, more, sentence):
    assert view.submission(result(checks=checks, **more))["first"] == sentence
