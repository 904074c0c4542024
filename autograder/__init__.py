"""The autograder. In a notebook: `from autograder import check, hint`, then `check("1.2")` under a function."""

__all__ = ["check", "hint"]


def __getattr__(name):
    if name == "check":
        from autograder.notebook import check

        return check
    if name == "hint":
        from autograder.hinting import hint

        return hint
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
