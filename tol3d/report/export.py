"""The perturbed parts of one build as files: STL, PLY, GLB for eyes and printers, STEP for CAD."""

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Final, cast

import numpy as np
import trimesh
from numpy.typing import NDArray

from tol3d.errors import InputError, unwritable
from tol3d.gearing.display import Assembly, PlacedGear, SeatedMesh, Which, assemble
from tol3d.gearing.presenting.whole_trains import WholeTrain, whole_trains
from tol3d.runs.atomic_write import named_in_errors
from tol3d.runs.run import Run
from tol3d.solids import PosedGear, PosedPart, export_step

Array = NDArray[np.float64]
Colour = tuple[int, int, int, int]

FORMATS: Final = ("stl", "ply", "glb", "step")
COLOURS: Final[tuple[Colour, Colour]] = ((70, 130, 180, 255), (230, 159, 0, 255))  # driver, driven
METRES_PER_MM: Final = 1e-3  # glTF 2.0, 3.4: all linear distances are in metres


@dataclass(frozen=True)
class Exported:
    """What was written.

    Args:
        files: the files.
        notes: what the user should know, such as the magnification in use.
    """

    files: tuple[Path, ...]
    notes: tuple[str, ...]


def export_run(
    run: Run,
    which: Which,
    fmt: str,
    *,
    magnify: float = 1.0,
    out: Path = Path("."),
) -> Exported:
    """Write the perturbed parts of one build where they ended up.

    Args:
        run: a finished run.
        which: a trial, or "worst", "nominal", "mean".
        fmt: "stl" and "ply" write a file a part [mm], "glb" one scene a mesh [m], "step" one assembly a
            mesh [mm] with the real perturbed solids. Gears that shafts connect are written as one file in
            one world, in any format.
        magnify: scales the deviations and seats again, see `assemble`.
        out: the folder; made if missing.

    Raises:
        InputError: an unknown format or build, a STEP file magnified, or a folder that cannot be written.
    """
    if fmt not in FORMATS:
        raise InputError(f"format: expected one of {', '.join(FORMATS)}, got {fmt!r}")
    if fmt == "step" and magnify != 1.0:
        raise InputError("a STEP file holds the real parts: leave out --magnify, or choose stl, ply or glb")
    assembly = assemble(run, which, magnify=magnify)
    try:
        out.mkdir(parents=True, exist_ok=True)
        files = list(_files(assembly, fmt, out))
    except OSError as error:
        raise unwritable(Path(error.filename or out), error, "choose another folder") from None
    return Exported(tuple(files), assembly.notes)


def _files(assembly: Assembly, fmt: str, out: Path) -> Iterator[Path]:
    trains = whole_trains(assembly)
    for train in trains:
        yield TRAIN_WRITERS[fmt](train, _train_path(assembly, trains, train, out, fmt))
    if not trains:
        for mesh in assembly.meshes:
            yield from WRITERS[fmt](assembly, mesh, out)


def triangle_mesh(part: PlacedGear, colour: Colour = COLOURS[0]) -> trimesh.Trimesh:
    """A placed gear as a closed mesh in the world [mm]."""
    return _coloured(*part.mesh(), colour)


def _coloured(vertices: Array, triangles: NDArray[np.int64], colour: Colour) -> trimesh.Trimesh:
    colours = np.tile(np.array(colour, dtype=np.uint8), (len(vertices), 1))
    return trimesh.Trimesh(vertices, triangles, process=False, vertex_colors=colours)


def part_meshes(assembly: Assembly) -> dict[str, trimesh.Trimesh]:
    """Every part of a build as a closed mesh [mm], by its name: gears, and of trains shafts, arms and reducers too.

    In the world of its mesh, or where shafts connect gears in that of the first shaft.
    """
    trains = whole_trains(assembly)
    if trains:
        return {name: mesh for train in trains for name, mesh in _train_meshes(train).items()}
    return {name: mesh for seated in assembly.meshes for name, mesh in _pair_meshes(seated).items()}


# single pairs -------------------------------------------------------------------------------------


def _write_parts(ending: str) -> Callable[[Assembly, SeatedMesh, Path], list[Path]]:
    def write(assembly: Assembly, seated: SeatedMesh, out: Path) -> list[Path]:
        files, words = [], _part_words(assembly)
        for part, colour in zip((seated.driver, seated.driven), COLOURS, strict=True):
            content = triangle_mesh(part, colour).export(file_type=ending)
            files.append(_written(out / f"{assembly.label}-{words[part.name]}.{ending}", content))
        return files

    return write


def _write_scene(assembly: Assembly, seated: SeatedMesh, out: Path) -> list[Path]:
    return [_written(_scene_path(assembly, seated, out, "glb"), _glb(_pair_meshes(seated)))]


def _pair_meshes(seated: SeatedMesh) -> dict[str, trimesh.Trimesh]:
    parts = zip((seated.driver, seated.driven), COLOURS, strict=True)
    return {part.name: triangle_mesh(part, colour) for part, colour in parts}


def _glb(meshes: Mapping[str, trimesh.Trimesh]) -> object:
    """A glTF scene of named meshes [mm]."""
    scene = trimesh.Scene()
    to_metres = np.diag([METRES_PER_MM, METRES_PER_MM, METRES_PER_MM, 1.0])
    for name, mesh in meshes.items():
        scene.add_geometry(mesh, node_name=name, geom_name=name, transform=to_metres)
    return scene.export(file_type="glb")  # type: ignore[no-untyped-call]  # trimesh annotates it in part only


def _write_step(assembly: Assembly, seated: SeatedMesh, out: Path) -> list[Path]:
    path = _scene_path(assembly, seated, out, "step")
    parts = [PosedGear(part.name, part.perturbed, part.world_from_gear) for part in (seated.driver, seated.driven)]
    export_step(parts, path)
    return [path]


WRITERS: Mapping[str, Callable[[Assembly, SeatedMesh, Path], list[Path]]] = {
    "stl": _write_parts("stl"),
    "ply": _write_parts("ply"),
    "glb": _write_scene,
    "step": _write_step,
}


def _scene_path(assembly: Assembly, seated: SeatedMesh, out: Path, ending: str) -> Path:
    words = file_words(mesh.mesh.name for mesh in assembly.meshes)
    mesh = f"-{words[seated.mesh.name]}" if len(words) > 1 else ""
    return out / f"{assembly.label}{mesh}.{ending}"


def _part_words(assembly: Assembly) -> dict[str, str]:
    return file_words(part.name for mesh in assembly.meshes for part in (mesh.driver, mesh.driven))


# trains -------------------------------------------------------------------------------------------


def _train_meshes(train: WholeTrain) -> dict[str, trimesh.Trimesh]:
    return {name: _coloured(*mesh, _rgba(train.colours[name])) for name, mesh in train.meshes.items()}


def _rgba(colour: str) -> Colour:
    red, green, blue = bytes.fromhex(colour.removeprefix("#"))
    return red, green, blue, 255


def _write_whole(ending: str) -> Callable[[WholeTrain, Path], Path]:
    def write(train: WholeTrain, path: Path) -> Path:
        whole = cast(trimesh.Trimesh, trimesh.util.concatenate(list(_train_meshes(train).values())))
        return _written(path, whole.export(file_type=ending))

    return write


def _write_whole_glb(train: WholeTrain, path: Path) -> Path:
    return _written(path, _glb(_train_meshes(train)))


def _write_whole_step(train: WholeTrain, path: Path) -> Path:
    gears = [PosedGear(part.name, part.perturbed, part.world_from_gear) for part in train.gears]
    parts: list[PosedPart] = [*gears, *train.bodies]
    export_step(parts, path, [train.colours[part.name] for part in parts])
    return path


TRAIN_WRITERS: Mapping[str, Callable[[WholeTrain, Path], Path]] = {
    "stl": _write_whole("stl"),
    "ply": _write_whole("ply"),
    "glb": _write_whole_glb,
    "step": _write_whole_step,
}


def _train_path(assembly: Assembly, trains: Sequence[WholeTrain], train: WholeTrain, out: Path, ending: str) -> Path:
    words = file_words(each.root for each in trains)
    root = f"-{words[train.root]}" if len(words) > 1 else ""
    return out / f"{assembly.label}{root}.{ending}"


# files --------------------------------------------------------------------------------------------


def file_words(names: Iterable[str]) -> dict[str, str]:
    """Users' names as parts of file names: letters, digits, dots and dashes; all differ, even if case does not count.

    >>> file_words(["gear 1", "gear_1", "Gear-2"])
    {'gear 1': 'gear_1', 'gear_1': 'gear_1_2', 'Gear-2': 'Gear-2'}
    """
    words: dict[str, str] = {}
    for name in dict.fromkeys(names):
        word = re.sub(r"[^\w.-]+", "_", name)
        taken = {other.casefold() for other in words.values()}
        indexed = (word if index == 1 else f"{word}_{index}" for index in count(1))
        words[name] = next(each for each in indexed if each.casefold() not in taken)
    return words


def _written(path: Path, content: object) -> Path:
    """Write a file aside and rename it, so that it is whole or not there."""
    beside = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        with named_in_errors(path):
            beside.write_bytes(content if isinstance(content, bytes) else str(content).encode())
            os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)
    return path
