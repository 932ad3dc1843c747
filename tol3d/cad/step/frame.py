"""Feature control frames as one line of text: `⌖ | ⌀0.8 | D | E Ⓜ-F Ⓜ-G Ⓜ`."""

from typing import Final

from tol3d.cad.step.datum import Compartment
from tol3d.cad.step.tolerance import PerUnit, Tolerance
from tol3d.cad.step.units import plain

SYMBOLS: Final = {
    "straightness": "⏤",
    "flatness": "▱",
    "roundness": "○",
    "cylindricity": "⌭",
    "line profile": "⌒",
    "surface profile": "⌓",
    "angularity": "∠",
    "perpendicularity": "⊥",
    "parallelism": "∥",
    "position": "⌖",
    "concentricity": "◎",
    "coaxiality": "◎",
    "symmetry": "⌯",
    "circular runout": "↗",
    "total runout": "⌰",
}
"""The sign of each kind of tolerance. Source: ISO 1101:2017, table 1."""

ZONE_SIGNS: Final = {"width": "", "diameter": "⌀", "spherical diameter": "S⌀"}
"""The sign before the size of a zone, by its shape."""

MODIFIER_SIGNS: Final = {
    "maximum material requirement": "Ⓜ",
    "maximum material condition": "Ⓜ",
    "least material requirement": "Ⓛ",
    "least material condition": "Ⓛ",
    "regardless of feature size": "Ⓢ",
    "reciprocity requirement": "Ⓡ",
    "free state": "Ⓕ",
    "tangent plane": "Ⓣ",
    "statistical tolerance": "⟨ST⟩",
    "common zone": "CZ",
    "separate zones": "SZ",
    "separate requirement": "SEP REQT",
    "each radial element": "EACH RADIAL ELEMENT",
    "line element": "LE",
    "any cross section": "ACS",
    "basic": "[BSC]",
    "translation": "▷",
    "non-uniform zone": "NON-UNIFORM",
}
"""The sign of each modifier; others are printed in words."""

AREA_SIGNS: Final = {"circular": "⌀", "square": "□", "rectangular": ""}


def frame(tolerance: Tolerance) -> str:
    """The frame of a tolerance, numbers in the file's own units, compartments separated by bars."""
    sign = SYMBOLS.get(tolerance.kind, tolerance.kind)
    return " | ".join((sign, value(tolerance), *(compartment(datum) for datum in tolerance.datums)))


def value(tolerance: Tolerance) -> str:
    """The second compartment: the magnitude with its zone, its unit basis and its modifiers."""
    magnitude = "?" if tolerance.magnitude is None else plain(tolerance.magnitude.written)
    parts = [ZONE_SIGNS[tolerance.zone] + magnitude]
    if tolerance.per_unit is not None:
        parts.append(f"/ {basis(tolerance.per_unit)}")
    parts.extend(signs(tolerance.modifiers))
    if tolerance.projected is not None:
        parts.append(f"Ⓟ {plain(tolerance.projected.length.written)}")
    if tolerance.unequal is not None:
        parts.append(f"Ⓤ {plain(tolerance.unequal.written)}")
    if tolerance.maximum is not None:
        parts.append(f"{plain(tolerance.maximum.written)} MAX")
    return " ".join(parts)


def basis(per_unit: PerUnit) -> str:
    """The length or the area that a magnitude is for."""
    sides = [per_unit.size, *([per_unit.second] if per_unit.second is not None else [])]
    return AREA_SIGNS.get(per_unit.area, "") + "×".join(plain(side.written) for side in sides)


def compartment(datums: Compartment) -> str:
    """One compartment of datums: `A`, `A Ⓜ`, `E Ⓜ-F Ⓜ`."""
    letters = "-".join(" ".join((reference.letter, *signs(reference.modifiers))) for reference in datums.references)
    return " ".join((letters, *signs(datums.modifiers)))


def signs(modifiers: tuple[str, ...]) -> list[str]:
    """Modifiers as signs."""
    return [MODIFIER_SIGNS.get(modifier, modifier) for modifier in modifiers]
