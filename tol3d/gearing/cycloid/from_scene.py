"""An RV reducer from a scene, with its deviations and measures, or the reason why it cannot be built."""

import math
from typing import Any, Final

from tol3d.errors import GeometryError
from tol3d.gearing.cycloid.grammar.measures import (
    CycloidMeasureSpec,
    CycloidPinsNearContactSpec,
    CycloidTransmissionErrorSpec,
)
from tol3d.gearing.cycloid.grammar.moves import RVReducerSpec
from tol3d.gearing.cycloid.grammar.parts import CrankCarrierSpec, CrankshaftSpec, CycloidDiscSpec, PinRingSpec
from tol3d.gearing.cycloid.grammar.published import PublishedCycloidStages
from tol3d.gearing.cycloid.grammar.tolerances import BearingPlaySpec
from tol3d.gearing.cycloid.model.limits import circle_fault, faults, hole_faults, largest_window, lobes_fault
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification
from tol3d.gearing.cycloid.model.shapes import DiscHoles
from tol3d.gearing.cycloid.reducer.draws import acts_of, draw_of
from tol3d.gearing.cycloid.reducer.rv_set import FirstStage, RVSet
from tol3d.gearing.cycloid.system import PlayingSystem, RVSystem
from tol3d.gearing.grammar.measures import GearStudyOptions
from tol3d.gearing.model.from_scene import implausible_teeth
from tol3d.gearing.model.pairs import cylindrical_gear
from tol3d.gearing.reducers.from_scene import ReducerKind, unlike
from tol3d.gearing.reducers.trials import ReducerMeasure, reducer_measure
from tol3d.gears import SpurGear, SpurPair
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.scene.published import PublishedColumn


def _reducer_of(scene: Scene, name: str, spec: RVReducerSpec) -> RVSet:
    """The reducer that a move of a scene stands for, whatever else is in the scene.

    Raises:
        SceneError: it cannot be put together.
    """
    _, disc, _, carrier = spec.parts_among(scene.parts)
    profile = _profile(scene, spec)
    _refuse_window(scene, name, spec, profile)
    _refuse_holes(scene, name, spec, profile)
    return RVSet(
        name=name,
        ring=spec.pin_ring,
        disc=spec.disc,
        crankshaft=spec.crankshaft,
        carrier=spec.carrier,
        profile=profile,
        discs=spec.discs,
        cranks=spec.cranks,
        crank_circle=carrier.radius.internal,
        window=spec.window,
        first=_first_stage(scene, name, spec, carrier.radius.internal),
        width=None if disc.width is None else disc.width.internal,
        plays=any(own.of in (spec.disc, spec.carrier) for own in scene.of(BearingPlaySpec).values()),
        by_formula=any(_by_formula(name, own) for own in scene.published.values()),
    )


def _by_formula(name: str, column: PublishedColumn) -> bool:
    """True if a published column has a stage by the paper's formula."""
    own = column.cycloid_stages.get(name) if isinstance(column, PublishedCycloidStages) else None
    return own is not None and own.by_formula is not None


def _profile(scene: Scene, spec: RVReducerSpec) -> DiscProfile:
    """The discs' profile.

    Raises:
        SceneError: it cannot be made, or does not run among the pins; at the field of the part that decides.
    """
    ring, disc, crank, _ = spec.parts_among(scene.parts)
    if (fault := lobes_fault(disc.lobes, ring.pins)) is not None:
        raise scene.refuse(("parts", spec.disc, fault.field), fault.words)
    profile = DiscProfile(
        ring.pins,
        ring.radius.internal,
        ring.pin_radius.internal,
        crank.eccentricity.internal,
        Modification(disc.shift.internal, disc.offset.internal, disc.rotation.internal),
    )
    places: dict[str, KeyPath] = {
        "pins": (spec.pin_ring, "pins"),
        "pin_circle_radius": (spec.pin_ring, "radius"),
        "pin_radius": (spec.pin_ring, "pin_radius"),
        "eccentricity": (spec.crankshaft, "eccentricity"),
    }
    for fault in faults(profile):
        raise scene.refuse(("parts", *places.get(fault.field, (spec.disc, fault.field))), fault.words)
    return profile


def _refuse_window(scene: Scene, name: str, spec: RVReducerSpec, profile: DiscProfile) -> None:
    """Refuse a window that leaves positions without a working pin."""
    most = largest_window(profile)
    if spec.window >= most:
        words = f"expected less than {math.floor(most * 1e4) / 1e4:.4f}, from where positions have no working pin"
        raise scene.refuse(("moves", name, "window"), f"{words} among {profile.pins} pins, got {spec.window:g}")


def _refuse_holes(scene: Scene, name: str, spec: RVReducerSpec, profile: DiscProfile) -> None:
    """Refuse crankshafts that do not go through the discs, and holes too small for them or that leave no walls."""
    _, disc, _, carrier = spec.parts_among(scene.parts)
    if (fault := circle_fault(profile, spec.cranks, carrier.radius.internal)) is not None:
        place: KeyPath = ("parts", spec.carrier, "radius") if fault.field == "radius" else ("moves", name, fault.field)
        raise scene.refuse(place, fault.words)
    if disc.hole is None:
        return
    for fault in hole_faults(profile, DiscHoles(spec.cranks, carrier.radius.internal, disc.hole.internal)):
        raise scene.refuse(("parts", spec.disc, "hole"), fault.words)


def _first_stage(scene: Scene, name: str, spec: RVReducerSpec, distance: float) -> FirstStage | None:
    """Sun and planets.

    Raises:
        SceneError: they do not mesh at the radius of the circle of crank axes, or planets touch each other.
    """
    if spec.sun is None or spec.planet is None:
        return None
    if spec.sun == spec.planet:
        raise scene.refuse(("moves", name, "planet"), f"expected another gear than the sun, got {spec.planet!r} twice")
    sun, planet = (cylindrical_gear(scene, gear) for gear in (spec.sun, spec.planet))
    assert isinstance(sun, SpurGear)
    assert isinstance(planet, SpurGear)
    if (found := unlike(scene, spec.sun, spec.planet)) is not None:
        field, own, mate = found
        words = f"expected {own} as of {spec.sun!r}, its mate, got {mate}"
        raise scene.refuse(("parts", spec.planet, field), words)
    try:
        pair = SpurPair(sun, planet, distance)
        pair.refuse_interference()
    except GeometryError as error:
        right = sun.module * (sun.teeth + planet.teeth) / 2
        raise scene.refuse(
            ("parts", spec.carrier, "radius"),
            f"{spec.sun} and {spec.planet} do not mesh there: {error}; their reference circles touch at {right:.4f} mm",
        ) from None
    apart = 2 * distance * math.sin(math.pi / spec.cranks)
    if apart <= 2 * planet.tip_radius:
        most = math.floor(math.pi / math.asin(min(planet.tip_radius / distance, 1.0)))
        words = f"expected at most {most} planets of {2 * planet.tip_radius:.4f} mm beside each other on this circle"
        raise scene.refuse(("moves", name, "cranks"), f"{words}, got {spec.cranks}, which are {apart:.4f} mm apart")
    return FirstStage(spec.sun, spec.planet, pair)


def _implausible(scene: Scene, rv_set: RVSet) -> tuple[str, ...]:
    """Warnings of the gears before the cycloid stage.

    Raises:
        SceneError: a tooth is thinned until nothing is left of its tip.
    """
    if rv_set.first is None:
        return ()
    gears = {name: rv_set.first.gear(name) for name in (rv_set.first.sun, rv_set.first.planet)}
    return tuple(implausible_teeth(scene, gears))


REDUCERS: Final = ReducerKind(
    "an RV reducer",
    RVReducerSpec,
    CycloidMeasureSpec,
    (PinRingSpec, CycloidDiscSpec, CrankshaftSpec, CrankCarrierSpec),
    _reducer_of,
    _implausible,
    acts_of,
    draw_of,
)


def rv_system(scene: Scene) -> RVSystem:
    """System of an RV reducer, from its scene.

    Raises:
        SceneError: kinds that do not act on it, or a reducer that cannot be built, with its numbers.
    """
    own = REDUCERS.alone(scene)
    contributors, acts = REDUCERS.contributors(scene, own)
    disc = scene.of(CycloidDiscSpec)[own.disc]
    width, hole = (None if size is None else size.internal for size in (disc.width, disc.hole))
    steps = scene.options(GearStudyOptions).profile_steps
    system = PlayingSystem if own.plays else RVSystem
    measures = tuple(_measure(scene, name, spec, own.output) for name, spec in scene.measures.items())
    of_gears = _implausible(scene, own)
    return system(scene.scene, contributors, measures, own, acts, width, hole, steps, implausible=of_gears)


def _measure(scene: Scene, name: str, spec: Any, output: str) -> ReducerMeasure:
    if not isinstance(spec, CycloidMeasureSpec):
        words = "cycloid_transmission_error, cycloid_lost_motion or cycloid_pins_near_contact"
        raise scene.refuse(("measures", name, "kind"), f"expected of an RV reducer {words}, got {spec.kind}")
    if not isinstance(spec, CycloidTransmissionErrorSpec | CycloidPinsNearContactSpec):
        return reducer_measure(name, spec, "lost motion", output)
    deflection = spec.deflection.internal if isinstance(spec, CycloidPinsNearContactSpec) else None
    return reducer_measure(name, spec, spec.flank, output, spec.taken, deflection)
