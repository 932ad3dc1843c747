"""Builds of a scene for the page's 3D view: meshes as GLB, each sent once, and where they stand, without a run."""

import json
import secrets
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Final

import numpy as np

from tol3d.errors import InputError, Tol3dError
from tol3d.numerics.arrays import Array
from tol3d.report import ViewModel, display_build, travels_of
from tol3d.report.number import measured_text
from tol3d.report.presenter import Display
from tol3d.report.shown_unit import shown_unit
from tol3d.simulate import Replay, replayed
from tol3d.study import Simulation
from tol3d.study.system import Posable, System, Trials, nominal_build

NOMINAL: Final = "nominal"
FACTORS: Final = (1.0, 10.0, 100.0)
"""Magnifications of deviations; a build shows those that it allows."""
MOST_MESHES: Final = 400
"""Meshes that a page keeps; beyond them it gets all anew."""
NO_REASONS: Final[Mapping[str, str]] = {}
AS_STATED: Final[Mapping[str, float]] = {}
STANDS: Final = ", as it stands"
NO_MODELS: Final[Mapping[str, ViewModel]] = {}
TURN: Final = 360.0  # deg; a slider turns no further, after which a position looks alike


@dataclass(frozen=True, eq=False)
class Row:
    """A build that is shown besides the nominal one.

    Args:
        deviations: (components,) [mm, rad, K].
        positions: a number each by name; None: at rest.
        words: about it, before those of its display.
    """

    deviations: Array
    positions: Mapping[str, Array] | None = None
    words: str = ""


@dataclass(frozen=True)
class Known:
    """Meshes that a page has: the name of their collection, and their number."""

    collection: str = ""
    meshes: int = 0


@dataclass(eq=False)
class Stage:
    """An open scene as a page shows it: its meshes are kept from picture to picture, those of each world by themselves.

    Args:
        simulation: of the scene.
    """

    simulation: Simulation
    _kept: dict[str, ViewModel] = field(default_factory=dict)
    _names: dict[str, str] = field(default_factory=dict)

    def picture(
        self, rows: Mapping[str, Row], *, known: Known, refused: Mapping[str, str] = NO_REASONS, **how: Any
    ) -> bytes:
        """Length and text of JSON, then a GLB of the meshes that the page does not have; nothing where it has all.

        Args:
            rows: builds besides the nominal one, by name.
            known: meshes that the page has.
            refused: builds that are not there, and why.
            how: see `build_view`.

        Raises:
            InputError: there is nothing to show.
        """
        try:
            model, told = build_view(self.simulation, rows, kept=self._kept, **how)
        except InputError:
            raise
        except Tol3dError as error:
            raise InputError(f"there is nothing to show in 3D: {error}") from None
        world = str(told["world"])
        if world not in self._kept:
            self._names[world] = secrets.token_hex(8)
        self._kept[world] = model
        if len(model.surfaces) > MOST_MESHES:
            del self._kept[world]
        first = known.meshes if known.collection == self._names[world] else 0
        new = model.glb(first) if first < len(model.surfaces) else b""
        told["refused"] = {**refused, **told["refused"]}
        told |= {"collection": self._names[world], "meshes": len(model.surfaces), "first": first}
        head = json.dumps(told, allow_nan=False).encode()
        return len(head).to_bytes(4, "big") + head + new


def build_view(
    simulation: Simulation,
    rows: Mapping[str, Row],
    *,
    factors: Sequence[float] = FACTORS,
    world: str = "",
    measure: str = "",
    at: Mapping[str, Array] | None = None,
    standing: Mapping[str, float] = AS_STATED,
    motion: str = "",
    kept: Mapping[str, ViewModel] = NO_MODELS,
) -> tuple[ViewModel, dict[str, Any]]:
    """The nominal build and others, as `viewer.js` shows them.

    Args:
        simulation: of the scene.
        rows: each further build by its name.
        factors: of the deviations, the least first; those with which a build cannot be shown are left out.
        world: the one that is shown; "" for that in which `measure` is read, where it is largest, or that with the most
            parts.
        measure: by its name.
        at: positions of all builds, a number each by name; None: their own, the nominal build with those of the first.
        standing: values of coordinates by which parts stand, see `Posable`; none: in the poses that are stated.
        motion: one of those that parts go through, from the first world on, with the first factor alone; "" for none.
        kept: models by world whose meshes are shared; new ones are added to them.

    Returns:
        the builds; and for JSON what `ViewModel.told` tells, the names of all `worlds`, `measured`: whether `measure`
        is read in the one that is shown or on the way, `travels`: names of motions, and `refused`: by the names of
        builds of `rows` that cannot be shown, why.

    Raises:
        Tol3dError: the nominal build cannot be shown, or there is no such world.
    """
    if standing:
        simulation, world = _standing(simulation, standing, measure), ""
    rest = nominal_build(simulation.system)
    own = next((row.positions for row in rows.values()), None) if at is None else at
    build = replayed(simulation, _trials(rest, rest.deviations[0], own))
    nominal, refused = display_build(build, NOMINAL), dict[str, str]()
    others = dict[str, tuple[Replay, Display]]()
    for name, row in rows.items():
        trials = _trials(rest, row.deviations, row.positions if at is None else at)
        try:
            other = replayed(simulation, trials)
            others[name] = other, display_build(other, name, magnify=factors[0])
        except Tol3dError as error:
            refused[name] = str(error)
    worlds, travels = [own for own in nominal.worlds if own.bodies], travels_of(nominal)
    moves = motion if motion in travels and not standing else None
    if moves:
        world, factors = worlds[0].name, factors[:1]
    reading = {own.name: own for own in worlds if measure in own.measured}
    if not world and reading:
        first = next((display for _, display in others.values()), nominal)
        its = _lengths(first, measure)
        world = max(reading, key=lambda own: (len(reading[own].bodies), its.get(own, 0.0)))
    elif not world and worlds:
        world = max(worlds, key=lambda own: len(own.bodies)).name
    model = kept[world].kept(moves) if world in kept else ViewModel(wanted=world, motion=moves)
    more = STANDS if standing else ""
    model.add(NOMINAL, [(1.0, nominal, _words(NOMINAL, nominal))], _values(build, more))
    for name, (other, display) in others.items():
        displays = _displays(_shown_in(other, world), display, name, rows[name].words, factors)
        try:
            model.add(name, displays, _values(other, more))
        except Tol3dError as error:
            refused[name] = str(error)
    shown = model.told()
    reads = bool(reading) if moves else shown["world"] in reading
    told = {"worlds": [own.name for own in worlds], "measured": reads, "travels": [*travels], "refused": refused}
    return model, {**shown, **told}


def _standing(simulation: Simulation, values: Mapping[str, float], measure: str) -> Simulation:
    """The scene as its parts stand at values of coordinates.

    Raises:
        InputError: there are no such coordinates, or they do not go so far.
    """
    system = simulation.system
    known = {own.name: own for own in system.coordinates} if isinstance(system, Posable) else {}
    for name, value in values.items():
        if name not in known:
            raise InputError(f"expected one of {', '.join(known) or 'no joints'}, got {name!r}")
        if not known[name].low <= value <= known[name].high:
            raise InputError(f"{name}: expected {known[name].low:g} to {known[name].high:g}, got {value:g}")
    assert isinstance(system, Posable)
    return replace(simulation, system=system.standing(values, [measure or system.measures[0].name]))


def _shown_in(build: Replay, world: str) -> Replay:
    """A build of which only the parts in a pose are shown, where the world is one."""
    system = build.simulation.system
    if not isinstance(system, Posable):
        return build
    return replace(build, simulation=replace(build.simulation, system=system.shown_in(world)))


def _lengths(display: Display, measure: str) -> Mapping[str, float]:
    """Length of the lines of a measure in each world [mm]."""
    lines = {own.name: own.measured.get(measure, ()) for own in display.worlds}
    return {
        name: sum(float(np.linalg.norm(line.points[-1] - line.points[0])) for line in every)
        for name, every in lines.items()
    }


def _trials(rest: Trials, deviations: Array, positions: Mapping[str, Array] | None) -> Trials:
    standing = rest.positions if positions is None else {key: np.atleast_1d(own) for key, own in positions.items()}
    return Trials(np.atleast_2d(deviations), standing)


def _displays(
    build: Replay, first: Display, name: str, words: str, factors: Sequence[float]
) -> Iterator[tuple[float, Display, str]]:
    """A build by every factor with which it can be shown; by the first one it is."""
    yield factors[0], first, words + _words(name, first)
    for factor in factors[1:]:
        try:
            display = display_build(build, name, magnify=factor)
        except Tol3dError:
            return
        yield factor, display, words + _words(name, display)


def _words(name: str, display: Display) -> str:
    return "; ".join((name, *display.notes))


def _values(build: Replay, more: str) -> Mapping[str, str]:
    """Values of the measures of a build, in words, with more words after them; none of curves."""
    found = dict[str, str]()
    for measure in build.simulation.system.measures:
        value = build.geometric.get(measure.name, build.analytic.get(measure.name))
        if isinstance(value, float) and np.isfinite(value):
            unit = shown_unit(measure.unit, value)
            found[measure.name] = measured_text(value * (1e-3 if unit != measure.unit else 1.0), unit) + more
    return found


# positions ----------------------------------------------------------------------------------------


def positions_at(system: System, shares: Mapping[str, float]) -> Mapping[str, Array]:
    """Positions at shares of all that trials are drawn from, by the names that `turnable` gives; others at rest."""
    uniforms = {key: np.full(1, min(max(shares.get(" ".join(key), 0.0), 0.0), 1.0)) for key in system.streams}
    return {name: own[0] for name, own in system.positions(uniforms).items()}


def turnable(system: System) -> list[dict[str, Any]]:
    """Positions that are drawn, for JSON.

    Of each its `name`, `words`, the `share` of what is drawn to which a slider goes, one turn at most, and the values
    `low` and `high` there, with their `unit`.
    """
    found, names = list[dict[str, Any]](), [key[0] for key in system.streams]
    for key in system.streams:
        name = " ".join(key)
        start, end = (_columns(system, {name: share}) for share in (0.0, 1.0))
        column = next((own for own in start if start[own] != end[own]), "")
        low, high = start.get(column, 0.0), end.get(column, 1.0)
        unit = column.rpartition("[")[2].rstrip("]") if column else ""
        share = min(1.0, TURN / abs(high - low)) if unit == "deg" else 1.0
        words = key[0] if names.count(key[0]) == 1 else name
        found.append(
            {"name": name, "words": words, "share": share, "low": low, "high": low + share * (high - low), "unit": unit}
        )
    return found


def stands(system: System) -> list[dict[str, Any]]:
    """Coordinates by which parts stand, for JSON; see `Coordinate`."""
    return [asdict(own) for own in system.coordinates] if isinstance(system, Posable) else []


def _columns(system: System, shares: Mapping[str, float]) -> Mapping[str, float]:
    rest = nominal_build(system)
    standing = {name: np.atleast_1d(own) for name, own in positions_at(system, shares).items()}
    return {name: float(own[0]) for name, own in system.columns(replace(rest, positions=standing)).items()}
