"""The references with one small change each, made from their syntax trees: what a check must tell from right.

Changed are operators, signs, constants, comparisons, calls, clamps, axes, arguments and statements; terms and factors
are left out.
"""

from __future__ import annotations

import ast
import copy
import inspect
import json
import textwrap
import warnings
from collections.abc import Iterator
from dataclasses import dataclass

from autograder import checks, mistakes

LEAST, MOST = 15, 40  # mutants that are wanted of a function
REASONS = checks.HERE.parent / "mistakes" / "equivalent.json"

_OPERATORS = {
    ast.Add: (ast.Sub,), ast.Sub: (ast.Add,), ast.Mult: (ast.Div, ast.Add), ast.Div: (ast.Mult,), ast.Pow: (ast.Mult,),
    ast.FloorDiv: (ast.Mult,), ast.Mod: (ast.Mult,), ast.BitAnd: (ast.BitOr,), ast.BitOr: (ast.BitAnd,),
    ast.MatMult: (),
}  # fmt: skip
_COMPARISONS = {
    ast.Lt: (ast.LtE, ast.Gt), ast.LtE: (ast.Lt, ast.Gt), ast.Gt: (ast.GtE, ast.Lt), ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,),
}  # fmt: skip
_CALLS = {
    "minimum": "maximum", "maximum": "minimum", "min": "max", "max": "min", "sin": "cos", "cos": "sin", "any": "all",
    "all": "any", "floor": "ceil", "ceil": "floor", "argmin": "argmax", "argmax": "argmin", "arcsin": "arctan",
    "arctan": "arcsin", "ones": "zeros", "zeros": "ones", "cumsum": "cumprod", "sum": "mean", "mean": "sum",
    "zeros_like": "ones_like", "ones_like": "zeros_like", "sqrt": "square", "square": "sqrt", "exp": "expm1",
    "add": "subtract", "subtract": "add", "multiply": "divide", "divide": "multiply",
}  # fmt: skip
_OF_TWO = {"minimum", "maximum", "add", "subtract", "multiply", "divide", "hypot"}


def mutants(assignment, function) -> list[mistakes.Answer]:
    """Mutants of a function of an assignment, at most MOST, spread evenly over all that there are.

    Their ids say what was changed: "smooth_union: k - distance -> k + distance".
    """
    import importlib

    module = importlib.import_module(f"solutions.{assignment}")
    task = next(t.id for t in checks.assignment(assignment).tasks if function in [f.name for f in t.functions])
    tree = ast.parse(textwrap.dedent(inspect.getsource(getattr(module, function))))
    plain = tree.body[0]
    assert isinstance(plain, ast.FunctionDef)
    plain.body = plain.body[1:] if ast.get_docstring(plain) is not None else plain.body
    seen, found = {ast.unparse(tree)}, []
    names: dict[str, int] = {}
    for what, changed in _changed(tree):
        source = ast.unparse(changed)
        if source in seen or not _is_code(source):
            continue
        seen.add(source)
        names[what] = names.get(what, 0) + 1
        id = f"{function}: {what}" + (f" ({names[what]})" if names[what] > 1 else "")
        found.append(mistakes.Answer(assignment, task, function, id, Source(source, function, module.__name__), mistakes.WRONG))
    step = max(len(found) / MOST, 1.0)
    return [found[int(i * step)] for i in range(min(len(found), MOST))]


def reasons() -> dict[str, str]:
    """Mutants that are as right as the reference, by id: why."""
    return json.loads(REASONS.read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Source:
    """A function as text, to be called: it can be handed to another process."""

    text: str
    name: str
    module: str

    def __call__(self, *arguments):
        return self.compiled(*arguments)

    @property
    def compiled(self):
        import importlib

        space = dict(vars(importlib.import_module(self.module)))
        with warnings.catch_warnings(action="ignore"):
            exec(compile(self.text, f"<mutant of {self.name}>", "exec"), space)
        return space[self.name]


def _changed(tree) -> Iterator[tuple[str, ast.AST]]:
    """(what was changed, the whole tree) for each change of each node."""
    parameters = [a.arg for a in tree.body[0].args.args]
    for index, node in enumerate(ast.walk(tree)):
        for new in [*_variants(node), *_other_argument(node, parameters)]:
            whole = copy.deepcopy(tree)
            place = list(ast.walk(whole))[index]
            yield f"{_said(node)} -> {_said(new)}", _Replace(place, new).visit(whole)


def _is_code(source):
    """Whether a change has left a program: a starred expression cannot stand everywhere."""
    try:
        with warnings.catch_warnings(action="ignore"):
            compile(source, "<mutant>", "exec")
    except SyntaxError:
        return False
    return True


def _said(node):
    return ast.unparse(node).split("\n")[0]


class _Replace(ast.NodeTransformer):
    def __init__(self, old, new):
        self._old, self._new = old, ast.fix_missing_locations(ast.copy_location(new, old))

    def visit(self, node):
        return self._new if node is self._old else self.generic_visit(node)


def _variants(node) -> Iterator[ast.AST]:
    """What may stand in a node's place."""
    if isinstance(node, ast.BinOp):
        for op in _OPERATORS.get(type(node.op), ()):
            yield ast.BinOp(node.left, op(), node.right)
        yield node.left
        if not isinstance(node.op, ast.Pow):
            yield node.right
        if isinstance(node.op, ast.Sub):
            yield ast.BinOp(node.right, ast.Sub(), node.left)
    elif isinstance(node, ast.UnaryOp):
        yield node.operand
    elif isinstance(node, ast.Compare) and len(node.ops) == 1:
        for comparison in _COMPARISONS.get(type(node.ops[0]), ()):
            yield ast.Compare(node.left, [comparison()], node.comparators)
    elif isinstance(node, ast.Constant):
        yield from map(ast.Constant, _numbers(node.value))
    elif isinstance(node, ast.Call):
        yield from _calls(node)
    elif isinstance(node, (ast.AugAssign, ast.Expr)) or (isinstance(node, ast.If) and not node.orelse):
        yield ast.Pass()


def _other_argument(node, parameters):
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in parameters:
        yield from (ast.Name(name, ast.Load()) for name in parameters if name != node.id)


def _numbers(value):
    if isinstance(value, bool):
        return []
    if isinstance(value, int):
        return [value + 1, value - 1]
    if isinstance(value, float):
        return [2 * value, value / 2] if value else [1.0]
    return []


def _calls(node):
    name = getattr(node.func, "attr", getattr(node.func, "id", ""))
    if name in _CALLS and isinstance(node.func, ast.Attribute):
        yield ast.Call(ast.Attribute(node.func.value, _CALLS[name], ast.Load()), node.args, node.keywords)
    if name in _OF_TWO and len(node.args) == 2:
        yield from node.args
    elif name == "clip" and len(node.args) == 3:
        value, low, high = node.args
        yield value
        for one_sided, bound in (("maximum", low), ("minimum", high)):
            yield ast.Call(ast.Attribute(ast.Name("np", ast.Load()), one_sided, ast.Load()), [value, bound], [])
    elif name == "where" and len(node.args) == 3:
        choice, first, second = node.args
        yield from (ast.Call(node.func, [choice, second, first], []), first, second)
    elif node.args:
        yield node.args[0]
    for keyword in node.keywords:
        if keyword.arg != "strict":
            yield ast.Call(node.func, node.args, [k for k in node.keywords if k is not keyword])
