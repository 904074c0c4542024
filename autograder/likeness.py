"""Solutions that are nearly the same: what is left of their code once names, comments and layout are gone.

A solution becomes the walk through its syntax tree. Names that it binds itself all become one, for renaming is the first
thing that hides a copy; names of libraries, operators and constants stay, for they are what the code does. Docstrings
go. Of the walk, every run of `RUN` nodes is taken once, and those that the released notebook has too are left out.
Two solutions are as alike as the part of their runs that both have.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass

import numpy as np

RUN = 8  # nodes: about one call with its arguments
LEAST_RUNS = 40  # a solution with fewer is too short to say anything about
ALIKE = 0.8  # of the runs of two solutions together
BLOCK = 4096  # runs compared at a time


@dataclass(frozen=True)
class Pair:
    """Two solutions, by their places in what was compared, and the part of their runs that both have."""

    first: int
    second: int
    share: float
    tasks: tuple[str, ...]


def pairs(solutions, released) -> list[Pair]:
    """The pairs of solutions that are nearly the same, the most alike first.

    Parameters
    ----------
    solutions : list of dict    task -> source of its cell; one dict for each submission
    released : dict             task -> source of the released cell

    Returns
    -------
    list of Pair                with at least `ALIKE` in common; `tasks` are those in which they have as much
    """
    scaffold = frozenset().union(*(runs(source) for source in released.values()))
    by_task = [{task: runs(source) - scaffold for task, source in cells.items()} for cells in solutions]
    whole = [frozenset().union(*tasks.values()) for tasks in by_task]
    found = []
    for i, j, share in _alike(whole):
        shared = by_task[i].keys() & by_task[j].keys()
        tasks = tuple(sorted(t for t in shared if _share(by_task[i][t], by_task[j][t]) >= ALIKE))
        found.append(Pair(i, j, share, tasks))
    return sorted(found, key=lambda pair: (-pair.share, pair.first, pair.second))


def runs(source) -> frozenset:
    """The runs of a source's syntax tree; none where it does not parse."""
    try:
        tree = ast.parse(source)
        walk = list(_walk(tree, _bound(tree)))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return frozenset()
    return frozenset(hash(tuple(walk[i : i + RUN])) for i in range(max(len(walk) - RUN + 1, 0)))


def _bound(tree):
    """The names that a source gives to things of its own."""
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.arg):
            names.add(node.arg)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.alias):
            names.add(node.asname or node.name)
    return names


def _walk(node, own):
    """The nodes of a tree from the outside in, as words."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
        return  # a docstring, or a string that nothing uses
    yield type(node).__name__
    if isinstance(node, ast.Name):
        yield "" if node.id in own else node.id
    elif isinstance(node, ast.Attribute):
        yield node.attr
    elif isinstance(node, ast.keyword):
        yield node.arg or "**"
    elif isinstance(node, ast.Constant):
        yield repr(node.value)
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, ast.expr_context):
            yield from _walk(child, own)


def _alike(sets):
    """(i, j, share) of the sets that have at least `ALIKE` of their union in common; memory grows with their number."""
    kept = [i for i, members in enumerate(sets) if len(members) >= LEAST_RUNS]
    index = {run: k for k, run in enumerate(sorted(frozenset().union(*(sets[i] for i in kept))))}
    both = np.zeros((len(kept), len(kept)), np.float32)
    places = [np.sort(np.fromiter((index[run] for run in sets[i]), int, len(sets[i]))) for i in kept]
    for start in range(0, len(index), BLOCK):
        block = np.zeros((len(kept), BLOCK), np.float32)
        for row, place in enumerate(places):
            low, high = np.searchsorted(place, (start, start + BLOCK))
            block[row, place[low:high] - start] = 1
        both += block @ block.T
    size = np.diagonal(both)
    share = both / np.maximum(size[:, None] + size[None, :] - both, 1)
    for a, b in np.argwhere(np.triu(share >= ALIKE, 1)):
        yield kept[a], kept[b], float(share[a, b])


def _share(a, b):
    return len(a & b) / len(a | b) if a | b else 0.0
