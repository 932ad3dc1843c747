"""Tables of a scene of an assembly: features with their datum frames, moves."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Feature
from tol3d.assembly.model.dimension import longer
from tol3d.assembly.placing.nominal_constraints import Freedoms, HeldFreedoms, held_by, held_by_datums, in_words
from tol3d.assembly.placing.placer import Placer, RockingPlacer, touched
from tol3d.assembly.placing.plan import planned
from tol3d.assembly.presenting.parts_tree import parts_tree
from tol3d.assembly.system import AssemblySystem
from tol3d.cad.solids import BuiltShape
from tol3d.cad.solids.display_mesh import bounding_box
from tol3d.cad.solids.kept_shape import KeptShape
from tol3d.cad.step.step_shape import StepShape
from tol3d.errors import InputError
from tol3d.import_path import named as at_path
from tol3d.report.declared import declared_table
from tol3d.report.number import NOTHING
from tol3d.report.page import PageItem, Shown, note, titled
from tol3d.report.presenter import Map
from tol3d.report.system_check import MIDDLE, system_blocks
from tol3d.study.runs.summary.shows import Computed, RowOf, Shows
from tol3d.study.trials.simulation import Simulation

SIGNS: Final = "z: a shift along z; turns z: a turn about z; each holds of what those above it leave"


class DatumFrameRow(RowOf[Freedoms]):
    """The freedoms that a datum frame takes."""

    takes = Computed(
        Shows("each takes", "words"),
        lambda own: "; ".join(f"{each.words}: {in_words(each)}" for each in own.of.taken),
    )
    left = Computed(Shows("stay as in the part", "words"), lambda own: _left(own.of))


def datum_blocks(assembly: Assembly) -> Sequence[PageItem]:
    """Which freedoms datums take."""
    rows = [
        (
            f"{datum_frame.part}: {', '.join(datum_frame.name.split('|')[1:])}",
            DatumFrameRow(held_by_datums(assembly, datum_frame)),
        )
        for datum_frame in assembly.datum_frames.values()
    ]
    return titled("datum frames, along the axes of their part", declared_table("", rows)) if rows else ()


@dataclass(frozen=True)
class HeldRow:
    """Freedoms of a move, and what holds them."""

    freedoms: Annotated[str, Shows("freedoms", "words")]
    held_by: Annotated[str, Shows("held by", "words")]


def freedom_blocks(assembly: Assembly) -> Sequence[PageItem]:
    """Freedoms held by moves, and those left."""
    rows: list[tuple[str, HeldRow]] = []
    for move, plan in zip(assembly.moves, planned(assembly).moves, strict=True):
        found = held_by(assembly, plan) if len(move.parts) == 1 else None
        if found is None or not found.taken:
            rows += [(move.name, HeldRow(*hold)) for hold in move.holds]
            continue
        rows += [(move.name, HeldRow(in_words(own), _by(own))) for own in found.taken]
        if found.left.count:
            rows.append((move.name, HeldRow(_left(found), "left as drawn")))
    return (*titled("freedoms that moves hold, along the axes of the world", declared_table("", rows)), note(SIGNS))


def _by(taken: HeldFreedoms) -> str:
    return f"{taken.words}, within clearance" if taken.is_room else taken.words


def _left(freedoms: Freedoms) -> str:
    """Remaining freedoms; for a single turn also its axis."""
    return f"{in_words(freedoms.left)}{f' {freedoms.where}' if freedoms.where else ''}"


MANY_ALIKE: Final = 3
"""Largest number of zones of one law that share a row."""


def check_blocks(simulation: Simulation) -> Sequence[PageItem]:
    """Features, moves, and what any system shows."""
    system = simulation.system
    assert isinstance(system, AssemblySystem)
    return (*drawing_blocks(system), *system_blocks(simulation, {measure.name for measure in system.measures}))


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


@dataclass(frozen=True)
class FeatureRow:
    """A feature of a part, nominally in the world."""

    system: AssemblySystem
    feature: Feature
    shape = Computed(Shows("shape", "words"), lambda own: own.feature.shape.words + _facing(own.system, own.feature))
    at = Computed(Shows("at [mm]"), lambda own: _place(own.system, own.feature))
    frame = Computed(Shows("lies in the frame of", "words"), lambda own: _frame(own.feature))
    face = Computed(Shows("face", "words", seldom=True), lambda own: own.feature.face or None)


class MoveRow(RowOf[Placer]):
    """A move, and the part that it places."""

    kind = Computed(Shows("kind", "words"), lambda own: own.of.move.acts.words)
    part = Computed(Shows("part", "words"), lambda own: ", ".join(own.of.move.parts or own.of.move.joined[:1]))
    by = Computed(Shows("by", "words"), lambda own: own.of.words)


def drawing_blocks(system: AssemblySystem) -> Sequence[PageItem]:
    """Features and moves."""
    named = [feature for part in system.assembly.parts for feature in part.features if feature.is_named]
    rows = [(own.name, FeatureRow(system, own)) for own in named]
    features = titled("features, nominally in the world", declared_table("", rows))
    plans = planned(system.assembly).moves
    steps = titled("moves", declared_table("", [(plan.move.name, MoveRow(plan)) for plan in plans]))
    frames, freedoms = datum_blocks(system.assembly), freedom_blocks(system.assembly)
    presented = ((at_path(path), plan) for plan in plans if (path := plan.move.acts.presents))
    others = (item for presents, own in presented for item in presents(own, system.assembly))
    return (*_solids(system), *features, *_dimensions(system), *frames, *steps, *freedoms, *others)


@dataclass(frozen=True)
class DimensionRow:
    """The feature that a dimension moves."""

    feature: Annotated[str, Shows("of", "words")]
    moves: Annotated[str, Shows("a positive deviation moves it", "words")]


def _dimensions(system: AssemblySystem) -> Sequence[PageItem]:
    """Dimensions, and the effect of a positive deviation on each."""
    named = {contributor.name for contributor in system.contributors if contributor.kind == "plus_minus"}
    rows = [
        (by.contributor, DimensionRow(feature.name, _positive(system, feature, by.matrix[:, 0])))
        for feature in system.assembly.features.values()
        for by in feature.moved_by
        if feature.is_named and by.contributor in named
    ]
    return titled("dimensions, along the axes of their part", declared_table("", rows)) if rows else ()


def _positive(system: AssemblySystem, feature: Feature, moved: NDArray[np.float64]) -> str:
    """Direction in which a dimension's positive deviation moves a feature, from its effect on the components."""
    own = feature.shape.origin_by @ moved
    along = feature.frame[:3, :3] @ own
    words = f"along {_direction(along / np.linalg.norm(along))}"
    datums = system.assembly.datum_frames[feature.parent].datums if feature.parent else ()
    specs = [[system.assembly.features[name] for name in datum.features] for datum in datums]
    found = longer(feature.frame[:3, 3], along, specs)
    if found is not None:
        name = "-".join(own.partition(".")[2] for own in datums[found[0]].features)
        return f"{words}: {'longer, away from' if found[1] > 0 else 'shorter, towards'} {name}"
    if feature.shape.facing == "facing":
        return f"{words}: {'out of' if own[2] > 0.0 else 'into'} the material"
    return words


WORDS: Final[Mapping[type[BuiltShape], str]] = {KeptShape: "file", StepShape: "STEP file"}
"""Words for the sources of solids without a builder of ours."""


def _builder_words(shape: BuiltShape) -> str:
    """The builder of a shape: that of a ThrustRing is "thrust ring"."""
    return "".join(f" {own.lower()}" if own.isupper() else own for own in type(shape).__name__).strip()


@dataclass(frozen=True)
class SolidRow:
    """The solid of a part, and the ends of the box around it [mm]."""

    solid: BuiltShape
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    builder = Computed(Shows("builder", "words"), lambda own: WORDS.get(type(own.solid)) or _builder_words(own.solid))
    size = Computed(Shows("size x × y × z [mm]"), lambda own: _listed(own.high - own.low, " × "))
    start = Computed(Shows("from [mm]"), lambda own: _listed(own.low, ", "))
    end = Computed(Shows("to [mm]"), lambda own: _listed(own.high, ", "))


def _solids(system: AssemblySystem) -> Sequence[PageItem]:
    """Solids of parts, by builder, with their sizes."""
    solids = {part.name: part.solid for part in system.assembly.parts if part.solid is not None}
    rows = [(name, SolidRow(own, *bounding_box(own))) for name, own in solids.items()]
    return titled("solids, in the frames of their parts", declared_table("", rows)) if rows else ()


def _listed(numbers: NDArray[np.float64], between: str) -> str:
    return between.join(f"{number:g}" for number in numbers.round(4) + 0.0)


@dataclass(frozen=True)
class ContactRow:
    """A contact of a part at rest, and the least and most that it carries."""

    moving: Annotated[str, Shows("of the part", "words")]
    target: Annotated[str, Shows("on", "words")]
    carries: Annotated[str, Shows("carries of the force", "words")]


def rest_blocks(plan: RockingPlacer, assembly: Assembly) -> Sequence[PageItem]:
    """Range of the force carried by each contact of a part at rest."""
    least, most = plan.carries()
    rows = []
    for k, ((moving, target), low, high) in enumerate(zip(plan.contacts, least, most, strict=True), 1):
        carries = f"{100 * low:.0f} to {100 * high:.0f} %" if np.isfinite(high) else f"{100 * low:.0f} % or more"
        rows.append((str(k), ContactRow(touched(assembly, moving), touched(assembly, target), carries)))
    return titled(f"contacts of {plan.move.name}, one-sided", declared_table("", rows))


def _place(system: AssemblySystem, feature: Feature) -> str:
    pose = system.assembly.part[feature.part].pose
    at = pose[:3, :3] @ feature.frame[:3, 3] + pose[:3, 3]
    return ", ".join(f"{float(np.round(own, 6)) + 0.0:g}" for own in at)


def _facing(system: AssemblySystem, feature: Feature) -> str:
    """The normal or the axis of a feature in the world, in words; "" for a point."""
    if not feature.shape.facing:
        return ""
    direction = _direction(system.assembly.part[feature.part].pose[:3, :3] @ feature.frame[:3, 2])
    return f", {feature.shape.facing} {direction}"


def _direction(direction: NDArray[np.float64]) -> str:
    """A direction of unit length: its axis, or its coordinates."""
    z = direction.round(6) + 0.0
    named = f"{'-' if z.sum() < 0 else ''}{'xyz'[int(np.abs(z).argmax())]}"
    return named if np.abs(z).max() == 1 else "(" + ", ".join(f"{value:.4g}" for value in z) + ")"


def _frame(feature: Feature) -> str:
    return "its part" if not feature.parent else feature.parent.partition("|")[2].replace("|", ", ")


@dataclass(frozen=True)
class LawRow:
    """The law of a zone or of several, and the sigmas of their middles [µm]."""

    law: Annotated[str, Shows("law", "words")]
    sigmas: Sequence[float]
    sigma = Computed(Shows("sigma [µm]", meaning=MIDDLE), lambda own: _sigma_words(own.sigmas))


def law_blocks(laws: Mapping[str, str], sigmas: Mapping[str, float]) -> Sequence[PageItem]:
    """The laws of tolerances and sigmas of middles [um], by name; the commonest law in one row where it is of many."""
    commonest, count = Counter(laws.values()).most_common(1)[0]
    together = count >= MANY_ALIKE
    alike = [name for name, words in laws.items() if together and words == commonest]
    groups = {name: [name] for name in laws if name not in alike}
    if together:
        groups[f"the other {count}" if groups else f"all {count}"] = alike
    rows = [(name, LawRow(laws[of[0]], [sigmas[own] for own in of if own in sigmas])) for name, of in groups.items()]
    return [*titled("laws of zones", declared_table("", rows)), note(MIDDLE)]


def _sigma_words(sigmas: Sequence[float]) -> str | Shown:
    """The sigma of one zone, or the least and largest of several."""
    if not sigmas:
        return NOTHING
    least, most = (f"{own:.3g}" for own in (min(sigmas), max(sigmas)))
    return Shown(least, sigmas[0]) if least == most else f"{least} … {most}"
