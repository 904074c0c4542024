"""The project's docstrings as numpydoc reads them: `name : type   what it is` on one line becomes two."""

import re
from itertools import pairwise

SECTIONS = ("Parameters", "Returns", "Raises", "Attributes", "Yields")
ENTRY = re.compile(r"^(\S.*?\S) {2,}(\S.*)$")


def _split(app, what, name, obj, options, lines):
    section, result = "", []
    for here, after in pairwise([*lines, ""]):
        if after and set(after) == {"-"}:
            section = here
        entry = ENTRY.match(here)
        if section not in SECTIONS or not here.strip():
            result.append(here)
        elif entry:
            result += [entry[1], f"    {entry[2]}"]
        else:
            result.append("    " + here.strip() if here.startswith(" ") else here)
    lines[:] = result


def setup(app):
    """Go before numpydoc."""
    app.connect("autodoc-process-docstring", _split, priority=100)
    return {"parallel_read_safe": True}
