"""Part of a feature's zones used by its form.

An axis' zone contains its bend, so it is reduced by the straightness of the axis or of the lines of its surface, or by
the cylindricity; roundness moves no axis. A run-out is read on the surface: it is reduced by the roundness at one
section, by the cylindricity over the whole length.
"""

import math
from collections.abc import Callable, Sequence

from tol3d.assembly.grammar.tolerances.location import (
    CylindricitySpec,
    FlatnessSpec,
    FormSpec,
    RoundnessSpec,
    StraightnessSpec,
)
from tol3d.assembly.model.feature import Shape

Forms = Sequence[FormSpec]


def whole_form(spec: FormSpec, shape: Shape, room: float = math.inf) -> float:
    """Width [mm] of a form over the whole feature; of one per unit the bow of a feature bent evenly.

    Every piece of a length l within f lets a length L bow by f (L/l)^2: sagittas grow with the square of the chord. An
    area goes by the longer of its two ratios, a round one by the longest chord of the face over its diameter.
    A bow that no zone beside has room for is none: of such a form that of one piece is left.

    Args:
        spec: of the form.
        shape: of the feature.
        room: width of the zone that holds it too [mm].
    """
    bow = spec.zone.size * max((length / unit for length, unit in units(spec, shape)), default=1.0) ** 2
    return bow if bow < room else spec.zone.size


def units(spec: FormSpec, shape: Shape) -> Sequence[tuple[float, float]]:
    """Lengths of a feature, and the unit of each for which a form is stated [mm]; none where it is of the whole."""
    if isinstance(spec, FlatnessSpec) and spec.per is not None and shape.surface == "plane":
        if len(spec.per) == 1:
            return ((shape.longest, spec.per[0].internal),)
        return tuple((2.0 * reach, own.internal) for reach, own in zip(shape.reach, spec.per, strict=True))
    if isinstance(spec, StraightnessSpec) and spec.per is not None:
        return ((_length(spec, shape), spec.per.internal),)
    return ()


def _length(spec: StraightnessSpec, shape: Shape) -> float:
    """Length of an axis, or of the line of a plane through its middle [mm]; `lines` of a plane are in its frame."""
    return 2.0 * shape.reach[-1 if spec.lines == "y" else 0] if shape.reach else 0.0


def of_location(forms: Forms, shape: Shape, room: float) -> float:
    """Part of the zone of an axis, a median plane or a face used by form [mm]."""
    flat = _least(forms, shape, room, lambda own: isinstance(own, FlatnessSpec))
    return flat or _least(forms, shape, room, lambda own: isinstance(own, StraightnessSpec | CylindricitySpec))


def of_section(forms: Forms, shape: Shape, room: float) -> float:
    """Part of a run-out at one section used by form [mm]."""
    return _least(forms, shape, room, lambda own: isinstance(own, RoundnessSpec | CylindricitySpec))


def of_total_run_out(forms: Forms, shape: Shape, room: float) -> float:
    """Part of a run-out over the whole length used by form [mm]: the cylindricity, or its components."""
    whole = _least(forms, shape, room, lambda own: isinstance(own, CylindricitySpec))
    parts = (RoundnessSpec, StraightnessSpec)
    return whole or sum(_least(forms, shape, room, lambda own, kind=kind: isinstance(own, kind)) for kind in parts)


def _least(forms: Forms, shape: Shape, room: float, counts: Callable[..., bool]) -> float:
    return min((whole_form(form, shape, room) for form in forms if counts(form)), default=0.0)
