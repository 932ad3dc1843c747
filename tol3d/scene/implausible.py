"""Numbers that could be built and are most likely a slip: deviations that are a large part of a nominal size."""

from dataclasses import dataclass
from typing import Final

from tol3d.errors import Problem
from tol3d.scene.place import KeyPath, Origin, path_text, printable
from tol3d.statistics.distributions import Distribution
from tol3d.units import Quantity

ROUNDED_SIZE: Final = 0.01  # share of a size by which a drawing may round it


@dataclass(frozen=True)
class Implausible:
    """Limit of a plausible deviation, as a share of a nominal size, beyond which it causes a warning.

    Args:
        share: of the nominal size; that much is still plausible.
        advice: remedy.

    >>> Implausible(0.5).sentence("the diameter of 'plate.hole'", 8.0, 200.0)
    "expected at most 50 % of the diameter of 'plate.hole' (8 mm), got 200 mm (2500 %); check the unit"
    """

    share: float
    advice: str = "check the unit"

    def sentence(self, of: str, nominal: float, deviation: float) -> str:
        """Sentence on an implausible deviation [mm]; "" for a plausible one, or without a nominal size.

        Args:
            of: the nominal size in words.
            nominal: that size [mm].
            deviation: the largest, with its sign [mm].
        """
        if not nominal > 0.0 or abs(deviation) <= self.share * nominal:
            return ""
        came = f"got {deviation:.4g} mm ({abs(deviation) / nominal * 100:.4g} %)"
        return f"expected at most {self.share * 100:g} % of {of} ({nominal:.4g} mm), {came}; {self.advice}"


def another_size(drawn: object, nominal: float, of: str) -> str:
    """Sentence on a tolerance class such as `{fit: js7, of: 80 mm}` that is taken at another size; "" for none.

    Args:
        drawn: limits as the scene writes them.
        nominal: size of what they limit [mm].
        of: that size in words.

    >>> another_size({"fit": "js7", "of": "80 mm"}, 172.5, "centre distance of 'pair'")
    "expected the centre distance of 'pair', 172.5 mm, got 80 mm, at which the class has limits of its own"
    """
    stated = drawn.get("of") if isinstance(drawn, dict) else None
    if stated is None or abs(Quantity.parse(stated).internal / nominal - 1.0) <= ROUNDED_SIZE:
        return ""
    return f"expected the {of}, {nominal:g} mm, got {stated}, at which the class has limits of its own"


def larger_end(law: Distribution) -> float:
    """The end of a law that is farther from 0, with its sign [mm, rad or K]."""
    return max(law.extremes, key=abs)


def warned(origin: Origin, path: KeyPath, sentence: str) -> Problem:
    """The line of a warning: place in the scene, sentence; its parts know file and line too."""
    (line, column, file), told = origin.place(path), printable(sentence)
    at = path_text(path)
    return Problem(f"{at}: {told}", str(file or origin.source), line, column, at, told)
