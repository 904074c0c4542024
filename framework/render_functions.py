"""The contract's functions as the renderer is handed them: found by name, counted, with a budget where they take one."""

import inspect
from collections.abc import Mapping


class Functions:
    """Functions by name, from a mapping, a module, an object, or several of them in the order of preference."""

    def __init__(self, places):
        self._places = places if isinstance(places, list | tuple) else [places]

    def get(self, name, purpose):
        """The first function of that name; a ValueError that says what it is wanted for where there is none."""
        for place in self._places:
            found = place.get(name) if isinstance(place, Mapping) else getattr(place, name, None)
            if found is not None:
                return found
        raise ValueError(f"render_scene: functions has no {name}; one is wanted for {purpose}")


def reads_trees(function):
    """Marks a function that reads the tree of a field, as compiled ones do, instead of calling it."""
    function.reads_trees = True
    return function


def counted(function, field, *args):
    """`function(field, *args)`, and how many distances it asked for; 0 for functions that read trees."""
    if getattr(function, "reads_trees", False):
        return function(field, *args), 0
    evaluations = 0

    def distance(points):
        nonlocal evaluations
        evaluations += points[..., 0].size
        return field(points)

    return function(distance, *args), evaluations


def budgeted(function, *args, samples):
    """`(result, samples used)`: the function's result, with the budget if it takes one; else 1 sample was used."""
    if "samples" in inspect.signature(function).parameters:
        return function(*args, samples), samples
    return function(*args), 1
