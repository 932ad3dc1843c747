"""Tables of a scene of an assembly: features with their datum frames, moves."""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Axis, Cone, Feature, Plane, Point, RoundPlane, Slot
from tol3d.assembly.model.dimension import longer
from tol3d.assembly.placing.asked import touched
from tol3d.assembly.placing.holding import Freedoms, HeldFreedoms, held_by, held_by_datums, in_words
from tol3d.assembly.placing.placer import RockingPlacer
from tol3d.assembly.placing.plan import planned
from tol3d.assembly.presenting.parts_tree import parts_tree
from tol3d.assembly.system import AssemblySystem
from tol3d.errors import InputError
from tol3d.import_path import named as at_path
from tol3d.report.number import NOTHING
from tol3d.report.page import Heading, PageItem, Row, Table, note, titled
from tol3d.report.presenter import Map
from tol3d.report.system_check import MIDDLE, system_blocks
from tol3d.solids import BuiltShape
from tol3d.solids.display_mesh import bounding_box
from tol3d.solids.kept_shape import KeptShape
from tol3d.step.step_shape import StepShape
from tol3d.study.simulation import Simulation

SIGNS: Final = "z: a shift along z; turns z: a turn about z; each holds of what those above it leave"


def datum_blocks(assembly: Assembly) -> Sequence[PageItem]:
    """Which freedoms datums take."""
    rows: list[Row] = []
    for frame in assembly.datum_frames.values():
        found = held_by_datums(assembly, frame)
        datums = [f"{own.words}: {in_words(own)}" for own in found.taken]
        rows.append(Row(f"{frame.part}: {', '.join(frame.name.split('|')[1:])}", ("; ".join(datums), _left(found))))
    words = [Heading(word, words=True) for word in ("each takes", "stay as in the part")]
    return titled("datum frames, along the axes of their part", Table("", words, rows)) if rows else ()


def freedom_blocks(assembly: Assembly) -> Sequence[PageItem]:
    """Freedoms held by moves, and those left."""
    rows: list[Row] = []
    for move, plan in zip(assembly.moves, planned(assembly).moves, strict=True):
        found = held_by(assembly, plan) if len(move.parts) == 1 else None
        if found is None or not found.taken:
            rows += [Row(move.name, own) for own in move.holds]
            continue
        rows += [Row(move.name, (in_words(own), _by(own))) for own in found.taken]
        if found.left.count:
            rows.append(Row(move.name, (_left(found), "left as drawn")))
    words = [Heading(word, words=True) for word in ("freedoms", "held by")]
    table = Table("", words, rows)
    return (*titled("freedoms that moves hold, along the axes of the world", table), note(SIGNS))


def _by(taken: HeldFreedoms) -> str:
    return f"{taken.words}, within clearance" if taken.is_room else taken.words


def _left(freedoms: Freedoms) -> str:
    """Remaining freedoms; for a single turn also its axis."""
    return f"{in_words(freedoms.left)}{f' {freedoms.where}' if freedoms.where else ''}"


PLACE: Final = "at [mm]"
MANY_ALIKE: Final = 3
"""Largest number of zones of one law that share a row."""


def check_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Features, moves, and what any system shows."""
    system = simulation.system
    assert isinstance(system, AssemblySystem)
    return (*drawing_blocks(system), *system_blocks(simulation, {own.name for own in system.measures}))


def parts_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Tree of parts, each below the one on which its move places it."""
    assert isinstance(simulation.system, AssemblySystem)
    return parts_tree(simulation.system.assembly)


def workspace(simulation: Simulation, measure: str | None, activity: Callable[[str], None]) -> Map:
    """The workspace of the first move that has one.

    Raises:
        InputError: none has.
    """
    assert isinstance(simulation.system, AssemblySystem)
    moves = simulation.system.assembly.moves
    for move in moves:
        if move.acts.workspace:
            found: Map = at_path(move.acts.workspace)(simulation, move.name, measure, activity)
            return found
    raise InputError("expected a scene with a linkage (kind: close_loop), got none")


def drawing_blocks(system: AssemblySystem) -> Sequence[PageItem]:
    """Features and moves."""
    named = [own for part in system.assembly.parts for own in part.features if own.is_named]
    picked = any(own.face for own in named)
    rows = [
        Row(
            own.name,
            (
                _shape(own) + _facing(system, own),
                _place(system, own),
                _frame(own),
                *((own.face or "–",) if picked else ()),
            ),
        )
        for own in named
    ]
    columns = ("shape", PLACE, "lies in the frame of", *(("face",) if picked else ()))
    words = [Heading(word, words=word != PLACE) for word in columns]
    features = titled("features, nominally in the world", Table("", words, rows))
    plans = planned(system.assembly).moves
    moves = [
        Row(own.move.name, (own.move.acts.words, ", ".join(own.move.parts or own.move.joined[:1]), own.words))
        for own in plans
    ]
    steps = titled("moves", Table("", [Heading(word, words=True) for word in ("kind", "part", "by")], moves))
    frames, freedoms = datum_blocks(system.assembly), freedom_blocks(system.assembly)
    presented = ((at_path(path), own) for own in plans if (path := own.move.acts.presents))
    others = (item for presents, own in presented for item in presents(own, system.assembly))
    return (*_solids(system), *features, *_dimensions(system), *frames, *steps, *freedoms, *others)


def _dimensions(system: AssemblySystem) -> Sequence[PageItem]:
    """Dimensions, and the effect of a positive deviation on each."""
    named = {own.name for own in system.contributors if own.kind == "plus_minus"}
    rows = [
        Row(by.contributor, (own.name, _positive(system, own, by.matrix[:, 0])))
        for own in system.assembly.features.values()
        for by in own.moved_by
        if own.is_named and by.contributor in named
    ]
    columns = [Heading("of", words=True), Heading("a positive deviation moves it", words=True)]
    return titled("dimensions, along the axes of their part", Table("", columns, rows)) if rows else ()


def _positive(system: AssemblySystem, feature: Feature, moved: NDArray[np.float64]) -> str:
    """Direction in which a dimension's positive deviation moves a feature, from its effect on the components."""
    flat, axis = isinstance(feature.shape, Plane | RoundPlane), isinstance(feature.shape, Axis)
    own = (0.0, 0.0, moved[0]) if flat else (*moved[:2], sum(moved[4:])) if axis else moved
    along = feature.frame[:3, :3] @ own
    words = f"along {_direction(along / np.linalg.norm(along))}"
    datums = system.assembly.datum_frames[feature.parent].datums if feature.parent else ()
    specs = [[system.assembly.features[name] for name in datum.features] for datum in datums]
    found = longer(feature.frame[:3, 3], along, specs)
    if found is not None:
        name = "-".join(own.partition(".")[2] for own in datums[found[0]].features)
        return f"{words}: {'longer, away from' if found[1] > 0 else 'shorter, towards'} {name}"
    if flat and not isinstance(feature.shape, Slot):
        return f"{words}: {'out of' if own[2] > 0.0 else 'into'} the material"
    return words


WORDS: Final[Mapping[type[BuiltShape], str]] = {KeptShape: "file", StepShape: "STEP file"}
"""Words for the sources of solids without a builder of ours."""


def _builder_words(shape: BuiltShape) -> str:
    """The builder of a shape: that of a ThrustRing is "thrust ring"."""
    return "".join(f" {own.lower()}" if own.isupper() else own for own in type(shape).__name__).strip()


def _solids(system: AssemblySystem) -> Sequence[PageItem]:
    """Solids of parts, by builder, with their sizes."""
    rows = []
    for part in system.assembly.parts:
        if part.solid is not None:
            low, high = bounding_box(part.solid)
            builder = WORDS.get(type(part.solid)) or _builder_words(part.solid)
            rows.append(Row(part.name, (builder, _listed(high - low, " × "), _listed(low, ", "), _listed(high, ", "))))
    columns = [Heading("builder", words=True), *map(Heading, ("size x × y × z [mm]", "from [mm]", "to [mm]"))]
    return titled("solids, in the frames of their parts", Table("", columns, rows)) if rows else ()


def _listed(numbers: NDArray[np.float64], between: str) -> str:
    return between.join(f"{number:g}" for number in numbers.round(4) + 0.0)


def rest_blocks(plan: RockingPlacer, assembly: Assembly) -> Sequence[PageItem]:
    """Range of the force carried by each contact of a part at rest."""
    least, most = plan.carries()
    rows = [
        Row(str(k), (touched(assembly, moving), touched(assembly, target), f"{100 * low:.0f} to {100 * high:.0f} %"))
        for k, ((moving, target), low, high) in enumerate(zip(plan.contacts, least, most, strict=True), 1)
    ]
    words = [Heading(word, words=True) for word in ("of the part", "on", "carries of the force")]
    return titled(f"contacts of {plan.move.name}, one-sided", Table("", words, rows))


def _shape(feature: Feature) -> str:
    match feature.shape:
        case Slot(extent=(a, b), width=width, inner=inner):
            return f"{'slot' if inner else 'tab'} {width:g} mm wide, {a:g} × {b:g} mm"
        case Plane(extent=(a, b)):
            return f"plane {a:g} × {b:g} mm"
        case RoundPlane(radius=radius):
            return f"plane, radius {radius:g} mm"
        case Point(diameter=float(diameter), inner=inner):
            return f"{'socket' if inner else 'ball'} ⌀{diameter:g} mm"
        case Cone(length=length, inner=inner, diameters=(start, end)):
            angle = math.degrees(abs(feature.shape.angle))
            word = "conical hole" if inner else "cone"
            return f"{word} ⌀{start:.6g} to ⌀{end:.6g} mm, half angle {angle:.4g} deg, {length:g} mm long"
        case Axis(length=length, diameter=None):
            return f"axis, {length:g} mm long"
        case Axis(length=length, diameter=diameter, inner=inner):
            return f"{'hole' if inner else 'pin'} ⌀{diameter:g} mm, {length:g} mm long"
    return "point"


def _place(system: AssemblySystem, feature: Feature) -> str:
    pose = system.assembly.part[feature.part].pose
    at = pose[:3, :3] @ feature.frame[:3, 3] + pose[:3, 3]
    return ", ".join(f"{float(np.round(own, 6)) + 0.0:g}" for own in at)


def _facing(system: AssemblySystem, feature: Feature) -> str:
    """The normal or the axis of a feature in the world, in words; "" for a point."""
    if isinstance(feature.shape, Point):
        return ""
    direction = _direction(system.assembly.part[feature.part].pose[:3, :3] @ feature.frame[:3, 2])
    if isinstance(feature.shape, Slot):
        return f", across {direction}"
    return f", along {direction}" if isinstance(feature.shape, Axis) else f", facing {direction}"


def _direction(direction: NDArray[np.float64]) -> str:
    """A direction of unit length: its axis, or its coordinates."""
    z = direction.round(6) + 0.0
    named = f"{'-' if z.sum() < 0 else ''}{'xyz'[int(np.abs(z).argmax())]}"
    return named if np.abs(z).max() == 1 else "(" + ", ".join(f"{value:.4g}" for value in z) + ")"


def _frame(feature: Feature) -> str:
    return "its part" if not feature.parent else feature.parent.partition("|")[2].replace("|", ", ")


def law_blocks(laws: Mapping[str, str], sigmas: Mapping[str, float]) -> Sequence[PageItem]:
    """The laws of tolerances and sigmas of middles [um], by name; the commonest law in one row where it is of many."""
    commonest, count = Counter(laws.values()).most_common(1)[0]
    together = count >= MANY_ALIKE
    alike = [name for name, words in laws.items() if together and words == commonest]
    rows = [Row(name, (words, _sigma_words([name], sigmas))) for name, words in laws.items() if name not in alike]
    if together:
        name = f"the other {count}" if rows else f"all {count}"
        rows.append(Row(name, (commonest, _sigma_words(alike, sigmas))))
    table = Table("", [Heading("law", words=True), Heading("sigma [µm]")], rows)
    return [*titled("laws of zones", table), note(MIDDLE)]


def _sigma_words(names: Sequence[str], sigmas: Mapping[str, float]) -> str:
    """The sigma of one zone, or the least and largest of several."""
    known = [sigmas[name] for name in names if name in sigmas]
    if not known:
        return NOTHING
    least, most = (f"{own:.3g}" for own in (min(known), max(known)))
    return least if least == most else f"{least} … {most}"
