"""Planetary sets as summary.json shows them: what the friction of their teeth takes."""

from collections.abc import Mapping
from typing import Final

from tol3d.planetary.deviated import Deviated
from tol3d.planetary.displaced_ends import displaced_ends
from tol3d.planetary.efficiency import SetEfficiency, formula_efficiency, mesh_efficiencies, set_efficiency
from tol3d.planetary.hysteresis import ARCMIN, crossing, hysteresis
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.spring_curve import LeafSpring, breakaway
from tol3d.planetary.summary_types import EfficiencySummary, PlanetarySetSummary, SpringSummary, TorqueCurve
from tol3d.runs.summary.values import made
from tol3d.units import RAD_PER_ARCMIN

BEYOND: Final = 1.4  # times the torque at which the region of low stiffness is crossed
STEPS: Final = 60  # of the curve, from none to the peak


def set_sections(
    own: PlanetarySet, friction: float | None, spring: SpringSummary | None = None
) -> Mapping[str, PlanetarySetSummary]:
    """The set by its name; nothing where neither friction of the teeth nor a spring of the carrier is given.

    Args:
        own: the set.
        friction: coefficient of friction of the teeth.
        spring: what that of a flexible carrier holds.
    """
    if friction is None and spring is None:
        return {}
    formula = None if friction is None else formula_efficiency(own, friction)
    meshes = {} if friction is None else mesh_efficiencies(own, friction, "equal shares")
    found = made(
        PlanetarySetSummary,
        input=own.input,
        output=own.output,
        held=own.held,
        ratio=float(own.ratio),
        friction=friction,
        meshes_percent={name: 100 * each for name, each in meshes.items()} or None,
        efficiency=None if friction is None else _percents(set_efficiency(own, friction)),
        efficiency_by_formula=None if formula is None else _percents(formula),
        spring=spring,
    )
    return {own.name: found}


def spring_summary(own: PlanetarySet, mean: Deviated, spring: LeafSpring) -> SpringSummary:
    """Torques at both shafts, and the curve of the output; of one trial with all deviations at their means."""
    torques, stiffness = dict[str, float](), dict[str, float]()
    for shaft in (own.input, own.output):
        torques[shaft] = min(abs(torque) for torque in breakaway(own, mean, shaft, spring))
        per_force = torques[shaft] / (spring.force + spring.friction)  # mm/rad, of the planets' displacement
        stiffness[shaft] = spring.stiffness * per_force**2 * RAD_PER_ARCMIN
    peak = BEYOND * crossing(displaced_ends(own, mean, own.output), spring)
    curve = hysteresis(own, mean, own.output, spring, peak, STEPS)
    return made(
        SpringSummary,
        force_n=spring.force,
        stiffness_n_per_mm=spring.stiffness,
        friction_n=spring.friction,
        breakaway_n_mm=torques,
        low_stiffness_n_mm_per_arcmin=stiffness,
        curve=made(
            TorqueCurve,
            shaft=curve.shaft,
            torque_n_mm=[float(torque) for torque in curve.torques],
            turn_arcmin=curve.minutes,
            breakaway_n_mm=list(curve.breakaway),
            rigid_arcmin=None if curve.rigid is None else [end / ARCMIN for end in curve.rigid],
        ),
    )


def _percents(found: SetEfficiency) -> EfficiencySummary:
    return made(EfficiencySummary, forward_percent=100 * found.forward, backward_percent=100 * found.backward)
