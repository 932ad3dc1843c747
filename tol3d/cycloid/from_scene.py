"""From a scene to an RV reducer, its deviations and what is read of it."""

from typing import Any

from tol3d.cycloid.draws import NOT_NEGATIVE, acts_of, draw_of
from tol3d.cycloid.grammar.measures.cycloid_lost_motion import CycloidLostMotionSpec
from tol3d.cycloid.grammar.measures.cycloid_measure import CycloidMeasureSpec
from tol3d.cycloid.grammar.measures.cycloid_pins_near_contact import CycloidPinsNearContactSpec
from tol3d.cycloid.grammar.measures.cycloid_transmission_error import CycloidTransmissionErrorSpec
from tol3d.cycloid.grammar.parts.cycloid_disc import CycloidDiscSpec
from tol3d.cycloid.measure import Reading, RVMeasure
from tol3d.cycloid.refusals import implausible_stage, rv_set
from tol3d.cycloid.rv_set import RVSet
from tol3d.cycloid.system import PlayingSystem, RVSystem
from tol3d.gearing.grammar.study import GearStudyOptions
from tol3d.scene import Scene
from tol3d.scene.direction import At
from tol3d.system.plain import UNITS, PlainContributor, stated_of
from tol3d.system.pooled_statistic import HalfSpan
from tol3d.system.positions import AT_RANDOM, Positions, Take
from tol3d.system.spectrum import Spectrum


def rv_system(scene: Scene) -> RVSystem:
    """What a scene of an RV reducer means.

    Raises:
        SceneError: kinds that do not act on it, or a reducer that nobody can build, with its numbers.
    """
    own = rv_set(scene)
    acts = {name: acts_of(scene, own, name, spec) for name, spec in scene.tolerances.items()}
    contributors = [
        PlainContributor(
            name,
            spec.kind,
            draw_of(own, acts[name], spec.distribution.resolve(scene.files)),
            *UNITS[spec.dimensions[0]],
            spec.description,
            least=0.0 if acts[name].effect in NOT_NEGATIVE else None,
        )
        for name, spec in scene.distributed.items()
    ]
    measures = {name: _measure(scene, own, name, spec) for name, spec in scene.measures.items()}
    disc = scene.parts[own.disc]
    assert isinstance(disc, CycloidDiscSpec)
    width, hole = (None if size is None else size.internal for size in (disc.width, disc.hole))
    steps = scene.options(GearStudyOptions).profile_steps
    system = PlayingSystem if own.plays else RVSystem
    found = implausible_stage(scene, own)
    stated = tuple(contributors), tuple(measures.values())
    return system(scene.scene, *stated, own, acts, measures, width, hole, steps, found)


def _measure(scene: Scene, own: RVSet, name: str, spec: Any) -> RVMeasure:
    if not isinstance(spec, CycloidMeasureSpec):
        words = "cycloid_transmission_error, cycloid_lost_motion or cycloid_pins_near_contact"
        raise scene.refuse(("measures", name, "kind"), f"expected of an RV reducer {words}, got {spec.kind}")
    if isinstance(spec, CycloidLostMotionSpec):
        return _read(name, spec, "lost motion", _one(spec.over), "value")
    assert isinstance(spec, CycloidTransmissionErrorSpec | CycloidPinsNearContactSpec)
    one = spec.over != "turn"
    # over a turn it bends where another pin takes over
    positions = _one(spec.over) if one else Positions("turn", 1, spec.positions, jumps=True)
    if isinstance(spec, CycloidPinsNearContactSpec):
        return _read(name, spec, spec.flank, positions, spec.taken, deflection=spec.deflection.internal)
    if one:
        return _read(name, spec, spec.flank, positions, "value")
    spectrum = Spectrum.over(positions, (spec.order or 1,)) if spec.take == "harmonic" else None
    if spec.taken == "curve":
        spectrum = Spectrum.over(positions, spec.orders) if spec.orders else None
    return _read(name, spec, spec.flank, positions, spec.taken, spectrum)


def _one(over: Any) -> Positions:
    """One position a trial."""
    return Positions("at", 1, 1, over.at.internal) if isinstance(over, At) else AT_RANDOM


def _read(
    name: str,
    spec: CycloidMeasureSpec,
    reading: Reading,
    positions: Positions,
    take: Take,
    spectrum: Spectrum | None = None,
    deflection: float | None = None,
) -> RVMeasure:
    return RVMeasure(
        *stated_of(name, spec),
        worse="high" if deflection is None else "low",
        adds_up=False,
        pooled_statistics=(HalfSpan(),) if (take, deflection) == ("value", None) and reading != "lost motion" else (),
        positions=positions,
        take=take,
        spectrum=spectrum,
        reading=reading,
        deflection=deflection,
    )
