"""Tolerance classes in place of limits, H7 of ISO 286 and cd25 of DIN 3967: nominal sizes at which they are read."""

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Final

from tol3d.errors import InputError
from tol3d.scene import Scene
from tol3d.scene.bases import ToleranceSpec
from tol3d.statistics.distributions.drawn import is_field, is_series
from tol3d.statistics.distributions.unsized import STANDARDS
from tol3d.statistics.standards import din_3967, iso_286
from tol3d.statistics.standards.iso_286 import Limits
from tol3d.study.trials.simulation import Line
from tol3d.units import Quantity

Sizes = Mapping[str, Quantity]
"""Nominal sizes of a tolerance by the key of the classes that are read at them, see LIMITS."""
NO_SIZES: Final[Mapping[str, Sizes]] = {}
FIT: Final = "fit"
SERIES: Final = "din_3967"
LIMITS: Final[Mapping[str, Callable[[str, float], Limits]]] = {FIT: iso_286.limits, SERIES: din_3967.thickness}
WORDS: Final[Mapping[str, Callable[[str], bool]]] = {SERIES: is_series, "din_3964": is_field}
WRITTEN: Final = re.compile(rf"\{{\s*(?P<key>{'|'.join(WORDS)})\s*:\s*(?P<word>[^{{}}]*?)\s*\}}")
FITTED: Final = re.compile(
    r"\{(?=[^{}]*\bfit\s*:\s*(?P<word>[^{},]*?)\s*[,}])(?=[^{}]*\bof\s*:\s*(?P<size>[^{},]*?)\s*[,}])[^{},]*,[^{},]*\}"
)
"""A class of ISO 286 with its own nominal size."""


def sizes_of(scene: Scene, lines: Iterable[Line]) -> Mapping[str, Sizes]:
    """Nominal sizes by the line of the scene that tolerates them, where the scene states one size."""
    found = dict[str, Sizes]()
    for line in lines:
        entries = [spec for entry in line.entries if isinstance(spec := scene.tolerances[entry], ToleranceSpec)]
        fits = {size for spec in entries if (size := spec.nominal_size(scene.parts, scene.moves)) is not None}
        diameters = {own for spec in entries if (own := spec.size(SERIES, scene.parts, scene.moves)) is not None}
        sizes = dict[str, Quantity]()
        if len(fits) == 1:
            sizes[FIT] = fits.pop()
        if len(diameters) == 1:
            sizes[SERIES] = Quantity(diameters.pop(), "mm")
        if sizes:
            found[line.name] = sizes
    return found


def classes_of(scene: Scene, lines: Iterable[Line]) -> Mapping[str, str]:
    """Tolerance classes by the line of the scene that states one."""
    entries = {line.name: scene.tolerances[line.entries[0]] for line in lines if line.entries}
    drawn = {name: spec.distribution.drawn for name, spec in entries.items() if isinstance(spec, ToleranceSpec)}
    return {
        name: own[key] for name, own in drawn.items() if isinstance(own, dict) for key in (FIT, *WORDS) if key in own
    }


def class_of(text: str) -> str:
    """The class that a text names, right or wrong, also in the words of a scene; "" of other text.

    One that states its nominal size keeps that.

    >>> class_of("js7"), class_of("{din_3967: 25 cd}"), class_of("7 um"), class_of("{ of: 60 mm, fit: H7 }")
    ('js7', '25 cd', '', '{fit: H7, of: 60 mm}')
    """
    text = text.strip()
    if match := FITTED.fullmatch(text):
        return _fitted(match["word"], match["size"])
    if match := WRITTEN.fullmatch(text):
        return match["word"] if WORDS[match["key"]](match["word"]) else text
    return text if is_series(text) or iso_286.CLASS.fullmatch(text) else ""


def _fitted(word: str, size: str) -> str:
    return f"{{fit: {word}, of: {size}}}"


def with_own_size(tolerance_class: str, sizes: Sizes) -> tuple[str, Sizes]:
    """The letters and number of a class, and nominal sizes: that which it states itself, else the scene's.

    Raises:
        InputError: it states no length.
    """
    match = FITTED.fullmatch(tolerance_class)
    if match is None:
        return tolerance_class, sizes
    try:
        size = Quantity.parse(match["size"])
    except ValueError as error:
        raise InputError(f"expected a nominal size such as 60 mm in {tolerance_class}; {error}") from None
    if size.dimension != "length" or not size.internal > 0.0:
        raise InputError(f"expected a nominal size such as 60 mm in {tolerance_class}, got {size}")
    return match["word"], {FIT: size}


def class_size(tolerance_class: str, sizes: Sizes) -> Quantity | None:
    """The nominal size at which a class is read; None where neither it nor the scene states one."""
    word, known = with_own_size(tolerance_class, sizes)
    return known.get(_standard(word, known))


def class_limits(tolerance_class: str, sizes: Sizes) -> tuple[float, float]:
    """Lower and upper limit of a class [mm].

    Raises:
        InputError: no such class of the size, or no size.
    """
    lower, upper = _limits(tolerance_class, sizes)
    return Quantity(float(lower), "um").internal, Quantity(float(upper), "um").internal


def _standard(tolerance_class: str, sizes: Sizes) -> str:
    """The key of the standard that has a class; of a wrong one that whose size is known."""
    return SERIES if is_series(tolerance_class) or {*sizes} == {SERIES} else FIT


def _limits(tolerance_class: str, sizes: Sizes) -> Limits:
    """Lower and upper limit of a class [um]."""
    tolerance_class, sizes = with_own_size(tolerance_class, sizes)
    standard = _standard(tolerance_class, sizes)
    if standard in sizes:
        return LIMITS[standard](tolerance_class, sizes[standard].internal)
    if standard == SERIES:
        raise InputError(f"expected a class of {STANDARDS[SERIES].of}, got {tolerance_class!r} of another tolerance")
    words = f"limits in numbers or {_fitted(tolerance_class, '60 mm')}, for the scene states no nominal size"
    raise InputError(f"expected {words} at which a class could be read, got {tolerance_class!r}")


def class_words(tolerance_class: str, sizes: Sizes) -> str:
    """A class with its numbers.

    >>> class_words("js7", {"fit": Quantity(60.2, "mm")}), class_words("H7", {"fit": Quantity(32.0, "mm")})
    ('js7: ±15 µm', 'H7: +25/0 µm')
    >>> class_words("27cd", {"din_3967": Quantity(100.0, "mm")})
    '27cd: -70/-170 µm'
    """
    lower, upper = _limits(tolerance_class, sizes)
    if lower == -upper:
        return f"{tolerance_class}: ±{upper:g} µm"
    return f"{tolerance_class}: {_signed(upper)}/{_signed(lower)} µm"


def _signed(number: float) -> str:
    return f"{number:+g}" if number else "0"


def neighbours(tolerance_class: str, sizes: Sizes) -> tuple[str, ...]:
    """A class, and those a grade finer and coarser that its standard has of the size.

    >>> neighbours("js7", {"fit": Quantity(60.2, "mm")}), neighbours("21 h", {"din_3967": Quantity(100.0, "mm")})
    (('js6', 'js7', 'js8'), ('h21', 'h22'))
    """
    if fitted := FITTED.fullmatch(tolerance_class):
        return tuple(_fitted(own, fitted["size"]) for own in neighbours(*with_own_size(tolerance_class, sizes)))
    match = iso_286.CLASS.fullmatch(tolerance_class)
    if is_series(tolerance_class):
        letters, grade = din_3967.series(tolerance_class)
    elif match is not None:
        letters, grade = match[1], int(match[2])
    else:
        return ()
    every = (f"{letters}{own}" for own in range(max(grade - 1, 1), grade + 2))
    return tuple(own for own in every if _is_there(own, sizes))


def _is_there(tolerance_class: str, sizes: Sizes) -> bool:
    try:
        class_limits(tolerance_class, sizes)
    except InputError:
        return False
    return True
