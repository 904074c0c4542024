"""The first sentence of a student's page: what to do next, and where."""

from __future__ import annotations

import re

LONGEST = 260  # characters of what was found; more is on the page below
_LINE = re.compile(r"\bline (\d+)(?:, in |\)?$)", re.MULTILINE)
_VERBS = {
    "fail": "Look again at",
    "partial": "Look again at",
    "not_attempted": "Fill in",
    "timeout": "Make your code end sooner in",
    "out_of_memory": "Use less memory in",
    "crashed": "Find what makes Python die in",
}


def sentence(submission) -> str:
    """What to do next about a submission.

    Parameters
    ----------
    submission : dict       as `report_view.submission` makes it, its `gains` ordered by points to gain

    Returns
    -------
    str                     one sentence; of the task that has most points to gain, where there is one
    """
    if submission["status"] == "rejected":
        return _ended("Hand the notebook in again", submission["message"])
    if not submission["checks"]:
        return _ended("Ask your instructor to look at this", submission["message"] or submission["words"])
    if not submission["gains"]:
        return "Nothing is left to gain: every task has full marks."
    check = submission["gains"][0]
    return _ended(f"{_verb(check)} {check['id']} {check['name']}{_worth(check)}", _found(check))


def _verb(check):
    """What to do in which place: `Look again at`, `Mend line 4 of`."""
    if check["traceback"]:
        lines = _LINE.findall(check["traceback"])
        return f"Mend line {lines[-1]} of the cell of" if lines else "Mend"
    if check["status"] == "error" or (check["status"] == "partial" and not check["judged"]):
        return "Mend what comes out of"
    if check["message"].startswith("right, but more work"):
        return "Save evaluations in"
    return _VERBS.get(check["status"], "Look again at")


def _worth(check):
    gain = round(check["max_score"] - check["score"], 2)
    return f" for up to {gain:g} more point{'s' if gain != 1 else ''}"


def _found(check):
    """What could not be judged and why; of what was judged a known mistake's hint, else what was found."""
    if check["judged"] and check["mistake"] and check["hint"]:
        return check["hint"]
    return check["message"] or check["meaning"]


def _ended(what, found):
    found = " ".join(found.split())
    if len(found) > LONGEST:
        found = found[:LONGEST].rsplit(" ", 1)[0] + " …"
    return f"{what}: {found}" if found.endswith(("?", "!", ".", "…")) else f"{what}: {found}."
