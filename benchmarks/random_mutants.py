"""Random faults in lines of numbers: the tests should find each that changes a number a user gets.

    python benchmarks/random_mutants.py [--seed 1] [--number 100]

Each line of tol3d/ with arithmetic, a comparison, a number, a sign, an index or one of FUNCTIONS is drawn with the same
probability, then one of its faults. Rooms and files that lay out pages, charts and console text are left out, and so
are annotations, decorators, error messages and formatted text. A row is file, line, the line as it is and with its
fault. Nothing is run and no file is changed: put a line into a copy of the tree and run the tests there.
"""

import argparse
import ast
import random
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LAID_OUT = re.compile(
    r"/(report|presenting|cli|shown)/|/(shown(_\w*)?|presenting|notebook|(\w*_)?(picture|charts|tables?|section))\.py$"
)
OPERATORS: dict[type[ast.AST], tuple[str, tuple[str, ...]]] = {
    ast.Add: ("+", ("-",)),
    ast.Sub: ("-", ("+",)),
    ast.Mult: ("*", ("/",)),
    ast.Div: ("/", ("*",)),
    ast.Pow: ("**", ("*",)),
    ast.Lt: ("<", ("<=", ">")),
    ast.LtE: ("<=", ("<", ">=")),
    ast.Gt: (">", (">=", "<")),
    ast.GtE: (">=", (">", "<=")),
    ast.Eq: ("==", ("!=",)),
    ast.NotEq: ("!=", ("==",)),
}
"""The text of an operator and what may stand in its place: of a comparison its limit or its direction changes."""
PAIRS = (
    ("min", "max"), ("minimum", "maximum"), ("argmin", "argmax"), ("sin", "cos"), ("floor", "ceil"), ("any", "all"),
)  # fmt: skip
FUNCTIONS = dict(PAIRS) | {second: first for first, second in PAIRS}


@dataclass(frozen=True)
class Fault:
    """A line and the line with a fault in it.

    Args:
        file: below the root.
        line: its number, from 1.
        old, new: its text without and with the fault.
    """

    file: str
    line: int
    old: str
    new: str


def faults(file: str, source: str) -> list[Fault]:
    """Every fault that can be put into a source, in the order of its lines."""
    lines = source.splitlines()
    made = []
    for line, start, end, text in _changes(ast.parse(source), source.encode().splitlines()):
        own = lines[line - 1].encode()
        made.append(Fault(file, line, own.decode(), (own[:start] + text.encode() + own[end:]).decode()))
    return sorted(made, key=lambda fault: fault.line)


def drawn(seed: int, number: int, root: Path = ROOT) -> list[Fault]:
    """So many faults on lines of their own."""
    by_line: dict[tuple[str, int], list[Fault]] = {}
    for path in sorted((root / "tol3d").rglob("*.py")):
        file = path.relative_to(root).as_posix()
        if not LAID_OUT.search(file):
            for fault in faults(file, path.read_text("utf-8")):
                by_line.setdefault((file, fault.line), []).append(fault)
    chance = random.Random(seed)
    return [chance.choice(by_line[place]) for place in chance.sample(sorted(by_line), number)]


def _changes(
    node: ast.AST, lines: Sequence[bytes], parent: ast.AST | None = None
) -> Iterator[tuple[int, int, int, str]]:
    """Line, first and last byte and new text of each change to a node and those below it."""
    if isinstance(node, ast.JoinedStr | ast.Raise):
        return
    match node:
        case (
            ast.BinOp(left=left, op=operator, right=right) | ast.Compare(left=left, ops=[operator], comparators=[right])
        ):
            if not any(
                isinstance(side, ast.JoinedStr | ast.List | ast.Tuple) or _is_text(side) for side in (left, right)
            ):
                yield from _operator(operator, left, right, lines)
        case ast.UnaryOp(op=ast.USub()):
            yield node.lineno, node.col_offset, node.col_offset + 1, ""
        case ast.Constant(value=float() | int() as value) if not isinstance(value, bool):
            if isinstance(value, float) or isinstance(parent, ast.BinOp | ast.Compare | ast.Subscript):
                yield node.lineno, node.col_offset, node.end_col_offset or 0, _other(value)
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name) as function) if name in FUNCTIONS:
            end = function.end_col_offset or 0
            yield function.end_lineno or 0, end - len(name), end, FUNCTIONS[name]
    for field, child in ast.iter_fields(node):
        if field not in ("annotation", "returns", "decorator_list"):
            for own in child if isinstance(child, list) else [child]:
                if isinstance(own, ast.AST):
                    yield from _changes(own, lines, node)


def _operator(
    operator: ast.AST, left: ast.expr, right: ast.expr, lines: Sequence[bytes]
) -> Iterator[tuple[int, int, int, str]]:
    old, others = OPERATORS.get(type(operator), ("", ()))
    if not old:
        return
    for line in range(left.end_lineno or 0, right.lineno + 1):
        start = (left.end_col_offset or 0) if line == left.end_lineno else 0
        end = right.col_offset if line == right.lineno else len(lines[line - 1])
        place = lines[line - 1][:end].partition(b"#")[0].find(old.encode(), start)
        if place >= 0:
            yield from ((line, place, place + len(old), other) for other in others)
            return


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _other(value: float) -> str:
    """Another number: a whole one's next, one and a half times any other, 1 for 0."""
    if isinstance(value, int):
        return str(value + 1)
    return repr(1.5 * value) if value else "1.0"


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--number", type=int, default=100)
    given = parser.parse_args(arguments)
    for fault in drawn(given.seed, given.number):
        print(f"{fault.file}:{fault.line}\n    {fault.old.strip()}\n    {fault.new.strip()}")


if __name__ == "__main__":
    main()
