"""What pairs of two external gears have in common: their teeth face each other across the pitch point."""

from typing import Any

from tol3d.gearing.engines.exact.foot import handed, opening, widest
from tol3d.numerics.compiled import variant


def external(kind: type) -> None:
    """Register the gears of a kind as external; see foot.py."""
    variant(opening, kind)(external_opening)
    variant(handed, kind)(external_side)
    variant(widest, kind)(external_radius)


def external_opening(driven: Any) -> float:
    """In the sense in which the driver leaves its mate."""
    return 1.0


def external_side(driver: Any, sigma: float) -> float:
    """Flanks of one side meet."""
    return sigma


def external_radius(driver: Any, driven: Any, tangent: float) -> float:
    """r_1 r_2/(r_1 + r_2), where r_1 + r_2 is the tangent, is at most a quarter of it."""
    return 0.25 * tangent
