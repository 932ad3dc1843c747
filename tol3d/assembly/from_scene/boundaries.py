"""Datums at their material boundaries: the gauge of virtual condition, and how it shifts the datum frame."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from tol3d.assembly.from_scene.datums import DatumFrames, frame_name, of_tolerances
from tol3d.assembly.from_scene.effects import Drawn, Effects
from tol3d.assembly.from_scene.zones import sized_by
from tol3d.assembly.grammar.boundary_checks import earlier_zone, is_square, shifts_alone
from tol3d.assembly.grammar.datums import DatumSpec, Lying
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.features.feature_spec import AXES
from tol3d.assembly.model import Contribution, DatumFrame, Floating, Gauges
from tol3d.assembly.model.datum_frame import GaugeRoom
from tol3d.assembly.zones import Bonus, SizedBy, ZoneDraw, catalogue, uniform_in
from tol3d.assembly.zones.float_draw import SHIFT_AND_TURN, FloatDraw, GaugeShift, Leaning
from tol3d.numerics.arrays import Array
from tol3d.study.system.plain import PlainContributor

ANY = 1e3
"""mm; a gauge's clearance grows with the size, beyond the drawing's limits too."""

HALF_DIFFERENCE = 0.5 * np.array([[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]])
"""Matrix for (start x, start y, end x, end y)."""


@dataclass(frozen=True)
class Boundary:
    """A datum at a material boundary, as a tolerance of its part names it.

    Args:
        feature: with its part.
        earlier: datums before it, which orient the gauge.
        own: the datum.
    """

    feature: str
    earlier: tuple[DatumSpec, ...]
    own: DatumSpec


def gauge_shifts(drawing: Drawing, effects: Effects, frames: DatumFrames) -> Iterator[Drawn]:
    """The draws of gauges in their clearances: one contributor each, common to all features of the frame.

    Args:
        drawing: tolerances by feature.
        effects: of tolerances, by which datum features lean.
        frames: regardless of sizes.
    """
    for name, boundary in _boundaries(drawing).items():
        if boundary.own.gauge == "random":
            yield Drawn(_shift(drawing, effects, boundary), of=name)
    for name in _with_gauges(drawing, frames):
        if _lying(frames.specs[name]) == "random":
            yield Drawn(_floating(frames.made[name], frames.specs[name]), of=name)


def on_gauges(drawing: Drawing, effects: Effects, frames: DatumFrames) -> DatumFrames:
    """Datum frames whose datums at their boundaries lie on gauges, which shift as they are drawn."""
    made = dict(frames.made)
    for name, boundary in _boundaries(drawing).items():
        across = drawing.kind(boundary.feature).frame[:3, :2]
        own = (Contribution(drawn, columns, across) for drawn, columns in effects.drawn.get(name, {}).items())
        made[name] = replace(made[name], shifted_by=tuple(own))
    for name in _with_gauges(drawing, frames):
        frame, datums, lying = made[name], frames.specs[name], _lying(frames.specs[name])
        floating = Floating("centred")
        if lying == "random":
            (columns,) = effects.drawn[name].values()
            floating = Floating("random", columns)
        rooms = rooms_of(drawing, frame.part, datums)
        made[name] = replace(frame, gauges=Gauges(rooms, None if lying == "least" else floating))
    return replace(frames, made=MappingProxyType(made))


def _with_gauges(drawing: Drawing, frames: DatumFrames) -> Iterator[str]:
    """Datum frames with gauges of their own, those of tolerances first and in their order."""
    toleranced = {
        frame_name(*of_tolerance): shifts_alone(drawing, *of_tolerance) for of_tolerance in of_tolerances(drawing)
    }
    for name in dict.fromkeys((*toleranced, *frames.specs)):
        if _lying(frames.specs[name]) is not None and not toleranced.get(name, False):
            yield name


def _floating(frame: DatumFrame, datums: Sequence[DatumSpec]) -> PlainContributor:
    """The position of a frame's gauges within their clearances."""
    first = next(k for k, own in enumerate(datums) if own.gauge is not None)
    own, to, then = (
        ", ".join("-".join(each.features) + _least(each) for each in some)
        for some in (
            [datum for datum in datums if datum.gauge is not None],
            datums[:first],
            [each for each in datums[first:] if each.gauge is None],
        )
    )
    draw = FloatDraw(("room",), (*SHIFT_AND_TURN, "start"))
    name = f"shift of {frame.part}.{own}" + (f" to {to}" if to else "") + (f", then {then}" if then else "")
    words = f"of the gauges at the {_boundary(datums)} material boundary of datums"
    return PlainContributor(name, "datum_shift", draw, "1", 1.0, words)


def _lying(datums: Sequence[DatumSpec]) -> Lying | None:
    """Position of the gauges of a frame in their room; None without any."""
    return next((datum.gauge for datum in datums if datum.gauge is not None), None)


def _boundaries(drawing: Drawing) -> dict[str, Boundary]:
    """By the name of the frame, in the order of the tolerances."""
    return {
        frame_name(part, datums): Boundary(f"{part}.{datums[-1].features[0]}", datums[:-1], datums[-1])
        for part, datums in of_tolerances(drawing)
        if shifts_alone(drawing, part, datums)
    }


def rooms_of(drawing: Drawing, part: str, datums: tuple[DatumSpec, ...]) -> tuple[GaugeRoom, ...]:
    """Datum shift allowed to each gauge of the datums at their boundary."""
    found = []
    for k, name in ((k, name) for k, own in enumerate(datums) if own.gauge is not None for name in own.features):
        feature = f"{part}.{name}"
        shape, (virtual, grows) = drawing.kind(feature).shape, _virtual(drawing, feature, datums, k)
        found.append(GaugeRoom(feature, (shape.nominal_size or 0.0) + virtual, grows))
    return tuple(found)


def _least(datum: DatumSpec) -> str:
    return " lmb" if datum.lmb is not None else ""


def _boundary(datums: Sequence[DatumSpec]) -> str:
    """The boundaries of the gauges of a frame, in words."""
    words = {"mmc": "maximum", "lmc": "least"}
    return " or ".join(dict.fromkeys(words[datum.boundary] for datum in datums if datum.gauge is not None))


def room_of(drawing: Drawing, of: str, datums: tuple[DatumSpec, ...]) -> GaugeRoom | None:
    """Datum shift allowed to the gauge of the last datum, for a position along it; None unless it shifts alone."""
    part = part_of(of)
    if not shifts_alone(drawing, part, datums):
        return None
    boundary = Boundary(f"{part}.{datums[-1].features[0]}", datums[:-1], datums[-1])
    measured = drawing.kind(of)
    if measured.kind not in AXES or not is_square(*_axes(drawing, boundary.feature, of)):
        return None
    return rooms_of(drawing, part, datums)[0]


def _axes(drawing: Drawing, *features: str) -> tuple[Array, Array]:
    first, second = (drawing.kind(feature).frame[:3, 2] for feature in features)
    return first, second


def _virtual(drawing: Drawing, feature: str, datums: Sequence[DatumSpec], k: int) -> tuple[float, bool]:
    """Virtual condition of a feature of a datum, as a deviation from nominal [mm], and whether larger ones leave room.

    At the maximum material boundary a hole holds its gauge, and a pin is held by it; at the least one the gauge lies
    inside the material: a hole lies within its gauge, and a pin holds it. Features that may be farther off at this
    size, by a bonus from the other condition, have all of it in their gauge.
    """
    boundary = datums[k].boundary
    bonus = sized_by(drawing, feature, boundary).bonus
    tolerance, modifier = earlier_zone(drawing, feature, datums, k) or (0.0, None)
    tolerance += bonus.most if modifier not in (None, boundary) else 0.0
    return bonus.low - tolerance if bonus.grows else bonus.high + tolerance, bonus.grows


def _shift(drawing: Drawing, effects: Effects, boundary: Boundary) -> PlainContributor:
    """The shift of the gauge of a datum within its clearance."""
    to = ", ".join(name for datum in boundary.earlier for name in datum.features)
    name = f"shift of {boundary.feature}{_least(boundary.own)} to {to}"
    words = f"of the gauge at the {_boundary((boundary.own,))} material boundary of a datum"
    return PlainContributor(name, "datum_shift", _room(drawing, effects, boundary), description=words)


def _room(drawing: Drawing, effects: Effects, boundary: Boundary) -> GaugeShift:
    sized = sized_by(drawing, boundary.feature, boundary.own.boundary)
    virtual, grows = _virtual(drawing, boundary.feature, (*boundary.earlier, boundary.own), len(boundary.earlier))
    bonus = Bonus(virtual if grows else virtual - ANY, virtual + ANY if grows else virtual, grows=grows)
    zone = catalogue.point_in_disc(0.0)
    draws = {contributor.name: contributor.draw for contributor in effects.contributors}
    leaning = []
    for own in effects.moved_by.get(boundary.feature, ()):
        matrix, draw = HALF_DIFFERENCE @ own.matrix, draws[own.contributor]
        if isinstance(draw, ZoneDraw) and _tilts(matrix, draw):
            leaning.append(Leaning(own.contributor, draw, tuple(tuple(row) for row in matrix.tolist())))
    return GaugeShift(zone, uniform_in(zone), SizedBy(sized.name, sized.law, bonus), tuple(leaning))


def _tilts(matrix: Array, draw: ZoneDraw) -> bool:
    """True if a contributor ever displaces the ends of the datum feature from each other."""
    return bool((matrix @ draw.covariance @ matrix.T).any() or (matrix @ draw.mean_vector).any())
