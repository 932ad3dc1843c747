"""The 3D view of a report: every mesh once, and the poses that builds were really seated in, as one packed model."""

import base64
import gzip
import json
import re
import tempfile
from collections.abc import Iterator, Sequence, Set
from dataclasses import asdict, dataclass, field, replace
from io import BytesIO
from pathlib import Path
from typing import Any, Final, cast

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image

from tol3d.errors import Tol3dError
from tol3d.numerics.arrays import Array
from tol3d.report.body import Body, Surface, World
from tol3d.report.drawn_solids import poly_data
from tol3d.report.heading import shown_measures
from tol3d.report.html.blocks import Markup, tag
from tol3d.report.number import measured_text
from tol3d.report.presenter import Display, Presenter, Which
from tol3d.report.shown_unit import shown_run
from tol3d.report.view import view_run
from tol3d.study.runs.run import Run
from tol3d.study.system.outcome import value_column

FACTORS: Final = (1.0, 10.0, 100.0)
"""Magnifications of a trial's deviations; a build that does not allow one says so."""
LARGEST: Final = 2_500_000
"""Bytes of the packed model; beyond it parts that deviate are shown nominal."""
MOST: Final = 3_400_000
"""Bytes of the packed model that leave a page of 5 MB; beyond it facets are coarser."""
FEWEST_FACETS: Final = 1000
"""Triangles of a mesh that is not made coarser."""
MOST_TRIES: Final = 4
LEAST_LEFT: Final = 0.02
"""Share of a mesh's triangles that is left at least."""
ALIKE: Final = 2e-3
"""Fraction of a part's size: shapes that differ by less are drawn as one, at their best fit."""
TRIAL: Final = re.compile(r"trial-(\d+)")
STILL_WIDTH, STILL_QUALITY = 1100, 80
GRID: Final = 2.0**-13
"""mm; places of corners are rounded to it, an eighth of a micrometre, so that they pack."""


@dataclass(frozen=True, eq=False)
class _State:
    """A build as it is shown.

    Args:
        words: its measures, and notes.
        meshes, poses: of each part, which of the model's meshes, and where (16 numbers, column by column) [mm].
        names: of contacts, gaps and other places (3 numbers) [mm].
    """

    words: str
    meshes: tuple[int, ...]
    poses: tuple[list[float], ...]
    names: dict[str, list[float]]


@dataclass(eq=False)
class _Model:
    """Triangles by what they hold, each set once."""

    surfaces: list[Surface] = field(default_factory=list)
    of_parts: dict[str, list[int]] = field(default_factory=dict)

    def place(self, name: str, surface: Surface) -> tuple[int, Array]:
        """Index of a part's mesh, and its pose on the part (4, 4)."""
        vertices, triangles = surface
        for mesh in self.of_parts.setdefault(name, []):
            known, alike = self.surfaces[mesh]
            if known.shape == vertices.shape and np.array_equal(alike, triangles):
                pose = laid_on(known, vertices)
                left = vertices - (known @ pose[:3, :3].T + pose[:3, 3])
                if float(np.abs(left).max()) <= ALIKE * float(np.ptp(vertices, axis=0).max()):
                    return mesh, pose
        self.of_parts[name].append(len(self.surfaces))
        self.surfaces.append((np.round(np.asarray(vertices, dtype=np.float64) / GRID) * GRID, triangles))
        return len(self.surfaces) - 1, np.eye(4)

    def packed(self) -> bytes:
        """The model as a GLB, packed the same way every time."""
        scene = trimesh.Scene()
        for number, (vertices, triangles) in enumerate(self.surfaces):
            mesh = trimesh.Trimesh(vertices, triangles, process=False)
            scene.add_geometry(mesh, node_name=f"mesh-{number}", geom_name=f"mesh-{number}")
        return gzip.compress(cast(bytes, scene.export(file_type="glb")), 9, mtime=0)


def laid_on(points: Array, others: Array) -> Array:
    """The pose (4, 4) that lays points (n, 3) best on others, by least squares (Kabsch 1976)."""
    middle, there = points.mean(axis=0), others.mean(axis=0)
    left, _, right = np.linalg.svd((points - middle).T @ (others - there))
    turn = (left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right).T
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, there - turn @ middle
    return pose


def view_3d(run: Run, presenter: Presenter, trials: Sequence[int] = ()) -> Markup:
    """Nominal, worst and chosen builds in 3D; a sentence where there is nothing to show.

    Args:
        run: a finished run.
        presenter: of its system.
        trials: which are shown besides.
    """
    wanted: list[Which] = ["nominal", *(["worst"] if run.keeps_trials else []), *trials]
    model, world = _Model(), None
    builds = list[tuple[str, list[_State]]]()
    for which in wanted:
        try:
            states, world = _states(run, presenter, which, model, world)
        except Tol3dError as error:
            if not builds:
                return tag("p", f"no 3D view: {error}", class_="note")
            continue
        builds.append((_called(which), states))
    assert world is not None, "the nominal build has one"
    packed, nominal = model.packed(), tuple[str, ...]()
    if len(packed) > LARGEST:
        builds, model, nominal = _undeviated(builds, model, world)
        packed = model.packed()
    model, packed, coarser = _within(model, packed)
    notes = _notes(builds, world, nominal, coarser)
    return _figure(world, builds, packed, _still(run), notes)


def _states(
    run: Run, presenter: Presenter, which: Which, model: _Model, shown: World | None
) -> tuple[list[_State], World]:
    """A build at every magnification, of its world that shows the most."""
    found = list[_State]()
    for factor in (1.0,) if which == "nominal" else FACTORS:
        display = presenter.display(run, which, magnify=factor)
        world = _world_of(display, shown)
        if world is not None:
            world = replace(world, bodies=tuple(piece for body in world.bodies for piece in body.pieces))
        shown = shown or world
        if shown is None or world is None:
            continue
        placed = [model.place(body.name, _surface(body)) for body in world.bodies]
        poses = tuple(_pose(body, on) for body, (_, on) in zip(world.bodies, placed, strict=True))
        measured = _measured(run, which, display.label) if factor == FACTORS[0] else display.label
        words = "; ".join((measured, *display.notes))
        names = {
            name: [float(f"{own:.9g}") for own in place] for name, place in {**world.points, **world.marks}.items()
        }
        found.append(_State(words, tuple(mesh for mesh, _ in placed), poses, names))
    if shown is None or not found:
        raise Tol3dError(f"{which}: there is nothing to show in 3D")
    return found, shown


def _measured(run: Run, which: Which, label: str) -> str:
    """A build with the values of the measures that are shown, of the best method there is."""
    shown = shown_run(run.found).measures
    trial = TRIAL.fullmatch(label)
    values = dict[str, float | None]()
    for name in shown_measures(shown):
        measure = shown[name]
        if measure.take == "curve":
            continue
        if which == "nominal":
            values[name] = measure.nominal.value(measure.best_method)
        elif trial:
            column = value_column(measure.best_method, name)
            per = 1.0 if run.found.measures[name].unit == measure.unit else 1e-3
            values[name] = per * float(run.columns(column)[column][int(trial[1])])
    told = [f"{name} {measured_text(own, shown[name].unit)}" for name, own in values.items() if own is not None]
    return f"{label}: {', '.join(told)}" if told else label


def _world_of(display: Display, shown: World | None) -> World | None:
    """The world with the most bodies, or the one of that name."""
    worlds = [world for world in display.worlds if world.bodies and (shown is None or world.name == shown.name)]
    return max(worlds, key=lambda own: len(own.bodies), default=None)


def _surface(body: Body) -> Surface:
    surface = body.surface()
    if body.details is None:
        return surface
    (vertices, triangles), (more, further) = surface, body.details()
    return np.vstack([vertices, more]), np.vstack([triangles, further + len(vertices)])


def _pose(body: Body, on_part: Array) -> list[float]:
    """Matrix of a part's mesh that lies so on it, with the growth in it; column by column."""
    grown = np.array(body.world_from_part, dtype=np.float64)
    grown[:3, :3] *= body.scale
    pose = grown @ on_part
    return [float(f"{value:.12g}") for value in pose.T.ravel()]


def _called(which: Which) -> str:
    return which if isinstance(which, str) else f"trial {which}"


def _undeviated(
    builds: Sequence[tuple[str, list[_State]]], model: _Model, world: World
) -> tuple[list[tuple[str, list[_State]]], _Model, tuple[str, ...]]:
    """The same with every part nominal, and the parts that differ from their build."""
    nominal = builds[0][1][0].meshes
    deviate = {
        k for _, states in builds for state in states for k, mesh in enumerate(state.meshes) if mesh != nominal[k]
    }
    fewer = _Model([model.surfaces[mesh] for mesh in nominal])
    places = tuple(range(len(nominal)))
    kept = [(name, [replace(state, meshes=places) for state in states]) for name, states in builds]
    return kept, fewer, tuple(world.bodies[k].name for k in sorted(deviate))


def _within(model: _Model, packed: bytes) -> tuple[_Model, bytes, frozenset[int]]:
    """The model with as few triangles as make it small enough, packed; and which of its meshes are coarser."""
    coarser = frozenset[int]()
    for _ in range(MOST_TRIES):
        large = [k for k, (_, own) in enumerate(model.surfaces) if len(own) > FEWEST_FACETS]
        if len(packed) <= MOST or not large:
            break
        left = max(0.8 * MOST / len(packed), LEAST_LEFT)
        coarser |= set(large)
        surfaces = [fewer_facets(*own, left) if k in coarser else own for k, own in enumerate(model.surfaces)]
        model = _Model(surfaces)
        packed = model.packed()
    return model, packed, coarser


def fewer_facets(vertices: Array, triangles: NDArray[np.int64], left: float) -> Surface:
    """A surface with a share of its triangles, where it bends least fewer (quadric error: Garland, Heckbert 1997)."""
    merged = poly_data(vertices, triangles).clean()
    found = merged.decimate(1.0 - left, volume_preservation=True)
    return np.asarray(found.points, dtype=np.float64), found.regular_faces


def _notes(
    builds: Sequence[tuple[str, list[_State]]], world: World, nominal: Sequence[str], coarser: Set[int]
) -> list[str]:
    """Notes on differences between the picture and the build."""
    rough = {k for _, states in builds for state in states for k, mesh in enumerate(state.meshes) if mesh in coarser}
    named = ", ".join(world.bodies[k].name for k in sorted(rough))
    notes = [f"shown nominal: {', '.join(nominal)}"] if nominal else []
    return [*notes, *([f"coarser facets, for the size of this page: {named}"] if named else [])]


def _still(run: Run) -> str:
    """The picture that stands there where nothing can be turned: as `tol3d view` shows it."""
    which: Which = "worst" if run.keeps_trials else "nominal"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "still.png"
        try:
            view_run(run, which, screenshot=path)
        except Tol3dError:
            return ""
        picture = BytesIO()
        with Image.open(path) as drawn:
            drawn.thumbnail((STILL_WIDTH, STILL_WIDTH))
            drawn.convert("RGB").save(picture, "JPEG", quality=STILL_QUALITY)
        return base64.b64encode(picture.getvalue()).decode()


def _figure(
    world: World,
    builds: Sequence[tuple[str, list[_State]]],
    packed: bytes,
    still: str,
    notes: Sequence[str],
) -> Markup:
    told: dict[str, Any] = {
        "up": list(world.up),
        "parts": [{"colour": body.colour, "opacity": body.opacity} for body in world.bodies],
        "builds": [{"states": [asdict(state) for state in states]} for _, states in builds],
    }
    data = json.dumps(told, sort_keys=True, separators=(",", ":")).replace("<", "\\u003c")
    picture = tag("img", src=f"data:image/jpeg;base64,{still}", alt="the parts, as tol3d view shows them")
    return tag(
        "figure",
        tag("div", tag("canvas"), picture if still else None, class_="stage"),
        *_controls(world, builds),
        tag("p", class_="state note"),
        *(tag("p", note, class_="note") for note in notes),
        tag("script", Markup(data), type="application/json", id="view-data"),
        tag("script", Markup(base64.b64encode(packed).decode()), type="text/plain", id="view-model"),
        class_="view",
    )


def _controls(world: World, builds: Sequence[tuple[str, list[_State]]]) -> Iterator[Markup]:
    options = (tag("option", name, value=number) for number, (name, _) in enumerate(builds))
    slider = tag("input", type="range", name_="factor", min=0, max=len(FACTORS) - 1, value=0, step=1)
    number = tag("output", f"{FACTORS[0]:g}", data_factors=" ".join(f"{own:g}" for own in FACTORS))
    yield tag(
        "div",
        tag("label", "build ", tag("select", *options, name_="build")),
        tag("label", "deviations × ", number, " ", slider),
        tag("label", tag("input", type="checkbox", name_="names", checked=""), " names"),
        tag("button", "fit", type="button", name_="fit"),
        tag("span", "drag turns, wheel zooms, double click fits", class_="dim"),
        class_="controls",
    )
    boxes = (
        tag("label", tag("input", type="checkbox", name_="part", value=k, checked=""), f" {own.name}")
        for k, own in enumerate(world.bodies)
    )
    yield tag("details", tag("summary", "parts"), tag("div", *boxes, class_="controls"), open="")
