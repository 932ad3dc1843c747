"""The structure of the house in numbers, for one tree or several side by side.

    python benchmarks/structure.py [--tree . ../older] [--route] [--scene spur_pair] [--trials 256]

A room is a file or folder at the top of tol3d/, and parts/. Arrows are distinct imports from one room by another;
imports for type checkers only and those of tol3d/__init__.py, which names what it offers, are left out. Levels are the
rooms on the longest path of arrows, where rooms that import each other in a circle stand on one level. Cycles between
files include imports for type checkers.

One scene is followed through run_scene, once kernels are compiled and modules loaded: a move is a call of a function of
another room than that of the call before, a return is a move to a room that was left before. `--route` prints the
rooms that run_scene calls, in order, itself or by other functions of its file.
"""

import argparse
import ast
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from graphlib import TopologicalSorter
from itertools import pairwise
from pathlib import Path
from statistics import median
from types import FrameType

import grimp
import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

ROOT = Path(__file__).resolve().parent.parent
LONGEST_FILE = 350  # lines
LONGEST_FUNCTION = 60  # lines, docstring included
SHORT_FILE, SHORT_FUNCTION = 40, 6  # lines

WIDTH = 150  # characters

Arrows = Mapping[str, set[str]]

KERNELS = frozenset(("kernel", "nested", "part", "variant", "inlined"))
"""Decorators of functions that are compiled, which write their results into arrays that they are given."""
CHANGES = {
    *("add", "append", "clear", "discard", "extend", "fill", "insert", "pop", "popitem", "remove", "reverse"),
    *("setdefault", "sort", "update"),
}
"""Methods that change what they are called on."""


@dataclass(frozen=True)
class Lengths:
    """Lines of files and functions: the largest of each by name, and how many are over the house's limit."""

    files: int
    largest_file: str
    files_over: int
    longest_function: str
    functions_over: int


@dataclass(frozen=True)
class Reading:
    """Lengths and names that a reader of a tree meets.

    Args:
        lines: of all files, and of one in the middle.
        short_files: of fewer than SHORT_FILE lines.
        imports: share of the lines that are imports [%].
        function: lines of the function in the middle.
        private: functions of modules whose names begin with an underscore.
        once: those of them that are named at one place, and their lines.
        short: those of them of SHORT_FUNCTION lines or fewer.
        own: how often a variable `own` is read.
    """

    lines: int
    file: float
    short_files: int
    imports: float
    function: float
    private: int
    once: int
    once_lines: int
    short: int
    own: int


@dataclass(frozen=True)
class Walk:
    """One scene followed through run_scene.

    Args:
        entered: distinct rooms whose functions were called.
        moves: calls of another room's function than the call before.
        kinds_of_moves: distinct pairs of rooms among them.
        returns: moves to a room that was left before.
        route: rooms that run_scene and other functions of its file call, in order, neighbours merged.
    """

    entered: int
    moves: int
    kinds_of_moves: int
    returns: int
    route: tuple[str, ...]

    @property
    def route_returns(self) -> int:
        """Number of times that run_scene itself calls a room that it left before."""
        return len(self.route) - len(set(self.route))


@dataclass(frozen=True)
class Structure:
    """A tree in numbers."""

    loose_files: int
    rooms: int
    levels: int
    file_levels: int
    arrows: int
    room_cycles: tuple[str, ...]
    file_cycles: tuple[str, ...]
    writers: int
    lengths: Lengths
    reading: Reading
    walk: Walk


def room_of(module: str) -> str:
    """The room of a module such as `tol3d.study.tallies.tally`."""
    return module.split(".")[1]


def arrows_between_files(*, type_checking: bool) -> dict[str, set[str]]:
    """Modules that each module imports; the package tol3d itself is left out."""
    graph = grimp.build_graph("tol3d", exclude_type_checking_imports=not type_checking, cache_dir=None)
    modules = graph.modules - {"tol3d"}
    return {module: graph.find_modules_directly_imported_by(module) - {"tol3d"} for module in sorted(modules)}


def arrows_between_rooms(files: Arrows) -> dict[str, set[str]]:
    """Rooms that each room imports."""
    rooms: dict[str, set[str]] = {room_of(module): set() for module in files}
    for module, imported in files.items():
        rooms[room_of(module)] |= {room_of(other) for other in imported} - {room_of(module)}
    return rooms


def circles(arrows: Arrows) -> list[list[str]]:
    """Strongly connected sets: those who import each other in a circle, and each other one alone."""
    names = sorted(arrows)
    place = {name: i for i, name in enumerate(names)}
    pairs = np.array([(place[a], place[b]) for a in names for b in arrows[a]], dtype=np.intp).reshape(-1, 2)
    matrix = csr_array((np.ones(len(pairs)), pairs.T), shape=(len(names), len(names)))
    count, label = connected_components(matrix, directed=True, connection="strong")
    return [[name for name, of in zip(names, label, strict=True) if of == circle] for circle in range(count)]


def levels(arrows: Arrows) -> int:
    """Places on the longest path, each circle one place."""
    circle_of = {name: i for i, circle in enumerate(circles(arrows)) for name in circle}
    below: dict[int, set[int]] = {i: set() for i in circle_of.values()}
    for name, imported in arrows.items():
        below[circle_of[name]] |= {circle_of[other] for other in imported} - {circle_of[name]}
    height: dict[int, int] = {}
    for i in TopologicalSorter(below).static_order():
        height[i] = 1 + max((height[j] for j in below[i]), default=0)
    return max(height.values())


def named(arrows: Arrows) -> tuple[str, ...]:
    """Circles of more than one, in words."""
    return tuple(" <-> ".join(circle) for circle in circles(arrows) if len(circle) > 1)


def functions(file: Path) -> Iterator[tuple[str, int]]:
    """Name and lines of each function of a file."""
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, (node.end_lineno or node.lineno) - node.lineno + 1


def lengths(package: Path) -> Lengths:
    """Lengths of a package's files and functions."""
    paths = sorted(package.rglob("*.py"))
    files = [(len(path.read_text("utf-8").splitlines()), str(path.relative_to(package))) for path in paths]
    found = [(lines, f"{path.relative_to(package)}:{name}") for path in paths for name, lines in functions(path)]
    return Lengths(
        files=len(files),
        largest_file="{1} ({0})".format(*max(files)),
        files_over=sum(lines > LONGEST_FILE for lines, _ in files),
        longest_function="{1} ({0})".format(*max(found)),
        functions_over=sum(lines > LONGEST_FUNCTION for lines, _ in found),
    )


def reading(package: Path) -> Reading:
    """Count what a reader of a package meets."""
    sizes, imports, found, private, own = list[int](), 0, list[int](), 0, 0
    once = list[int]()
    for path in sorted(package.rglob("*.py")):
        text = path.read_text("utf-8")
        tree = ast.parse(text)
        sizes.append(len(text.splitlines()))
        found += [lines for _, lines in functions(path)]
        nodes = [*ast.walk(tree)]
        names = Counter(node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load))
        own += names["own"]
        imports += sum(
            (node.end_lineno or node.lineno) - node.lineno + 1
            for node in nodes
            if isinstance(node, ast.Import | ast.ImportFrom)
        )
        hidden = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name.startswith("_")]
        private += len(hidden)
        once += [(node.end_lineno or node.lineno) - node.lineno + 1 for node in hidden if names[node.name] == 1]
    return Reading(
        lines=sum(sizes),
        file=median(sizes),
        short_files=sum(size < SHORT_FILE for size in sizes),
        imports=100 * imports / sum(sizes),
        function=median(found),
        private=private,
        once=len(once),
        once_lines=sum(once),
        short=sum(lines <= SHORT_FUNCTION for lines in once),
        own=own,
    )


def writers(source: str) -> list[str]:
    """Names of functions of a module that write into an argument; compiled ones and `self` are left out."""
    found = []
    for own in ast.walk(ast.parse(source)):
        if not isinstance(own, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        told = (each.func if isinstance(each, ast.Call) else each for each in own.decorator_list)
        if not KERNELS.isdisjoint(each.id for each in told if isinstance(each, ast.Name)):
            continue
        nodes = list(_inside(own))
        rebound = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        given = {each.arg for each in (*own.args.posonlyargs, *own.args.args, *own.args.kwonlyargs)}
        if not (given - rebound - {"self", "cls"}).isdisjoint(map(_written, nodes)):
            found.append(own.name)
    return found


def _inside(function: ast.AST) -> Iterator[ast.AST]:
    """Nodes of a function, without those of functions in it."""
    for node in ast.iter_child_nodes(function):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            yield node
            yield from _inside(node)


def _written(node: ast.AST) -> str:
    """The variable into which a node writes: an item or attribute of it, or by a method or `out=`; "" for none."""
    match node:
        case ast.Attribute(ctx=ast.Store() | ast.Del()) | ast.Subscript(ctx=ast.Store() | ast.Del()):
            target: ast.AST = node
        case ast.Call(func=ast.Attribute(attr=attr, value=value)) if attr in CHANGES:
            target = value
        case ast.keyword(arg="out", value=value):
            target = value
        case _:
            return ""
    while isinstance(target, ast.Attribute | ast.Subscript):
        target = target.value
    return target.id if isinstance(target, ast.Name) else ""


class Follower:
    """Notes the rooms of the package's functions as they are called, by sys.setprofile."""

    def __init__(self, package: Path) -> None:
        self.package = str(package) + os.sep
        self.rooms: list[str] = []
        self.called_by_run_scene: list[str] = []

    def __call__(self, frame: FrameType, event: str, argument: object) -> None:
        """Note a call."""
        if event != "call" or (room := self.room(frame)) is None:
            return
        if not self.rooms or self.rooms[-1] != room:
            self.rooms.append(room)
        caller = frame.f_back
        if room != "simulate" and caller is not None and self.room(caller) == "simulate":
            self.called_by_run_scene.append(room)

    def room(self, frame: FrameType) -> str | None:
        """The room that a frame's code lies in; None outside the package, and for its __init__.py."""
        file = frame.f_code.co_filename
        if not file.startswith(self.package):
            return None
        top = Path(file.removeprefix(self.package)).parts[0].removesuffix(".py")
        return None if top == "__init__" else top


def walk(package: Path, scene: str, trials: int) -> Walk:
    """Follow a bundled scene: the second run of two, so that nothing is compiled or imported any more."""
    from tol3d import Overrides, run_scene  # the tree that is counted, not the one of this file

    follower = Follower(package)
    with tempfile.TemporaryDirectory() as folder:
        for name in ("first", "second"):
            sys.setprofile(follower if name == "second" else None)
            try:
                run_scene(scene, overrides=Overrides(trials=trials, witness=0), out=Path(folder, name))
            finally:
                sys.setprofile(None)
    rooms, called = follower.rooms, follower.called_by_run_scene
    return Walk(
        entered=len(set(rooms)),
        moves=len(rooms) - 1,
        kinds_of_moves=len(set(pairwise(rooms))),
        returns=len(rooms) - len(set(rooms)),
        route=(*called[:1], *(there for here, there in pairwise(called) if there != here)),
    )


def structure(package: Path, scene: str, trials: int) -> Structure:
    """Count the package that this process imports."""
    files = arrows_between_files(type_checking=False)
    rooms = arrows_between_rooms(files)
    return Structure(
        loose_files=sum(path.name != "__init__.py" for path in package.glob("*.py")),
        rooms=len(rooms),
        levels=levels(rooms),
        file_levels=levels(files),
        arrows=sum(len(imported) for imported in rooms.values()),
        room_cycles=named(rooms),
        file_cycles=named(arrows_between_files(type_checking=True)),
        writers=sum(len(writers(path.read_text("utf-8"))) for path in package.rglob("*.py")),
        lengths=lengths(package),
        reading=reading(package),
        walk=walk(package, scene, trials),
    )


@contextmanager
def laid_out(tree: Path) -> Iterator[Path]:
    """A folder in which a tree's tol3d/, parts/ and scenes/ lie as they are installed, for PYTHONPATH."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(tree / "tol3d", Path(folder, "tol3d"))
        for inside in ("parts", "scenes"):
            shutil.copytree(tree / inside, Path(folder, "tol3d", inside))
        yield Path(folder).resolve()


def counted(tree: Path, scene: str, trials: int) -> Structure:
    """Count a tree in a process of its own."""
    with laid_out(tree) as folder:
        words = ["--package", str(folder / "tol3d"), "--scene", scene, "--trials", str(trials)]
        done = subprocess.run(
            [sys.executable, str(Path(__file__).resolve()), *words],
            stdout=subprocess.PIPE,
            text=True,
            check=True,
            cwd=folder,
            env=os.environ | {"PYTHONPATH": str(folder)},
        )
    found = json.loads(done.stdout.splitlines()[-1])
    return Structure(
        **found
        | {
            "lengths": Lengths(**found["lengths"]),
            "reading": Reading(**found["reading"]),
            "walk": Walk(**found["walk"]),
        }
    )


def rows(found: Structure) -> dict[str, str]:
    """Printed rows of a tree."""
    return {
        "loose files at the top of tol3d/": str(found.loose_files),
        "rooms": str(found.rooms),
        "import levels of rooms": str(found.levels),
        "import levels of files": str(found.file_levels),
        "arrows between rooms": str(found.arrows),
        "cycles between rooms": "\n".join(found.room_cycles) or "none",
        "cycles between files": "\n".join(found.file_cycles) or "none",
        "files": str(found.lengths.files),
        "largest file (lines)": found.lengths.largest_file,
        f"files over {LONGEST_FILE} lines": str(found.lengths.files_over),
        "longest function (lines)": found.lengths.longest_function,
        f"functions over {LONGEST_FUNCTION} lines": str(found.lengths.functions_over),
        "lines": str(found.reading.lines),
        "lines of a file, median": f"{found.reading.file:g}",
        f"files under {SHORT_FILE} lines": str(found.reading.short_files),
        "lines that are imports [%]": f"{found.reading.imports:.1f}",
        "lines of a function, median": f"{found.reading.function:g}",
        "private functions of modules": str(found.reading.private),
        "  named at one place": str(found.reading.once),
        "  their lines": str(found.reading.once_lines),
        f"  of {SHORT_FUNCTION} lines or fewer": str(found.reading.short),
        "reads of a variable `own`": str(found.reading.own),
        "functions that write into an argument": str(found.writers),
        "run_scene: rooms entered": str(found.walk.entered),
        "run_scene: moves between rooms": str(found.walk.moves),
        "run_scene: distinct moves": str(found.walk.kinds_of_moves),
        "run_scene: returns to a room left before": str(found.walk.returns),
        "calls of run_scene's file: rooms": str(len(set(found.walk.route))),
        "calls of run_scene's file: returns": str(found.walk.route_returns),
    }


def main(arguments: Sequence[str] | None = None) -> None:
    """Count and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tree", type=Path, nargs="+", default=[ROOT])
    parser.add_argument("--scene", default="spur_pair")
    parser.add_argument("--trials", type=int, default=256)
    parser.add_argument("--route", action="store_true")
    parser.add_argument("--package", type=Path, help=argparse.SUPPRESS)  # count what this process imports
    given = parser.parse_args(arguments)
    if given.package:
        print(json.dumps(asdict(structure(given.package, given.scene, given.trials))))
        return
    found = [(tree, counted(tree, given.scene, given.trials)) for tree in given.tree]
    table = Table(title=f"structure, and {given.scene} followed through run_scene")
    table.add_column("")
    for tree, _ in found:
        table.add_column(str(tree), justify="right")
    for name in rows(found[0][1]):
        table.add_row(name, *(rows(one)[name] for _, one in found))
    Console(width=WIDTH).print(table)
    if given.route:
        for tree, one in found:
            print(f"{tree}: run_scene calls {' > '.join(one.walk.route)}")


if __name__ == "__main__":
    main()
