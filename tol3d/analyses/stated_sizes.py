"""Limits of a measured size itself, such as `23.349 / 23.386 mm` of a span, in place of those of its deviation."""

from collections.abc import Iterable, Mapping
from typing import Final

import numpy as np

from tol3d.errors import InputError
from tol3d.scene import Scene
from tol3d.scene.bases import ToleranceSpec
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.base import DeviationLaw
from tol3d.statistics.distributions.derived import Derived
from tol3d.statistics.distributions.drawn import typed_sizes
from tol3d.statistics.distributions.size_limits import UM_PER_MM, resized, size_limits
from tol3d.statistics.distributions.unsized import SIZE
from tol3d.study.trials.simulation import Line

NO_NOMINALS: Final[Mapping[str, float]] = {}
DIGITS: Final = 6  # of sizes in fields [mm]: nanometres


def nominals_of(scene: Scene, lines: Iterable[Line]) -> Mapping[str, float]:
    """Nominal sizes [mm] by the line of the scene that tolerates a measured size, where it is one."""
    found = dict[str, float]()
    for line in lines:
        sizes = {
            size
            for entry in line.entries
            if isinstance(spec := scene.tolerances[entry], ToleranceSpec)
            and (size := spec.size(SIZE, scene.parts, scene.moves)) is not None
        }
        if len(sizes) == 1:
            found[line.name] = sizes.pop()
    return found


def typed_of(scene: Scene, lines: Iterable[Line]) -> Mapping[str, str]:
    """Limits of sizes as the scene has them, by line."""
    entries = {line.name: scene.tolerances[line.entries[0]] for line in lines if line.entries}
    texts = {
        name: typed_sizes(spec.distribution.drawn) for name, spec in entries.items() if isinstance(spec, ToleranceSpec)
    }
    return {name: text for name, text in texts.items() if text is not None}


def deviations_of(law: DeviationLaw, text: str, nominal: float | None) -> tuple[float, float]:
    """Lower and upper limit [mm] of a contributor whose measured size has the limits of a text.

    Args:
        law: of the contributor, which may be another size than the measured one.
        text: the limits.
        nominal: of what is measured [mm]; None where no size is.

    Raises:
        InputError: no size is measured, or both limits are one.
    """
    if nominal is None:
        words = "limits of a deviation, such as -0.03/-0.06 mm, for no size such as a span is measured here"
        raise InputError(f"expected {words}, got {text!r}")
    ends = np.array(size_limits(text, nominal)) / UM_PER_MM
    low, high = sorted((law.scale.deviation(ends) if isinstance(law, Derived) else ends).tolist())
    return low, high


def sizes_of_law(law: DeviationLaw, text: str, nominal: float) -> str | None:
    """Limits of a contributor's law as those of the measured size, in the form of a text; None of a law without any.

    Args:
        law: see `deviations_of`.
        text: limits of that form.
        nominal: of what is measured [mm].
    """
    measured = law.measured if isinstance(law, Derived) else law
    limits = measured.limits if isinstance(measured, Distribution) else None
    return None if limits is None else resized(text, *(round(nominal + own, DIGITS) for own in limits))
