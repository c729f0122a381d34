"""Mutations: small faults that could be planted in a Python source, each as a piece of text and what takes its place.

Left alone are words (messages, docstrings, what is raised), annotations, decorators, imports and types.
"""

from __future__ import annotations

import ast
import copy
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

_BOUNDARY = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
_NEGATED = {
    ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
}  # fmt: skip
_ARITHMETIC = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Mod: ast.FloorDiv, ast.Pow: ast.Mult, ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.BitXor: ast.BitOr,
    ast.LShift: ast.RShift, ast.RShift: ast.LShift,
}  # fmt: skip
_PAIRS = [
    ("min", "max"), ("argmin", "argmax"), ("minimum", "maximum"), ("fmin", "fmax"), ("all", "any"), ("sin", "cos"),
    ("sinh", "cosh"), ("arctan", "arcsin"), ("floor", "ceil"), ("zeros", "ones"), ("first", "last"), ("log", "log2"),
    ("union1d", "intersect1d"), ("startswith", "endswith"), ("zeros_like", "ones_like"), ("cumsum", "cumprod"),
]  # fmt: skip
_OTHER_NAME = {a: b for pair in _PAIRS for a, b in (pair, pair[::-1])}
_WRAPPERS = {"abs", "sqrt", "sort", "sorted", "reversed", "unique", "exp", "square", "transpose", "round", "log"}
# Of two arguments of one type.
_NOT_SYMMETRIC = {"cross", "arctan2", "geodesic", "log", "chord", "divmod", "setdiff1d", "isin", "subtract"}
_LEFT_KEYWORDS = {"dtype", "kind", "strict", "copy", "encoding", "category", "stacklevel", "flush", "help", "metavar"}
_ZEROS = {"float": "0.0", "int": "0", "str": "''", "list": "[]", "tuple": "()", "dict": "{}"}
_ARRAYS = ("Floats", "Ints", "Bools", "NDArray")


@dataclass(frozen=True)
class Mutation:
    """One fault: `new` takes the place of the bytes start to end of the source."""

    kind: str
    function: str
    line: int
    start: int
    end: int
    old: str
    new: str

    @property
    def text(self) -> str:
        """The mutation in words: what stood there and what stands there now."""
        return f"{self.kind}: `{_short(self.old)}` -> `{_short(self.new)}`"

    def planted(self, source: bytes) -> bytes:
        """The source with the fault in it."""
        return source[: self.start] + self.new.encode() + source[self.end :]

    def key(self, path: str, number: int) -> str:
        """A name that stays the same when other lines of the file change; number: among mutations alike in all else."""
        words = (path, self.function, self.text, str(number))
        return hashlib.sha256("\n".join(words).encode()).hexdigest()[:16]


def _short(text: str, most: int = 70) -> str:
    line = " ".join(text.split())
    return line if len(line) <= most else line[: most - 2] + " …"


def mutations(source: bytes) -> list[Mutation]:
    """All mutations of a source, in the order of its lines; those that are no Python are left out."""
    finder = _Finder(source)
    finder.visit(ast.parse(source))
    return sorted(finder.found, key=lambda m: (m.start, m.end, m.kind, m.new))


class _Finder:
    """Goes through a syntax tree and notes what could be changed."""

    def __init__(self, source: bytes) -> None:
        self.source, self.found, self.names = source, list[Mutation](), list[str]()
        self.returns: list[str] = []
        self.starts = [0]
        for line in source.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))

    def visit(self, node: ast.AST) -> None:
        """Note what could be changed in a node and below it."""
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            self._visit_definition(node)
            return
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            return
        if isinstance(node, ast.stmt):
            self._note(node, _changed_statements(node, self.returns[-1] if self.returns else ""))
        elif isinstance(node, ast.expr):
            self._note(node, _changed_expressions(node))
        for child in _children(node):
            self.visit(child)

    def _visit_definition(self, node: ast.FunctionDef | ast.ClassDef) -> None:
        self.names.append(node.name)
        if isinstance(node, ast.FunctionDef):
            self.returns.append(ast.unparse(node.returns) if node.returns else "")
            for default in (*node.args.defaults, *node.args.kw_defaults):
                if default is not None:
                    self.visit(default)
        for statement in node.body:
            self.visit(statement)
        if isinstance(node, ast.FunctionDef):
            self.returns.pop()
        self.names.pop()

    def _note(self, node: ast.stmt | ast.expr, changes: Iterator[tuple[str, str]]) -> None:
        start, end = self._offset(node.lineno, node.col_offset), self._offset(node.end_lineno, node.end_col_offset)
        old = self.source[start:end].decode()
        for kind, new in changes:
            self.found.append(Mutation(kind, ".".join(self.names), node.lineno, start, end, old, new))

    def _offset(self, line: int | None, column: int | None) -> int:
        assert line is not None
        assert column is not None
        return self.starts[line - 1] + column


def _children(node: ast.AST) -> Iterator[ast.AST]:
    """Those parts of a node in which a mutation means something."""
    if isinstance(node, ast.Raise | ast.Assert | ast.Import | ast.ImportFrom | ast.JoinedStr):
        return
    if isinstance(node, ast.AnnAssign):
        yield from [node.value] if node.value is not None else []
        return
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return
    if isinstance(node, ast.Call) and _called(node) in ("warn", "isinstance", "issubclass", "njit", "TypeVar"):
        return
    yield from ast.iter_child_nodes(node)


def _changed_expressions(node: ast.expr) -> Iterator[tuple[str, str]]:
    """The kind of a change and the expression that takes the place, in brackets where it needs them."""
    for kind, changed in _changes(node):
        text = ast.unparse(changed)
        yield kind, text if isinstance(changed, ast.Constant | ast.Name | ast.Call) else f"({text})"


def _changes(node: ast.expr) -> Iterator[tuple[str, ast.expr]]:
    match node:
        case ast.Compare():
            yield from _comparisons(node)
        case ast.BinOp(left=left, op=op, right=right) if not (_is_type(left) or _is_type(right)):
            if type(op) in _ARITHMETIC:
                yield "arithmetic", ast.BinOp(left, _ARITHMETIC[type(op)](), right)
            elif isinstance(op, ast.MatMult):
                yield "operands swapped", ast.BinOp(right, op, left)
        case ast.UnaryOp(op=ast.USub() | ast.Not() | ast.Invert(), operand=operand):
            yield "sign dropped", operand
        case ast.BoolOp(op=op, values=values):
            yield "and/or", ast.BoolOp(ast.Or() if isinstance(op, ast.And) else ast.And(), values)
            yield "condition dropped", ast.BoolOp(op, values[:-1]) if len(values) > 2 else values[0]
            yield "condition dropped", ast.BoolOp(op, values[1:]) if len(values) > 2 else values[1]
        case ast.IfExp(test=test, body=body, orelse=orelse):
            yield "branches swapped", ast.IfExp(test, orelse, body)
        case ast.Constant(value=value):
            yield from (("constant", ast.Constant(other)) for other in _other_constants(value))
        case ast.Call():
            yield from _calls(node)


def _comparisons(node: ast.Compare) -> Iterator[tuple[str, ast.expr]]:
    for k, op in enumerate(node.ops):
        for kind, table in (("boundary", _BOUNDARY), ("comparison", _NEGATED)):
            if type(op) in table:
                changed = copy.deepcopy(node)
                changed.ops[k] = table[type(op)]()
                yield kind, changed


def _other_constants(value: object) -> list[bool | int | float]:
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1] if value <= 0 else [value + 1, value - 1]
    if isinstance(value, float):
        return [1.0] if value == 0 else [value * 1000] if abs(value) < 0.01 else [value * 1.5]
    return []


def _calls(node: ast.Call) -> Iterator[tuple[str, ast.expr]]:
    name = _called(node)
    if name in _OTHER_NAME:
        changed = copy.deepcopy(node)
        if isinstance(changed.func, ast.Name):
            changed.func.id = _OTHER_NAME[name]
        elif isinstance(changed.func, ast.Attribute):
            changed.func.attr = _OTHER_NAME[name]
        yield "other function", changed
    if name in _WRAPPERS and len(node.args) == 1:
        yield "call dropped", node.args[0]
    if name == "range" and node.args:
        stop = min(1, len(node.args) - 1)
        shorter = ast.BinOp(node.args[stop], ast.Sub(), ast.Constant(1))
        yield "range shorter", ast.Call(node.func, [*node.args[:stop], shorter, *node.args[stop + 1 :]], [])
    if name == "where" and len(node.args) == 3:
        yield "branches swapped", ast.Call(node.func, [node.args[0], node.args[2], node.args[1]], [])
    if name in _NOT_SYMMETRIC and len(node.args) >= 2:
        yield "arguments swapped", ast.Call(node.func, [node.args[1], node.args[0], *node.args[2:]], node.keywords)
    for k, keyword in enumerate(node.keywords):
        if keyword.arg is not None and keyword.arg not in _LEFT_KEYWORDS:
            yield "keyword dropped", ast.Call(node.func, node.args, node.keywords[:k] + node.keywords[k + 1 :])


def _changed_statements(node: ast.stmt, returns: str) -> Iterator[tuple[str, str]]:
    """The kind of a change and the statement, or the test of an `if`, that takes the place."""
    match node:
        case ast.Expr(value=ast.Call() as call) if _called(call) not in ("warn", "__init__", "add", "add_argument"):
            yield "statement dropped", "pass"
        case ast.AugAssign(target=target, op=op, value=value):
            yield "statement dropped", "pass"
            if type(op) in _ARITHMETIC:
                yield "arithmetic", ast.unparse(ast.AugAssign(target, _ARITHMETIC[type(op)](), value))
        case ast.Assign(targets=[ast.Subscript() | ast.Attribute()]):
            yield "statement dropped", "pass"
        case ast.Assign(targets=[ast.Name(id=name)], value=value) if name in _names(value):
            yield "statement dropped", "pass"
        case ast.Break():
            yield "break/continue", "continue"
        case ast.Continue():
            yield "break/continue", "break"
        case ast.Return(value=ast.expr() as value) if not isinstance(value, ast.Constant):
            yield from _returns(value, returns)
        case ast.If() if not node.orelse:
            yield "check left out" if isinstance(node.body[-1], ast.Raise) else "branch left out", "pass"


def _returns(value: ast.expr, annotation: str) -> Iterator[tuple[str, str]]:
    text = ast.unparse(value)
    if annotation.startswith(_ARRAYS):
        yield "returned constant", f"return 0 * ({text})"
    elif annotation == "bool":
        yield "returned constant", "return True"
        yield "returned constant", "return False"
    elif annotation.split("[")[0] in _ZEROS and annotation.count("|") == 0:
        yield "returned constant", f"return {_ZEROS[annotation.split('[')[0]]}"


def _called(node: ast.Call) -> str:
    return node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")


def _names(node: ast.AST) -> set[str]:
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


def _is_type(node: ast.expr) -> bool:
    """Whether an operand of | is a type, as in `int | None`."""
    if isinstance(node, ast.Constant):
        return node.value is None
    name = getattr(node, "attr", getattr(node, "id", ""))
    return name[:1].isupper() or name in ("int", "float", "str", "bytes", "complex", "bool")
