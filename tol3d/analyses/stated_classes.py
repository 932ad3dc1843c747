"""Tolerance classes of ISO 286, such as H7, in place of limits: nominal sizes at which they are read."""

from collections.abc import Iterable, Mapping
from typing import Final

from tol3d.errors import InputError
from tol3d.scene import Scene
from tol3d.scene.bases import ToleranceSpec
from tol3d.statistics.standards import iso_286
from tol3d.study.trials.simulation import Line
from tol3d.units import Quantity

NO_SIZES: Final[Mapping[str, Quantity]] = {}


def sizes_of(scene: Scene, lines: Iterable[Line]) -> Mapping[str, Quantity]:
    """Nominal sizes by the line of the scene that tolerates them, where the scene states one size."""
    found = dict[str, Quantity]()
    for line in lines:
        sizes = {
            size
            for entry in line.entries
            if isinstance(spec := scene.tolerances[entry], ToleranceSpec)
            and (size := spec.nominal_size(scene.parts, scene.moves)) is not None
        }
        if len(sizes) == 1:
            found[line.name] = sizes.pop()
    return found


def classes_of(scene: Scene, lines: Iterable[Line]) -> Mapping[str, str]:
    """Tolerance classes by the line of the scene that states one."""
    entries = {line.name: scene.tolerances[line.entries[0]] for line in lines if line.entries}
    drawn = {name: spec.distribution.drawn for name, spec in entries.items() if isinstance(spec, ToleranceSpec)}
    return {name: own["fit"] for name, own in drawn.items() if isinstance(own, dict) and "fit" in own}


def is_class(text: str) -> bool:
    """True of text that names a tolerance class, right or wrong.

    >>> is_class("js7"), is_class("7 um")
    (True, False)
    """
    return bool(iso_286.CLASS.fullmatch(text.strip()))


def class_limits(tolerance_class: str, size: Quantity | None) -> tuple[float, float]:
    """Lower and upper limit of a class [mm].

    Raises:
        InputError: no such class of the size, or no size.
    """
    if size is None:
        words = "limits in numbers, for the scene states no nominal size at which a class could be read"
        raise InputError(f"expected {words}, got {tolerance_class!r}")
    lower, upper = iso_286.limits(tolerance_class, size.internal)
    return Quantity(float(lower), "um").internal, Quantity(float(upper), "um").internal


def class_words(tolerance_class: str, size: Quantity) -> str:
    """A class with its numbers.

    >>> class_words("js7", Quantity(60.2, "mm")), class_words("H7", Quantity(32.0, "mm"))
    ('js7: ±15 µm', 'H7: +25/0 µm')
    """
    lower, upper = iso_286.limits(tolerance_class, size.internal)
    if lower == -upper:
        return f"{tolerance_class}: ±{upper:g} µm"
    return f"{tolerance_class}: {_signed(upper)}/{_signed(lower)} µm"


def _signed(number: float) -> str:
    return f"{number:+g}" if number else "0"


def neighbours(tolerance_class: str, size: Quantity) -> tuple[str, ...]:
    """A class, and those a grade finer and coarser that ISO 286 has of the size.

    >>> neighbours("js7", Quantity(60.2, "mm"))
    ('js6', 'js7', 'js8')
    """
    match = iso_286.CLASS.fullmatch(tolerance_class)
    if match is None:
        return ()
    letters, grade = match[1], int(match[2])
    every = (f"{letters}{own}" for own in range(max(grade - 1, 1), grade + 2))
    return tuple(own for own in every if _is_there(own, size))


def _is_there(tolerance_class: str, size: Quantity) -> bool:
    try:
        iso_286.limits(tolerance_class, size.internal)
    except InputError:
        return False
    return True
