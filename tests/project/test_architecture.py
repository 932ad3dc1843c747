"""The house: layers, doors of the heavy libraries, nothing imported inside functions, packages all shipped."""

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest
from places import ROOT

PACKAGE_FOLDERS = {"tol3d": ROOT / "tol3d", "tol3d.parts": ROOT / "parts", "tol3d.scenes": ROOT / "scenes"}

APPLICATIONS = ("adjustment", "design", "drafting", "records", "workbench")
COMMANDS = tuple(f"tol3d/apps/{own}/commands.py" for own in APPLICATIONS)

DOORS = {
    "fcl": ("tol3d/cad/solids/distance.py",),
    "cadquery": ("tol3d/cad/solids/", "parts/", "tol3d/cad/step/step_cad.py"),
    "OCP": ("tol3d/cad/solids/", "parts/", "tol3d/cad/step/worker.py"),
    "trimesh": ("tol3d/cad/solids/", "parts/", "tol3d/report/", "tol3d/notebook.py"),
    "pyvista": ("tol3d/report/", "tol3d/gearing/presenting/"),
    "vtk": ("tol3d/report/",),
    "vtkmodules": ("tol3d/report/",),
    "matplotlib": (
        "tol3d/report/",
        "tol3d/gearing/presenting/",
        "tol3d/apps/adjustment/compensation_picture.py",
        "tol3d/analyses/",
        "tol3d/apps/records/identified_picture.py",
    ),
    "PIL": ("tol3d/report/animation.py", "tol3d/report/html/view_3d.py"),
    "ruamel": ("tol3d/scene/",),
    "yaml": ("tol3d/scene/text.py", "tol3d/scene/splice.py"),
    "joblib": ("tol3d/study/execution/pools.py",),
    "starlette": ("tol3d/apps/workbench/",),
    "uvicorn": ("tol3d/apps/workbench/commands.py",),
    "dask": ("tol3d/study/execution/pools.py",),
    "distributed": ("tol3d/study/execution/pools.py",),
    "pyarrow": ("tol3d/study/runs/parquet.py", "tol3d/apps/records/csv_file.py"),
    "rich": ("tol3d/cli/", "tol3d/report/sheet.py", "tol3d/report/page.py"),
    "typer": ("tol3d/cli/", *COMMANDS),
    "pandas": ("tol3d/study/runs/run.py", "tol3d/study/runs/frame.py"),
}
"""Which files may import each heavy library."""

MAY_IMPORT_INSIDE_FUNCTIONS = ("tol3d/cli/", *COMMANDS)


def python_files() -> list[Path]:
    return sorted(path for folder in PACKAGE_FOLDERS.values() for path in folder.rglob("*.py"))


@cache
def text_of(path: Path) -> str:
    """Read once for all libraries."""
    return path.read_text("utf-8")


@cache
def parsed(path: Path) -> ast.Module:
    """Parsed once for all libraries: every file takes seconds."""
    return ast.parse(text_of(path))


@cache
def imported_by(path: Path) -> frozenset[str]:
    """The top names of what a file imports, anywhere in it."""
    return frozenset(name.split(".")[0] for name in imported_names(parsed(path)))


def imported_names(tree: ast.AST) -> list[str]:
    names = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    return names + [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module]


def test_layers_are_kept() -> None:
    done = subprocess.run(
        [Path(sys.executable).with_name("lint-imports"), "--no-cache"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


MODULE_NAMED = re.compile(r"(tol3d(?:\.\w+)+)(?::(\w+))?")

REGISTRY = "tol3d.kinds"
"""The one module above that those below load by its name: mechanisms are registered there."""

NO_MODULES = ("tol3d.plainly", "tol3d.mechanisms", "tol3d.scenes")
"""A style of the terminal, the group of entry points, the folder of scenes."""


def named_modules(path: Path) -> list[tuple[str, str]]:
    """Modules, and what is asked of them, that strings of a file name; docstrings and the public names excepted."""
    strings = (node.value for node in ast.walk(parsed(path)) if isinstance(node, ast.Constant))
    found = (MODULE_NAMED.fullmatch(own) for own in strings if isinstance(own, str) and own.startswith("tol3d."))
    return [(own[1], own[2] or "") for own in found if own is not None and own[1] not in NO_MODULES]


def rooms() -> dict[str, int]:
    """Floors of the rooms, 0 at the top."""
    with (ROOT / "pyproject.toml").open("rb") as stream:
        contracts = tomllib.load(stream)["tool"]["importlinter"]["contracts"]
    layers = next(own["layers"] for own in contracts if own["name"].startswith("The rooms"))
    return {room.strip(" ()"): floor for floor, layer in enumerate(layers) for room in layer.split("|")}


FOLDERS_OF_ROOMS = ("tol3d.study.__init__",)
"""Modules above several rooms, which offer public names of theirs."""


def room_of(module: str, floors: Mapping[str, int]) -> str:
    """The room in which a module lies, of several the innermost; "" for a folder of rooms."""
    return max((room for room in floors if f"{module}.".startswith(f"{room}.")), key=len, default="")


def is_there(module: Path, name: str) -> bool:
    """True if there is a module, and in it what has that name: a definition, an import, or a folder beside it."""
    file = next((own for own in (module.with_suffix(".py"), module / "__init__.py") if own.exists()), None)
    defined = rf"^(?:(?:def |class )?{name}\b|.*import .*\b{name}\b|    {name},$)"
    return file is not None and (
        (module / name).is_dir() or re.search(defined, text_of(file), re.MULTILINE) is not None
    )


def test_modules_that_strings_name_are_there_and_not_above() -> None:
    floors, wrong, seen = rooms(), list[str](), 0
    for path in sorted(PACKAGE_FOLDERS["tol3d"].rglob("*.py")):
        own = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        if own == "tol3d.__init__":
            continue
        for module, name in named_modules(path):
            seen += 1
            if not is_there(ROOT / module.replace(".", "/"), name):
                wrong.append(f"{own}: there is no {module}:{name}")
            here, there = (room_of(each, floors) for each in (own, module))
            if (here, there) == ("tol3d.cli", "tol3d.apps"):  # commands, as those of other packages
                continue
            if module == REGISTRY:
                continue
            if "" in (here, there):
                assert own in FOLDERS_OF_ROOMS, own
            elif here != there and floors[here] >= floors[there]:
                wrong.append(f"{own} names {module}, which stands above it")
    assert seen > 100
    assert wrong == []


IMPORTS = re.compile(r"^ *(?:from (tol3d[\w.]*) )?import (\([^)]*\)|.*)$", re.MULTILINE)


def imports_of_package() -> dict[str, set[str]]:
    """By module, those that it imports, for types too; by text, for parsing takes seconds."""
    folder = PACKAGE_FOLDERS["tol3d"]
    paths = {path: path.relative_to(ROOT).with_suffix("").parts for path in folder.rglob("*.py")}
    texts = {".".join(parts).removesuffix(".__init__"): text_of(path) for path, parts in paths.items()}
    found = dict[str, set[str]]()
    for module, text in texts.items():
        names = {
            f"{home}.{name}" if f"{home}.{name}" in texts else home
            for home, listed in IMPORTS.findall(text)
            for name in re.findall(r"\w+", listed)
        }
        found[module] = names & texts.keys() - {module}
    return found


def test_no_modules_import_each_other_in_a_circle() -> None:
    """Imports for types counted."""
    imports = imports_of_package()
    assert sum(map(len, imports.values())) > 3000
    left, rest = set[str](), set(imports)
    while left != rest:  # without modules that import none of the rest, or that none of the rest imports
        left, imported = rest, set().union(*(imports[name] for name in rest))
        rest = {name for name in left if imports[name] & left and name in imported}

    def reaches_itself(name: str) -> bool:
        reached, new = set[str](), {name}
        while new:
            new = set().union(*(imports[each] & left for each in new)) - reached
            reached |= new
        return name in reached

    assert [name for name in sorted(left) if reaches_itself(name)] == []


def test_moves_and_words_of_assemblies_see_no_method() -> None:
    """Not even for types: both methods are named by import paths."""
    above = tuple(f"tol3d.assembly.{room}" for room in ("placing", "torsors", "from_scene", "presenting", "system"))
    below = ("tol3d.assembly.model", "tol3d.assembly.grammar")
    imports = {name: own for name, own in imports_of_package().items() if name.startswith(below)}
    assert len(imports) > 40
    assert [(name, own) for name, owns in imports.items() for own in owns if own.startswith(above)] == []


@pytest.mark.parametrize("library", DOORS)
def test_a_heavy_library_has_one_door(library: str) -> None:
    strangers = [
        str(path.relative_to(ROOT))
        for path in python_files()
        if not str(path.relative_to(ROOT)).startswith(DOORS[library] or ("nowhere",))
        if library in text_of(path) and library in imported_by(path)
    ]
    assert strangers == []


def test_imports_stand_at_the_top() -> None:
    hidden = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in python_files()
        if not str(path.relative_to(ROOT)).startswith(MAY_IMPORT_INSIDE_FUNCTIONS)
        if re.search(r"^[ \t].*\bimport\b", text_of(path), re.MULTILINE)  # parsing all of them takes seconds
        for function in ast.walk(parsed(path))
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef)
        for node in ast.walk(function)
        if isinstance(node, ast.Import | ast.ImportFrom)
    ]
    assert hidden == []


def test_every_package_is_shipped() -> None:
    declared = set(tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["setuptools"]["packages"])
    found = {
        ".".join((name, *init.parent.relative_to(folder).parts))
        for name, folder in PACKAGE_FOLDERS.items()
        for init in folder.rglob("__init__.py")
    }
    assert declared == found


def test_no_lint() -> None:
    done = subprocess.run([sys.executable, "-m", "ruff", "check", "."], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_docstrings_open_with_a_noun_phrase_or_a_verb() -> None:
    """Those of attributes too: less than one in a hundred may open like a question."""
    package = [path for path in python_files() if path.is_relative_to(PACKAGE_FOLDERS["tol3d"])]
    openings = [word for path in package for word in re.findall(r'^ *r?"""(\w+)', text_of(path), re.MULTILINE)]
    assert len(openings) > 9000
    assert sum(word in {"What", "How", "Whether", "Where", "Of"} for word in openings) < 0.01 * len(openings)


def test_every_public_method_says_what_it_does_or_overrides_one_that_does() -> None:
    """By the names of classes and of their bases."""
    classes: dict[str, list[ast.ClassDef]] = {}
    for path in python_files():
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.ClassDef):
                classes.setdefault(node.name, []).append(node)

    def says(own: ast.ClassDef, name: str, seen: frozenset[str] = frozenset()) -> bool:
        found = [each for each in own.body if isinstance(each, ast.FunctionDef) and each.name == name]
        if any(ast.get_docstring(each) for each in found):
            return True
        bases = {base for each in own.bases for base in re.findall(r"\w+", ast.unparse(each))} - seen - {own.name}
        return any(says(base, name, seen | bases | {own.name}) for word in bases for base in classes.get(word, ()))

    silent = [
        f"{own.name}.{method.name}"
        for every in classes.values()
        for own in every
        for method in own.body
        if isinstance(method, ast.FunctionDef) and not method.name.startswith("_") and not own.name.startswith("_")
        if not says(own, method.name)
    ]
    assert silent == []
