"""`hint("2.4")` in a notebook: from a question to almost the line, a step further each time that it is asked."""

from __future__ import annotations

import html

from autograder.checks.hints import HINTS

_asked: dict[str, int] = {}


def hint(task):
    """Show the hints to a task that were asked for so far, and the next one.

    Parameters
    ----------
    task : str      the task's number, such as "2.4"

    Raises
    ------
    KeyError        where there is no such task
    """
    steps = so_far(str(task))
    left = len(HINTS[str(task)]) - len(steps)
    more = f'{left} more: run this cell again' if left else 'that is all there is; what is left is the line itself'
    try:
        from IPython import get_ipython
        from IPython.display import HTML, display
    except ImportError:
        get_ipython = None
    if get_ipython is None or get_ipython() is None:
        print("\n".join([f"{task}, hint {i}: {step}" for i, step in enumerate(steps, 1)] + [f"({more})"]))
    else:
        items = "".join(f"<li>{html.escape(step)}</li>" for step in steps)
        display(HTML(f'<div style="border-left:5px solid #0969da;padding:.4em 1em;margin:.3em 0;max-width:60em"><b '
                     f'style="color:#0969da">💡 {task}</b><ol style="margin:.3em 0">{items}</ol>{more}</div>'))  # fmt: skip


def so_far(task) -> tuple[str, ...]:
    """The steps that were shown, and one more."""
    if task not in HINTS:
        raise KeyError(f'there is no task {task!r}: a number such as "1.2" is wanted')
    _asked[task] = min(_asked.get(task, 0) + 1, len(HINTS[task]))
    return HINTS[task][: _asked[task]]
