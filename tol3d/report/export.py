"""The perturbed parts of one build as files: STL, PLY, GLB for eyes and printers, STEP for CAD."""

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any, Final, cast

import numpy as np
import trimesh
from trimesh.visual.material import PBRMaterial

from tol3d.cad.solids import export_step
from tol3d.errors import InputError, unwritable
from tol3d.report.body import Body, World
from tol3d.report.presenter import Display, Which, presenter_of, require_bodies
from tol3d.study.runs.atomic_write import named_in_errors
from tol3d.study.runs.run import Run

FORMATS: Final = ("stl", "ply", "glb", "step")
ROUGHNESS: Final = 0.55
METRES_PER_MM: Final = 1e-3  # glTF 2.0, 3.4: all linear distances are in metres


@dataclass(frozen=True)
class Exported:
    """Exported files.

    Args:
        files: the files.
        notes: notes for the user, such as the magnification in use.
    """

    files: tuple[Path, ...]
    notes: tuple[str, ...]


def export_run(
    run: Run,
    which: Which,
    fmt: str,
    *,
    magnify: float = 1.0,
    out: Path = Path(),
    presenter: str | None = None,
) -> Exported:
    """Write the perturbed parts of one build at their poses.

    Args:
        run: a finished run.
        which: a trial, or "worst", "nominal", "mean".
        fmt: "stl" and "ply" write a file a part [mm], "glb" one scene a world [m], "step" one assembly a world [mm]
            with the real perturbed solids, and a note of parts that have none. A world that is shown as one, such as
            a robot, is one file in any format.
        magnify: scales the deviations and simulates again.
        out: the folder; made if missing.
        presenter: import path of the system's presenter; by default that of the run's measures.

    Raises:
        InputError: an unknown format or build, no bodies, a STEP file magnified or without any solid, or a folder that
            cannot be written.
    """
    if fmt not in FORMATS:
        raise InputError(f"format: expected one of {', '.join(FORMATS)}, got {fmt!r}")
    if fmt == "step" and magnify != 1.0:
        raise InputError("a STEP file holds the real parts: leave out --magnify, or choose stl, ply or glb")
    return export_build(presenter_of(run.found, presenter).display(run, which, magnify=magnify), fmt, out)


def export_build(display: Display, fmt: str, out: Path) -> Exported:
    """Write the parts of a build that is shown; files are named by its label.

    Args:
        display: the build.
        fmt, out: see export_run.

    Raises:
        InputError: see export_run.
    """
    if fmt not in FORMATS:
        raise InputError(f"format: expected one of {', '.join(FORMATS)}, got {fmt!r}")
    require_bodies(display)
    missing = [body.name for world in display.worlds for body in world.bodies if body.posed is None]
    if fmt == "step":
        _refuse_no_solids(display, missing)
    try:
        out.mkdir(parents=True, exist_ok=True)
        files = list(_files(display, fmt, out))
    except OSError as error:
        raise unwritable(Path(error.filename or out), error, "choose another folder") from None
    notes = [f"no solid, so not in the STEP file: {', '.join(missing)}"] if fmt == "step" and missing else []
    return Exported(tuple(files), (*display.notes, *notes))


def _refuse_no_solids(display: Display, missing: Sequence[str]) -> None:
    """Refuse STEP where nothing could be in its file."""
    if all(body.posed is None for world in display.worlds for body in world.bodies):
        have = "has" if len(missing) == 1 else "have"
        raise InputError(
            f"{display.label}: a STEP file holds solids, and {', '.join(missing)} {have} none: give parts a `builder` "
            "in the scene, or choose stl, ply or glb, which show what there is"
        )


def part_meshes(display: Display) -> dict[str, trimesh.Trimesh]:
    """Every part of a build as a closed mesh in its world [mm], by its name."""
    return {body.name: triangle_mesh(body) for world in display.worlds for body in world.bodies}


def triangle_mesh(body: Body) -> trimesh.Trimesh:
    """A part as a closed mesh in the world [mm]."""
    vertices, triangles = body.mesh
    colours = np.tile(
        np.array([*bytes.fromhex(body.colour.removeprefix("#")), 255], dtype=np.uint8), (len(vertices), 1)
    )
    return trimesh.Trimesh(vertices, triangles, process=False, vertex_colors=colours)


def _files(display: Display, fmt: str, out: Path) -> Iterator[Path]:
    """Write a file a world, or a part; the paths as they are written."""
    worlds = [world for world in display.worlds if world.bodies]
    parts = file_words(body.name for world in worlds for body in world.bodies)
    names = file_words(world.name for world in worlds)
    for world in worlds:
        path = out / f"{display.label}{f'-{names[world.name]}' if len(worlds) > 1 else ''}.{fmt}"
        if fmt == "step":
            solids = [(body.posed(), body.colour) for body in world.bodies if body.posed is not None]
            if solids:
                export_step([posed for posed, _ in solids], path, [colour for _, colour in solids])
                yield path
        elif fmt == "glb":
            yield _written(path, _glb(world))
        elif world.one_file:
            yield _written(path, _joined(world.bodies).export(file_type=fmt))
        else:
            for body in world.bodies:
                alone = out / f"{display.label}-{parts[body.name]}.{fmt}"
                yield _written(alone, triangle_mesh(body).export(file_type=fmt))


def _joined(bodies: Sequence[Body]) -> trimesh.Trimesh:
    return cast(trimesh.Trimesh, trimesh.util.concatenate([triangle_mesh(body) for body in bodies]))


def _glb(world: World) -> object:
    """A glTF scene of named meshes, each with a material that is seen without a room around it, and normals."""
    scene = trimesh.Scene()
    to_metres = np.diag([METRES_PER_MM, METRES_PER_MM, METRES_PER_MM, 1.0])
    for body in (piece for own in world.bodies for piece in own.pieces):
        mesh = trimesh.Trimesh(*body.mesh, process=False)
        mesh.visual = trimesh.visual.TextureVisuals(material=_material(body))
        scene.add_geometry(mesh, node_name=body.name, geom_name=body.name, transform=to_metres)
    return scene.export(file_type="glb", include_normals=True, tree_postprocessor=_with_words)


def _material(body: Body) -> PBRMaterial:
    colour = [*bytes.fromhex(body.colour.removeprefix("#")), round(255 * body.opacity)]
    mode = "BLEND" if body.opacity < 1.0 else "OPAQUE"
    return PBRMaterial(
        name=body.name, baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=ROUGHNESS, alphaMode=mode
    )


def _with_words(tree: dict[str, Any]) -> None:
    tree["asset"]["extras"] = {"lengths": "metres, as glTF has them; tol3d's are mm"}


def file_words(names: Iterable[str]) -> dict[str, str]:
    """Users' names as parts of file names: letters, digits, dots and dashes; all differ, even if case does not count.

    >>> file_words(["pin 1", "pin_1", "Pin-2"])
    {'pin 1': 'pin_1', 'pin_1': 'pin_1_2', 'Pin-2': 'Pin-2'}
    """
    words: dict[str, str] = {}
    for name in dict.fromkeys(names):
        word = re.sub(r"[^\w.-]+", "_", name)
        taken = {other.casefold() for other in words.values()}
        indexed = (word if index == 1 else f"{word}_{index}" for index in count(1))
        words[name] = next(each for each in indexed if each.casefold() not in taken)
    return words


def _written(path: Path, content: object) -> Path:
    """Atomic write of a file: written aside and renamed."""
    beside = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        with named_in_errors(path):
            beside.write_bytes(content if isinstance(content, bytes) else str(content).encode())
            beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
    return path
