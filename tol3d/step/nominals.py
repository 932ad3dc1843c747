"""Nominal dimensions against the surfaces that they are of: a wrong unit or a wrong face shows at once."""

from collections.abc import Iterator, Mapping
from typing import Final

from tol3d.step.dimension import Dimension
from tol3d.step.outline import Remark, StepText
from tol3d.step.surfaces import SAME_PLACE, Surface, aligned, dot, merged

NOMINAL_XTOL: Final = 0.01  # mm; dimensions are rounded for the drawing, such as 0.1875 in as 0.188
PER_RADIUS: Final = {"diameter": 2.0, "radius": 1.0, "spherical diameter": 2.0, "spherical radius": 1.0}


def measured(dimension: Dimension, surfaces: Mapping[int, Surface]) -> float | None:
    """The size or the distance that the surfaces have [mm]; None if they are not of one size, or not parallel."""
    sides = [merged([surfaces[face] for face in each.faces if face in surfaces]) for each in dimension.features]
    if dimension.kind in PER_RADIUS and sides[0]:
        radii = [each.radius for each in sides[0] if each.radius and each.kind != "cone"]
        same = bool(radii) and max(radii) - min(radii) < SAME_PLACE
        return PER_RADIUS[dimension.kind] * radii[0] if same else None
    if dimension.kind != "linear distance" or [len(each) for each in sides] != [1, 1]:
        return None
    first, second = sides[0][0], sides[1][0]
    if first.kind != "plane" or second.kind != "plane" or not aligned(first.direction, second.direction):
        return None
    return abs(dot(tuple(b - a for a, b in zip(first.at, second.at, strict=True)), first.direction))


def disagreements(text: StepText, surfaces: Mapping[int, Surface]) -> Iterator[Remark]:
    """A remark on each dimension whose nominal is not that of its faces."""
    for each in text.dimensions:
        found = measured(each, surfaces)
        if found is not None and each.nominal is not None and abs(found - each.nominal.value) > NOMINAL_XTOL:
            what = f"dimension {each.name}".strip()
            yield Remark(each.id, what, f"is {each} where its faces have {found:.4f} mm")
