"""The whole model: frozen, in mm and rad, ready for trials.

A contributor: one toleranced deviation, its draw, and its effect on the parts.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache

import numpy as np

from tol3d.gearing.effects import Effect, Reversing
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Unit
from tol3d.gearing.links import StatedLink
from tol3d.gearing.model.layout import Layout, Turning, layout_of
from tol3d.gearing.model.links import Drive
from tol3d.gearing.model.measure import Backlash, Measure, TransmissionError
from tol3d.gearing.shafts import Arm, Mesh, Seat, Shaft, Train
from tol3d.gears import Gear
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import DeviationLaw
from tol3d.study.system import contributor as system_contributor
from tol3d.study.system.contributor import column_names
from tol3d.study.system.draw import Draw
from tol3d.study.system.positions import Positions
from tol3d.units import RAD_PER_ARCMIN

INTERNAL_PER_UNIT: dict[Unit, float] = {"um": 1e-3, "mrad": 1e-3, "K": 1.0, "arcmin": RAD_PER_ARCMIN}


@dataclass(frozen=True)
class Contributor:
    """A tolerance in the simulation.

    Args:
        name: as in the scene.
        kind: the tolerance's kind, the scene's word.
        effect: of a deviation.
        draw: of its components, from uniforms.
        unit: unit of its columns in results ("um", "mrad", "arcmin", "K").
        description: the scene's own words.
        least: smallest physical deviation [mm, rad or K], such as 0 for a clearance; draws below it are kept
            as they come, and counted.
        nominal: word of a drawing for what moves its mean; "" where it has nothing to be moved.
    """

    name: str
    kind: str
    effect: Effect
    draw: Draw
    unit: Unit
    description: str = ""
    least: float | None = None
    nominal: str = ""

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names in results: `name.component [unit]`."""
        return column_names(self.name, self.draw.components, self.unit)

    @property
    def per_unit(self) -> float:
        """Factor from its unit to mm, rad or K."""
        return INTERNAL_PER_UNIT[self.unit]

    @property
    def distribution(self) -> DeviationLaw:
        """The law of the deviation, or of its length where it has a direction."""
        return self.draw.distribution


def gear_contributor(contributor: system_contributor.Contributor) -> Contributor:
    """A contributor that a study hands back: one of this model's."""
    if not isinstance(contributor, Contributor):
        raise TypeError(f"{contributor.name} is no contributor of gears")
    return contributor


DRIVER_POSITION = "driver position"
MOST_PERIODS = Fraction(2**30)  # 22 of a draw's 52 bits are left for the position of a mesh in one of them


def driver_angles(
    layout: Layout, periods: Mapping[str, Fraction], uniforms: Mapping[tuple[str, str], Array]
) -> Mapping[str, Array]:
    """Driver angle of each trial [rad] (count,) by mesh, or by another link whose play depends on it.

    The first shaft of a tree is uniform over its long period, so that each mesh is uniform over its own.

    Args:
        layout: how shafts turn with each other.
        periods: turns of each one's driver until it stands as before.
        uniforms: (count,) of each tree's stream, (its name, DRIVER_POSITION).
    """
    angles: dict[str, Array] = {}
    for drive in layout.drives:
        own = uniforms[drive.name, DRIVER_POSITION]
        counts = _counts(layout, periods, drive)
        angles |= {move: _of_long_period(layout, (move, periods[move]), count, own) for move, count in counts.items()}
    return angles


def _counts(layout: Layout, periods: Mapping[str, Fraction], drive: Drive) -> Mapping[str, Fraction]:
    """Number of each mesh's own long periods in that of its tree, or in its first MOST_PERIODS."""
    counts = {move: drive.turns * abs(layout.mesh_turn[move].rate) / periods[move] for move in drive.moves}
    share = min(Fraction(1), MOST_PERIODS / max(counts.values()))
    return {move: own * share for move, own in counts.items()}


def _of_long_period(layout: Layout, move: tuple[str, Fraction], count: Fraction, uniforms: Array) -> Array:
    """The driver's angle of a mesh where its tree stands at a share (count,) of so many of its long periods."""
    (name, turns), share = move, uniforms if count == 1 else np.mod(float(count) * uniforms, 1.0)
    turning = layout.mesh_turn[name]
    return turning.offset + math.copysign(2 * math.pi * turns, turning.rate) * share


@lru_cache(maxsize=64)
def _turned(turning: Turning, positions: Positions) -> tuple[float, ...]:
    """Angles [rad] at fixed positions of the first shaft."""
    return tuple(turning.at(angle) for angle in positions.fixed or ())


@dataclass(frozen=True)
class GearPart:
    """A gear: its nominal geometry and its coefficient of expansion [1/K]."""

    name: str
    gear: Gear
    expansion: float = 0.0


@dataclass(frozen=True)
class Housing:
    """Housing that holds the axes apart: its coefficient of expansion applies to the centre distance [1/K]."""

    name: str
    expansion: float


@dataclass(frozen=True)
class Model:
    """Everything that a trial needs. Parts, contributors and measures keep the scene's order.

    `profile_steps` are those of the strips that FCL measures; `warnings` are those of the gears' geometry. A gear that
    no shaft carries is a shaft of its own.
    """

    name: str
    gears: tuple[GearPart, ...]
    housings: tuple[Housing, ...]
    contributors: tuple[Contributor, ...]
    meshes: tuple[Mesh, ...]
    measures: tuple[Measure, ...]
    profile_steps: int = 120
    warnings: tuple[str, ...] = ()
    shafts: tuple[Shaft, ...] = ()
    links: tuple[StatedLink, ...] = ()
    arms: tuple[Arm, ...] = ()
    trains: tuple[Train, ...] = ()

    def gear(self, name: str) -> GearPart:
        """The gear of that name."""
        return next(part for part in self.gears if part.name == name)

    def mesh(self, name: str) -> Mesh:
        """The mesh of that name."""
        return next(mesh for mesh in self.meshes if mesh.name == name)

    def mesh_of(self, link: str) -> Mesh | None:
        """The mesh that a link is; None of another one."""
        return next((mesh for mesh in self.meshes if mesh.name == link), None)

    def link(self, name: str) -> StatedLink:
        """The link of that name, which is no mesh."""
        return next(link for link in self.links if link.name == name)

    def train(self, name: str) -> Train:
        """The train of that name."""
        return next(train for train in self.trains if train.name == name)

    @cached_property
    def layout(self) -> Layout:
        """Positions of its shafts and their turning ratios."""
        return layout_of(self.meshes, self.shafts, self.links)

    @cached_property
    def seats(self) -> tuple[Seat, ...]:
        """Every gear in each of its meshes, driver and driven of one mesh after the other."""
        return tuple(seat for mesh in self.meshes for seat in self._seats_in(mesh))

    def _seats_in(self, mesh: Mesh) -> tuple[Seat, Seat]:
        own = self.layout.seating(mesh.name)
        return Seat(mesh.name, mesh.driver, mesh.azimuth), Seat(mesh.name, mesh.driven, own.azimuth, own.ahead)

    @cached_property
    def seat_index(self) -> Mapping[tuple[str, str], int]:
        """Position of each mesh's gear in arrays over seats."""
        return {(seat.mesh, seat.gear): index for index, seat in enumerate(self.seats)}

    def seats_of(self, gear: str, mesh: str | None = None) -> tuple[int, ...]:
        """Positions of a gear in arrays over seats: in all of its meshes, or in one."""
        if mesh is not None:
            return (self.seat_index[mesh, gear],)
        return tuple(index for index, seat in enumerate(self.seats) if seat.gear == gear)

    def driver_angles(self, measure: Measure, mesh: str) -> tuple[float, ...] | None:
        """Angles of a mesh's driver [rad] at which a measure is read in every trial; None for the trial's own.

        A mesh's own positions are its driver's; those of a train are its first shaft's. Of another link whose play
        depends on the position likewise.
        """
        fixed, kind = measure.positions.fixed, measure.kind
        if fixed is None or isinstance(kind, Backlash) or (isinstance(kind, TransmissionError) and not kind.train):
            return fixed
        return _turned(self.layout.mesh_turn[mesh], measure.positions)

    @cached_property
    def reversed(self) -> "Model":
        """The model whose shafts lie in their bearings as the load on the other flanks pushes them."""
        loaded = (replace(contributor, effect=contributor.effect.reversed) for contributor in self.contributors)
        return replace(self, contributors=tuple(loaded))

    def reverses(self, mesh: Mesh) -> bool:
        """True if gears of a mesh lie elsewhere while its other flanks carry the load."""
        effects = (contributor.effect for contributor in self.contributors)
        return any(isinstance(effect, Reversing) and effect.acts_in(mesh) for effect in effects)

    # its trials -------------------------------------------------------------------------------------

    @property
    def streams(self) -> tuple[tuple[str, str], ...]:
        """See System: the position of each tree of shafts."""
        return tuple((drive.name, DRIVER_POSITION) for drive in self.layout.drives)

    def positions(self, uniforms: Mapping[tuple[str, str], Array]) -> Mapping[str, Array]:
        """See System: the driver's angle [rad] by mesh, and by other link whose play depends on it."""
        periods = {mesh.name: Fraction(mesh.pair.long_period_turns) for mesh in self.meshes}
        periods |= {link.name: link.turns for link in self.links if link.turns is not None}
        return driver_angles(self.layout, periods, uniforms)

    def turns_at_random(self, contributor: system_contributor.Contributor, positions: Positions) -> bool:
        """See System: of an offset that turns with its gear, read at random positions."""
        return positions.over == "random" and gear_contributor(contributor).effect.turns_with is not None

    @cached_property
    def expansions(self) -> Mapping[str, float]:
        """Coefficient of expansion [1/K] of every part."""
        gears = {part.name: part.expansion for part in self.gears}
        return gears | {part.name: part.expansion for part in self.housings}

    @cached_property
    def component_slices(self) -> Mapping[str, slice]:
        """Which columns of the deviations belong to each contributor."""
        slices, start = {}, 0
        for contributor in self.contributors:
            width = len(contributor.draw.components)
            slices[contributor.name] = slice(start, start + width)
            start += width
        return slices

    @property
    def component_count(self) -> int:
        """Columns of the deviations."""
        return sum(len(contributor.draw.components) for contributor in self.contributors)
