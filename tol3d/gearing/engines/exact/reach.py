"""Distance of gears from their nominal places up to which no other teeth than the candidates can touch."""

import math

from tol3d.gearing.engines.exact.flank_contact import MeshBuild
from tol3d.gearing.engines.exact.foot import opening, widest
from tol3d.numerics.compiled import part


@part
def within_reach(build: MeshBuild, driver_scale: float, driven_scale: float) -> bool:
    """True if the candidate teeth are still those of the nominal pose.

    Gears that grow with their housing are the nominal ones at another scale; gears that grow apart are gears at
    another distance of their axes. Where base pitches differ by d a tip touches sqrt(2 rho d) before the path of
    contact begins, rho the relative radius of curvature.
    """
    pair, rest, p = build.pair, build.nominal, build.pose
    square = (p.xx - rest.xx) ** 2 + (p.xy - rest.xy) ** 2 + (p.xz - rest.xz) ** 2
    square += (p.yx - rest.yx) ** 2 + (p.yy - rest.yy) ** 2 + (p.yz - rest.yz) ** 2
    square += (p.zx - rest.zx) ** 2 + (p.zy - rest.zy) ** 2 + (p.zz - rest.zz) ** 2
    mean = 0.5 * (driver_scale + driven_scale)
    dx, dy, dz = p.x - mean * rest.x, p.y - mean * rest.y, pair.along * (p.z - rest.z)
    moved = math.sqrt(dx * dx + dy * dy + dz * dz) + math.sqrt(square / 2.0) * pair.lever
    moved += math.sqrt(build.driver_x * build.driver_x + build.driver_y * build.driver_y)
    moved += math.sqrt(build.driven_x * build.driven_x + build.driven_y * build.driven_y)
    if pair.along == 0.0 and driver_scale != driven_scale:
        apart, bases = math.hypot(rest.x, rest.y), abs(build.driver.base + opening(build.driven) * build.driven.base)
        tangent = math.sqrt(max(apart * apart - bases * bases, 0.0))
        pitches = abs(build.driven.base * pair.driven_pitch - build.driver.base * pair.driver_pitch)
        rho = widest(build.driver, build.driven, tangent)
        by_growth = 0.5 * abs(driver_scale - driven_scale) * apart
        by_growth *= (build.driver.base + build.driven.base) / bases
        moved += by_growth + math.sqrt(2.0 * rho * pitches) * tangent / apart
    return moved <= pair.reach
