"""What must hold of limits and differences: lengths with lengths, angles with angles."""

from collections.abc import Iterator

from tol3d.assembly.grammar.measures import AssemblyMeasureSpec, DifferenceSpec
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.units import Dimension, expectation

Problem = tuple[KeyPath, str]


def dimension_of(scene: Scene, name: str) -> Dimension:
    """Whether a measure is a length or an angle; a difference is what its first measure is."""
    spec = scene.measures[name]
    return dimension_of(scene, spec.of) if isinstance(spec, DifferenceSpec) else spec.dimension


def mixed_dimensions(scene: Scene) -> Iterator[Problem]:
    """Limits of another dimension than their measure's, and differences of lengths and angles."""
    for name, spec in scene.measures.items():
        if not isinstance(spec, AssemblyMeasureSpec):
            continue
        own = dimension_of(scene, name)
        if isinstance(spec, DifferenceSpec) and (other := dimension_of(scene, spec.minus)) != own:
            yield (
                ("measures", name, "minus"),
                f"expected {_an(own)}, as {spec.of!r} is, got {spec.minus!r}, {_an(other)}",
            )
        for field in ("lower_limit", "upper_limit"):
            limit = getattr(spec, field)
            if limit is not None and limit.dimension != own:
                yield ("measures", name, field), f"expected {expectation(own)}, got {str(limit)!r}"


def _an(dimension: Dimension) -> str:
    return "an angle" if dimension == "angle" else "a length"
