"""The autograder. In a notebook: `from autograder import check`, then `check("1.2")` under a function."""

__all__ = ["check"]


def __getattr__(name):
    if name == "check":
        from autograder.notebook import check

        return check
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
