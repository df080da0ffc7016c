"""Mutants of a Python source: one expression or statement changed, the rest of the text as it stands."""

from __future__ import annotations

import ast
from dataclasses import dataclass

COMPARISONS: dict[type[ast.cmpop], tuple[str, ...]] = {
    ast.Lt: (">=", ">"), ast.LtE: (">", ">="), ast.Gt: ("<=", "<"), ast.GtE: ("<", "<="),
    ast.Eq: ("!=",), ast.NotEq: ("==",), ast.Is: ("is not",), ast.IsNot: ("is",),
    ast.In: ("not in",), ast.NotIn: ("in",),
}  # fmt: skip
ARITHMETIC: dict[type[ast.operator], str] = {
    ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.Mod: "+", ast.FloorDiv: "*",
}  # fmt: skip
OTHER_FUNCTION = {
    "min": "max", "max": "min", "any": "all", "all": "any", "sin": "cos", "cos": "sin", "minimum": "maximum",
    "maximum": "minimum", "argmin": "argmax", "argmax": "argmin", "floor": "ceil", "ceil": "floor",
}  # fmt: skip
SYMMETRIC = {"min", "max", "minimum", "maximum", "hypot", "dist", "array_equal"}
NOT_BEHAVIOUR = {"info", "warning", "debug", "getLogger", "TypeVar", "NewType"}  # text for people, and types


@dataclass(frozen=True)
class Mutant:
    """A change of one place of a module; ``function``: qualified name of the function that it is in, empty outside."""

    path: str
    line: int
    function: str
    kind: str
    begin: int
    end: int
    original: str
    replacement: str
    text: str
    """The line that it begins in."""

    def is_python(self, source: bytes) -> bool:
        """Return whether the changed source can be parsed."""
        try:
            ast.parse(self.apply(source))
        except SyntaxError:
            return False
        return True

    def apply(self, source: bytes) -> bytes:
        """Return the source with the change."""
        return source[: self.begin] + self.replacement.encode() + source[self.end :]

    def __str__(self) -> str:
        return f"{self.path}:{self.line} {self.kind}: {_short(self.original)}  ->  {_short(self.replacement)}"


def mutants_of(path: str, source: str) -> list[Mutant]:
    """Return all mutants of a module, in the order of the text."""
    return sorted(_Places(path, source).found, key=lambda mutant: (mutant.begin, mutant.end, mutant.replacement))


class _Places(ast.NodeVisitor):
    """A walk over a module that gathers its mutants."""

    def __init__(self, path: str, source: str) -> None:
        self.path, self.raw = path, source.encode()
        self.lines = source.splitlines()
        self.line_starts = [0]
        for line in self.raw.splitlines(keepends=True):
            self.line_starts.append(self.line_starts[-1] + len(line))
        self.scope: list[str] = []
        self.in_function = False
        self.found: list[Mutant] = []
        self.visit(ast.parse(source))

    def add(self, node: ast.expr | ast.stmt, kind: str, replacement: str) -> None:
        begin, end = self.span(node)
        original, function = self.raw[begin:end].decode(), ".".join(self.scope) if self.in_function else ""
        if replacement != original:
            text = self.lines[node.lineno - 1].strip()
            self.found.append(Mutant(self.path, node.lineno, function, kind, begin, end, original, replacement, text))

    def span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None and node.end_col_offset is not None
        begin = self.line_starts[node.lineno - 1] + node.col_offset
        return begin, self.line_starts[node.end_lineno - 1] + node.end_col_offset

    def source(self, node: ast.expr | ast.stmt) -> str:
        begin, end = self.span(node)
        return self.raw[begin:end].decode()

    def leave(self, node: ast.AST) -> None:
        """Leave a node as it is: it has no behaviour, or only a text."""

    visit_Import = visit_ImportFrom = visit_JoinedStr = visit_Assert = visit_arg = leave

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        inside, self.in_function = self.in_function, True
        self.scope.append(node.name)
        for default in (*node.args.defaults, *node.args.kw_defaults):
            if default is not None:
                self.visit(default)
        for statement in node.body:
            self.visit(statement)
        self.scope.pop()
        self.in_function = inside

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        self.scope.append(node.name)
        for statement in node.body:
            self.visit(statement)
        self.scope.pop()

    def drop(self, node: ast.stmt) -> None:
        self.add(node, "statement dropped", "pass")

    visit_Raise = visit_Continue = visit_Break = drop

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Call) and _name(node.value.func) not in NOT_BEHAVIOUR:
            self.drop(node)
            self.visit(node.value)

    def visit_Assign(self, node: ast.Assign) -> None:
        if any(isinstance(target, ast.Attribute | ast.Subscript) for target in node.targets):
            self.drop(node)
        self.generic_visit(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self.drop(node)
        self.visit(node.value)

    def visit_test(self, node: ast.If | ast.While | ast.IfExp) -> None:
        if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            return  # imports for types alone
        if not isinstance(node.test, ast.Compare | ast.UnaryOp):  # these have mutants of their own
            self.add(node.test, "condition negated", f"(not ({self.source(node.test)}))")
        self.generic_visit(node)

    visit_If = visit_While = visit_IfExp = visit_test

    def visit_Compare(self, node: ast.Compare) -> None:
        if len(node.ops) == 1:
            left, right = self.source(node.left), self.source(node.comparators[0])
            for other in COMPARISONS[type(node.ops[0])]:
                self.add(node, "comparison", f"({left} {other} {right})")
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        if (other := ARITHMETIC.get(type(node.op))) and not _is_text(node.left):
            self.add(node, "operator", f"({self.source(node.left)} {other} {self.source(node.right)})")
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        word = " or " if isinstance(node.op, ast.And) else " and "
        self.add(node, "operator", "(" + word.join(f"({self.source(value)})" for value in node.values) + ")")
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.USub | ast.Not):
            self.add(node, "sign", f"({self.source(node.operand)})")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, bool):
            self.add(node, "constant", str(not node.value))
        elif isinstance(node.value, int):
            self.add(node, "constant", str(node.value + 1))
        elif isinstance(node.value, float):
            self.add(node, "constant", "1.0" if node.value == 0.0 else f"(1.5 * {self.source(node)})")

    def visit_Call(self, node: ast.Call) -> None:
        name = _name(node.func)
        if name in NOT_BEHAVIOUR:
            return
        if other := OTHER_FUNCTION.get(name):
            function = self.source(node.func)
            arguments = self.source(node)[len(function) :]
            self.add(node, "function", function.removesuffix(name) + other + arguments)
        if (
            len(node.args) >= 2
            and name not in SYMMETRIC
            and not any(isinstance(argument, ast.Starred) for argument in node.args[:2])
        ):
            (begin, end), (a, b), (c, d) = self.span(node), self.span(node.args[0]), self.span(node.args[1])
            parts = (self.raw[begin:a], self.raw[c:d], self.raw[b:c], self.raw[a:b], self.raw[d:end])
            self.add(node, "arguments swapped", b"".join(parts).decode())
        self.generic_visit(node)

    def visit_keyword(self, node: ast.keyword) -> None:
        if node.arg != "strict":  # zip's own assertion
            self.generic_visit(node)

    def visit_Slice(self, node: ast.Slice) -> None:
        if node.lower is None and node.upper is not None:
            self.slice(node, f"{self.source(node.upper)}:")
        elif node.upper is None and node.lower is not None:
            self.slice(node, f":{self.source(node.lower)}")
        self.generic_visit(node)

    def slice(self, node: ast.Slice, replacement: str) -> None:
        if node.step is None:
            self.add(node, "slice", replacement)


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _name(function: ast.expr) -> str:
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def _short(text: str, most: int = 60) -> str:
    text = " ".join(text.split())
    return text if len(text) <= most else text[: most - 3] + "..."
