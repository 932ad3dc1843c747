"""Applications import public names alone: those that docs/api.md documents, as applications of others would."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from places import ROOT

API = (ROOT / "docs" / "api.md").read_text("utf-8")
MODULES = frozenset(re.findall(r"^\.\. automodule:: (tol3d[\w.]*)$", API, re.MULTILINE))
NAMES = frozenset(re.findall(r"^\.\. (?:auto(?:class|function|data)|py:data):: (tol3d[\w.]*)$", API, re.MULTILINE))
ONLY = dict(re.findall(r"^\.\. automodule:: (tol3d[\w.]*)\n   :members: (\w.*)$", API, re.MULTILINE))
"""Modules of which some members are documented."""

APPLICATIONS = sorted(own.parent for own in (ROOT / "tol3d" / "apps").glob("*/__init__.py"))
PAGES = [page for page in sorted((ROOT / "docs").glob("*.md")) if "```python\n" in page.read_text("utf-8")]
MODULE_NAMED = re.compile(r"(tol3d(?:\.\w+)+):(\w+)")


def tree_of(module: str) -> ast.Module:
    place = ROOT / module.replace(".", "/")
    file = place.with_suffix(".py")
    return ast.parse((file if file.is_file() else place / "__init__.py").read_text("utf-8"))


@cache
def public_of(module: str) -> frozenset[str]:
    """Names that a documented module documents: some members, `__all__`, or without it what it defines."""
    return frozenset(re.findall(r"\w+", ONLY[module])) if module in ONLY else defined_by(module)


def defined_by(module: str) -> frozenset[str]:
    """`__all__` of a module, or without it what it defines."""
    defined = set[str]()
    for node in tree_of(module).body:
        match node:
            case ast.Assign(targets=[ast.Name("__all__")], value=value):
                return frozenset(ast.literal_eval(value))
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name) | ast.AnnAssign(target=ast.Name(name)):
                defined.add(name)
            case ast.Assign(targets=[ast.Name(name)]):
                defined.add(name)
    return frozenset(name for name in defined if not name.startswith("_"))


def is_public(module: str, name: str) -> bool:
    return f"{module}.{name}" in NAMES or (module in MODULES and name in public_of(module))


def private_imports(source: str, own: str) -> Iterator[str]:
    """Names of tol3d that a file takes by imports or import paths, and that are neither public nor of its package."""
    for node in ast.walk(ast.parse(source)):
        taken = list[tuple[str, str]]()
        match node:
            case ast.ImportFrom(module=str(module), names=names):
                taken = [(module, alias.name) for alias in names]
            case ast.Import(names=names):
                taken = [(alias.name, "") for alias in names]
            case ast.Constant(value=str(text)) if found := MODULE_NAMED.fullmatch(text):
                taken = [(found[1], found[2])]
        for module, name in taken:
            if (
                module.partition(".")[0] == "tol3d"
                and f"{module}.".partition(f"{own}.")[0]
                and not is_public(module, name)
            ):
                yield f"{module}.{name}"


def test_a_private_import_is_found_however_it_is_made() -> None:
    source = """
import numpy, tol3d.gearing.engines
from tol3d.apps.here.page import anything
from tol3d.apps.hereafter import something
from tol3d.errors import InputError
from tol3d.gears import SpurGear, _HOMES
def late():
    from tol3d.gearing.engines import OK
    return named("tol3d.study.runs.writer:RunWriter")("tol3d.simulate:load")
"""
    assert sorted(private_imports(source, "tol3d.apps.here")) == [
        "tol3d.apps.hereafter.something",
        "tol3d.gearing.engines.",
        "tol3d.gearing.engines.OK",
        "tol3d.gears._HOMES",
        "tol3d.study.runs.writer.RunWriter",
    ]


@pytest.mark.parametrize("application", APPLICATIONS, ids=lambda path: path.name)
def test_an_application_imports_public_names_alone(application: Path) -> None:
    own = f"tol3d.apps.{application.name}"
    files = sorted(application.rglob("*.py"))
    assert len(files) > 5
    private = {name for file in files for name in private_imports(file.read_text("utf-8"), own)}
    assert sorted(private) == []


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_a_page_imports_public_names_alone(page: Path) -> None:
    fences = re.findall(r"^```python\n(.*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    assert fences
    private = {name for fence in fences for name in private_imports(fence, "tol3d.apps.none")}
    assert sorted(name for name in private if name.rpartition(".")[0] != "tol3d") == []  # those are tested as they run


def test_documented_names_are_there() -> None:
    """The site's builder leaves out what it does not find; names of `__all__` ruff finds."""
    single = [name.rpartition(".")[::2] for name in NAMES]
    some = [(module, own) for module in ONLY for own in public_of(module)]
    assert len(single) + len(some) > 40
    assert [f"{module}.{own}" for module, own in single + some if own not in defined_by(module)] == []
