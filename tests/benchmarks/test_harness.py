"""The harness on contenders of known time and error, and the techniques on what must hold on every machine."""

import csv
import sys
import time
from types import SimpleNamespace

import numpy as np
import pytest

from autograder.cli import main
from benchmarks import TECHNIQUES, harness, shadows, steppers

CONTENDERS = [
    harness.Contender("sleep", f"{ms} ms", lambda ms=ms: time.sleep(ms / 1000) or ms, lambda ms: 1.0 / ms, lambda ms: ms)
    for ms in (2, 8, 32)
]  # fmt: skip


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0])
def test_a_power_is_found_again(power):
    sizes = [10, 100, 1000]
    assert harness.slope(sizes, [3e-3 * n**power for n in sizes]) == pytest.approx(power)


def test_times_errors_and_work_are_those_of_the_contender(monkeypatch, tmp_path):
    technique = SimpleNamespace(TITLE="t", ERROR="e", contenders=lambda: CONTENDERS)
    monkeypatch.setitem(sys.modules, "benchmarks.some", technique)
    harness.bench("some", tmp_path)
    rows = read(tmp_path / "some.csv")
    assert tuple(rows[0]) == harness.COLUMNS and [row["work"] for row in rows] == ["2", "8", "32"]
    assert [float(row["error"]) for row in rows] == pytest.approx([1 / 2, 1 / 8, 1 / 32], rel=1e-3)
    assert all(float(row["milliseconds"]) >= ms for row, ms in zip(rows, (2, 8, 32), strict=True))
    assert (tmp_path / "some.png").read_bytes().startswith(b"\x89PNG")


def test_a_run_that_fails_leaves_finished_files_whole_and_no_parts(monkeypatch, tmp_path):
    def broken(result):
        raise RuntimeError

    good = SimpleNamespace(TITLE="t", ERROR="e", series=lambda: {"m": {1: lambda: None, 2: lambda: None}})
    bad = SimpleNamespace(TITLE="t", ERROR="e", contenders=lambda: [harness.Contender("m", "s", int, broken)])
    monkeypatch.setitem(sys.modules, "benchmarks.good", good)
    monkeypatch.setitem(sys.modules, "benchmarks.bad", bad)
    harness.bench("good", tmp_path)
    with pytest.raises(RuntimeError):
        harness.bench("bad", tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["good.csv", "good.png"]
    assert tuple(read(tmp_path / "good.csv")[0]) == harness.GROWTH_COLUMNS


def test_every_technique_has_its_module():
    for name in TECHNIQUES:
        technique = harness.importlib.import_module(f"benchmarks.{name}")
        assert hasattr(technique, "series") or all(hasattr(technique, part) for part in ("contenders", "ERROR", "WORK"))


def test_an_unknown_technique_is_refused_with_the_known_ones(capsys, tmp_path):
    assert main(["bench", "no", "--out", str(tmp_path)]) == 2
    assert "there is no technique 'no'; there are steppers" in capsys.readouterr().err


def test_steppers_agree_on_what_they_hit_and_relaxing_saves_evaluations():
    found = {c.method: c for c in steppers.contenders() if c.setting in ("at most 256 steps", "0.5 pixels")}
    results = {name: c.run() for name, c in found.items()}
    errors = {name: c.error(results[name]) for name, c in found.items()}
    work = {name: c.work(results[name]) for name, c in found.items()}
    for name in steppers.STEPPERS:
        assert errors[name] < 0.01
    assert work["auto-relaxed"] < 0.8 * work["plain"] and work["over-relaxed 1.2"] < 0.9 * work["plain"]
    assert errors["plain, cone and refinement"] < 0.3 * errors["plain, pixel's cone"]


def test_signed_estimators_of_shadow_are_right_where_unsigned_ones_are_biased():
    found = {c.method: c for c in shadows.contenders() if c.setting == "at most 128 steps"}
    errors = {name: c.error(c.run()) for name, c in found.items()}
    assert max(errors["signed, smooth step"], errors["signed, exact for edges"]) < 0.02
    assert min(errors["ratio"], errors["arcsin"], errors["aaltonen"]) > 0.08
    assert np.isclose(errors["ratio"], errors["arcsin"], atol=0.002)
