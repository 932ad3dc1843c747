"""By how much a build's deviations may be magnified: its teeth still seat, and look like teeth."""

import math
from collections.abc import Callable, Sequence
from typing import Final

from tol3d.gearing.engines import OK
from tol3d.gearing.placed import SeatedMesh
from tol3d.report.number import measured_text

OPEN_SHARE: Final = 1 / 8  # of the base pitch; a magnified gap stays this small, a third of a tooth
MAGNIFY_STEPS: Final = 16  # halvings of the range of magnifications; 1/65536 of it
MAGNIFY_DIGITS: Final = 3  # of the magnification in use, rounded down

Meshes = Sequence[SeatedMesh]


def allowed_factor(seated: Callable[[float], Meshes], wanted: float) -> tuple[float, str]:
    """The largest factor up to the wanted one with which a build can be shown, and what the user should know of it.

    Args:
        seated: the meshes of the build with its deviations multiplied by a factor.
        wanted: the factor that was asked for, at least 0.
    """
    plain, meshes = seated(1.0), seated(wanted)
    widest = {mesh.mesh.name: max(OPEN_SHARE * mesh.driver.gear.base_pitch, mesh.gap_value) for mesh in plain}

    def allowed(meshes: Meshes) -> bool:
        return all(_in_its_space(mesh, widest[mesh.mesh.name]) for mesh in meshes)

    if wanted < 1.0 or allowed(meshes):
        return wanted, f"deviations magnified {wanted:g} times: {_gaps_text(plain, meshes)}"
    if not allowed(plain):
        return 1.0, "not magnified: the teeth do not run free in this build"
    low, high = 1.0, wanted
    for _ in range(MAGNIFY_STEPS):
        middle = (low + high) / 2
        low, high = (middle, high) if allowed(seated(middle)) else (low, middle)
    used = max(1.0, _rounded_down(low))
    return (
        used,
        f"deviations magnified {used:g} times, not {wanted:g}: beyond that the gap would leave the tooth space "
        f"(allowed are 0 to {' or '.join(f'{1000 * width:.0f}' for width in widest.values())} µm) or a tip would fold; "
        f"{_gaps_text(plain, seated(used))}",
    )


def _in_its_space(mesh: SeatedMesh, widest: float) -> bool:
    free = mesh.status == OK and mesh.gap_value <= widest and mesh.tip_clearance > 0.0
    return free and mesh.driver.unfolded and mesh.driven.unfolded


def _gaps_text(plain: Meshes, meshes: Meshes) -> str:
    texts = [
        f"{mesh.mesh.name} has a normal backlash of {measured_text(1000 * mesh.gap_value, 'um')} instead of "
        f"{measured_text(1000 * before.gap_value, 'um')}"
        for before, mesh in zip(plain, meshes, strict=True)
    ]
    return ", ".join(texts)


def _rounded_down(value: float) -> float:
    step = 10.0 ** (math.floor(math.log10(value)) - MAGNIFY_DIGITS + 1)
    return round(math.floor(value / step) * step, 10)
