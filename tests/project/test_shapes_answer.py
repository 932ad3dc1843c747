"""Shapes, moves and features tell what is asked of them; each count of code that asks for their class only falls."""

import ast
import re
from functools import cache

import pytest
from places import ROOT

LEFT = {"Facts": (6, 0), "Move": (10, 1), "FeatureSpec": (7, 8)}
"""By the root of each family: members of it at least, and how often code may ask for their class."""

CLASS = re.compile(r"^class (\w+)\(([\w, \[\].]*)", re.MULTILINE)
ASKS = r"\b(?:isinstance\(|case )[^:]{0,200}?\b"
IMPORT = re.compile(r"^from (tol3d\.[\w.]+) import (\([^)]*\)|.*)$", re.MULTILINE)


@cache
def texts() -> dict[str, str]:
    """By path, read once."""
    return {str(path.relative_to(ROOT)): path.read_text("utf-8") for path in (ROOT / "tol3d").rglob("*.py")}


def family(root: str) -> frozenset[str]:
    """Names of a class and of all that derive from it, of assemblies, machines and linkages."""
    rooms = ("tol3d/assembly/", "tol3d/gearing/machine/", "tol3d/assembly/linkage/")
    classes = [own for path, text in texts().items() if path.startswith(rooms) for own in CLASS.findall(text)]
    found = {root}
    while more := {name for name, bases in classes if found & set(re.findall(r"\w+", bases))} - found:
        found |= more
    return frozenset(found)


def asked(text: str, names: frozenset[str]) -> int:
    """Calls of isinstance and cases of a match that ask for one of these classes, where a module imports or has it."""
    if not re.search(rf"{ASKS}(?:{'|'.join(names)})\b", text):  # the rest, of all files, takes seconds
        return 0
    imports = (own for module, own in IMPORT.findall(text) if not module.startswith("tol3d.report"))
    known = names & {*re.findall(r"\w+", " ".join(imports)), *(name for name, _ in CLASS.findall(text))}
    count = 0
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "isinstance":
            count += any(isinstance(own, ast.Name) and own.id in known for own in ast.walk(node.args[1]))
        elif isinstance(node, ast.MatchClass):
            count += isinstance(node.cls, ast.Name) and node.cls.id in known
    return count


@pytest.mark.parametrize("root", LEFT)
def test_code_that_asks_for_the_class_only_falls(root: str) -> None:
    """A fact that several places need is an attribute or a method of each class; where it falls, so does its limit."""
    members, left = LEFT[root]
    names = family(root)
    assert len(names) > members
    counts = {path: count for path, text in texts().items() if (count := asked(text, names))}
    assert sum(counts.values()) <= left, counts


def test_questions_for_classes_are_counted() -> None:
    text = """
from tol3d.assembly.model import Axis, Plane
from tol3d.report.chart import Point
isinstance(shape, Axis), isinstance(shape, Plane | Axis), isinstance(mark, Point), isinstance(shape, str)
match shape:
    case Plane() | Axis(): pass
"""
    assert asked(text, frozenset({"Axis", "Plane", "Point"})) == 4
