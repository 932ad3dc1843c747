"""Numbers that a scene states beside a face, checked against it: a drawing and its solid must say the same."""

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.grammar.features.feature_spec import FeatureSpec, Found
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.units import Quantity

AGREED: Final = 1e-4
"""mm: a number that differs by more is another one; drawings are written to a thousandth of a millimetre."""
AGREED_SLOPE: Final = 1e-6
"""Sine between directions that are the same."""


def disagreements(spec: FeatureSpec, found: Mapping[str, Found]) -> Iterator[tuple[str, str]]:
    """Fields that a scene states otherwise than the face has them, each with a sentence.

    Args:
        spec: the feature as the scene has it.
        found: its fields as the face has them.
    """
    for field, own in found.items():
        stated = getattr(spec, field)
        if stated is not None and field in spec.model_fields_set and not _agree(stated, own):
            yield field, f"expected what the face of the solid has, {_shown(own)}, got {_shown(stated)}"


def _agree(stated: Found, found: Found) -> bool:
    if isinstance(stated, bool):
        return stated is found
    if isinstance(stated, Quantity):
        assert isinstance(found, Quantity)
        return abs(stated.internal - found.internal) <= AGREED
    assert isinstance(found, tuple)
    if isinstance(stated[0], Quantity):
        return float(np.linalg.norm(_plain(stated) - _plain(found))) <= AGREED
    return float(np.linalg.norm(_unit(stated) - _unit(found))) <= AGREED_SLOPE


def _plain(values: tuple[Quantity | float, ...]) -> NDArray[np.float64]:
    """Lengths in mm."""
    return np.array([own.internal if isinstance(own, Quantity) else own for own in values])


def _unit(values: tuple[Quantity | float, ...]) -> NDArray[np.float64]:
    x, y, z = _plain(values).tolist()
    return unit((x, y, z))


def _shown(value: Found) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Quantity):
        return f"{round(value.internal, 6):.9g} mm"
    return f"[{', '.join(_shown(own) if isinstance(own, Quantity) else f'{round(own, 9):.9g}' for own in value)}]"
