"""The seam holds: rooms that serve any mechanism import none and name none, and a mechanism is a line and new files."""

import ast
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

import pytest
from places import ROOT, TESTS

PACKAGE: Final = ROOT / "tol3d"
GENERIC: Final = ("study", "scene", "report")
STANDARDS: Final = "statistics/standards/"  # named by what each is of
MECHANISMS: Final = ("gearing", "gears", "assembly", "toys")

WORDS: Final = (
    "gear|gears|gearing|mesh|meshes|meshed|meshing|tooth|teeth|train|trains|"
    "backlash|backlashes|bevel|spur|pinion|pinions|flank|flanks|jam|jams|jammed|interferes"
)
CAPITAL: Final = "|".join(word.capitalize() for word in WORDS.split("|"))
OF_GEARS: Final = re.compile(rf"(?<![A-Za-z])(?:(?i:{WORDS}))(?![a-z])|(?<=[a-z])(?:{CAPITAL})(?![a-z])")
"""As words, and as parts of names: gear_model, MeshSpec, PosedGear."""
TRIANGLES: Final = "a mesh of triangles, of whatever surface: the word of trimesh and VTK"
EXCUSED: Final[Mapping[str, tuple[str, str]]] = {
    "report/body.py": ("mesh", TRIANGLES),
    "report/export.py": ("mesh|meshes", TRIANGLES),
    "report/drawn_solids.py": ("mesh", TRIANGLES),
    "report/whole.py": ("mesh", TRIANGLES),
    "report/__init__.py": ("mesh|meshes", TRIANGLES),
    "report/html/view_3d.py": ("mesh|meshes", TRIANGLES),
    "report/html/view_model.py": ("mesh|meshes", TRIANGLES),
    "report/step_picture.py": ("mesh", TRIANGLES),
}
"""Words that a file may have, and why."""


def files(room: str) -> Iterator[Path]:
    """Modules of a room."""
    yield from sorted(path for path in (PACKAGE / room).rglob("*.py") if STANDARDS not in path.as_posix())


def words_of_gears(text: str, excused: str = "") -> Iterator[tuple[int, str]]:
    """Line and word: of code, comments and docstrings."""
    for number, line in enumerate(text.splitlines(), 1):
        for found in OF_GEARS.finditer(line):
            if not (excused and re.fullmatch(excused, found[0])):
                yield number, found[0]


def test_the_words_are_found_wherever_they_stand() -> None:
    text = (
        "gear_model = 1\nMeshSpec, PosedGear\n# of a train\n'''Backlash'''\ntrimesh, strain, trained, spurious, message"
    )
    assert [word for _, word in words_of_gears(text)] == ["gear", "Mesh", "Gear", "train", "Backlash"]
    assert [*words_of_gears("a mesh of gears", "mesh")] == [(1, "gears")]


@pytest.mark.parametrize("room", GENERIC)
def test_what_serves_any_mechanism_names_no_gear(room: str) -> None:
    found = [
        f"{name}:{line}: {word}"
        for path in files(room)
        for name in [path.relative_to(PACKAGE).as_posix()]
        for line, word in words_of_gears(path.read_text("utf-8"), EXCUSED.get(name, ("", ""))[0])
    ]
    assert not found, "\n".join(found)


def test_every_excuse_is_needed() -> None:
    for name, (words, why) in EXCUSED.items():
        found = {word for _, word in words_of_gears((PACKAGE / name).read_text("utf-8"))}
        assert found, f"{name}: {words}: {why}"


def imported(path: Path) -> Iterator[str]:
    """Modules that a file imports anywhere, and names of modules in its strings."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.startswith("tol3d."):
            yield node.value


@pytest.mark.parametrize("room", GENERIC)
def test_what_serves_any_mechanism_imports_none_by_name_or_by_text(room: str) -> None:
    for path in files(room):
        for module in imported(path):
            assert not any(module.startswith((f"tol3d.{own}", own)) for own in MECHANISMS), f"{path}: {module}"


def test_the_registration_names_a_mechanism_in_one_line() -> None:
    lines = (PACKAGE / "kinds.py").read_text("utf-8").splitlines()
    assert [line for line in lines if re.search(r"\.(gearing|forms|assembly|toys)\.\w+:", line)] == [
        '    "tol3d.gearing.mechanism:GEARING",',
        '    "tol3d.assembly.mechanism:ASSEMBLY",',
    ]


def test_toys_are_new_files_and_one_registration() -> None:
    """Nothing of the package, its scenes or its parts knows them."""
    known = re.compile(r"\btoys\b|\bparabola_system\b|\bpins_system\b")
    for folder in (PACKAGE, ROOT / "parts", ROOT / "scenes"):
        for path in folder.rglob("*.*"):
            if path.suffix in (".py", ".yaml"):
                assert not known.search(path.read_text("utf-8")), path
    whole = [path for path in (TESTS / "toys").rglob("*.py") if path.parent.name != "drives"]  # these extend gears
    assert len(whole) >= 10
    assert not [path for path in whole for module in imported(path) if module.startswith("tol3d.gear")]
