"""docs/glossary.md: each name in code exists, each term has its Chinese, and none of the tasks is without one."""

import importlib
import inspect
import re

import framework as fw
from autograder import checks
from tests.guides import ROOT

ROWS = [
    [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
    for line in (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8").splitlines()
    if line.startswith("| ") and not line.startswith(("| ---", "| term"))
]
TASKS = {f.name: name for name in checks.ASSIGNMENTS for task in checks.assignment(name).tasks for f in task.functions}


def exists(name):
    head, _, rest = name.partition("(")
    if head.startswith("fw."):
        found = fw
        for part in head.split(".")[1:]:
            found = getattr(found, part)
        return True
    function = getattr(importlib.import_module(f"solutions.{TASKS[head]}"), head)
    return not rest or rest.rstrip(")") in inspect.signature(function).parameters


def test_each_row_is_whole():
    assert len(ROWS) > 45
    assert [row for row in ROWS if len(row) != 6 or not (row[0] and row[2] and row[5])] == []


def test_each_term_has_its_chinese():
    assert [row[0] for row in ROWS if not re.search(r"[\u4e00-\u9fff]", row[1])] == []


def test_each_name_in_code_exists():
    names = [name for row in ROWS for name in re.findall(r"`([^`]+)`", row[5])]
    assert len(names) > 70
    assert [name for name in names if not exists(name)] == []


def test_each_function_that_is_asked_for_is_explained():
    named = {name.partition("(")[0] for row in ROWS for name in re.findall(r"`([^`]+)`", row[5])}
    assert set(TASKS) <= named
