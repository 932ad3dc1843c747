"""A law by a class of which the limits depend on a size that only the scene knows, such as DIN 3967 of a gear.

Limits of a size itself are such a class: its deviations follow from the nominal size.
"""

from collections.abc import Callable, Mapping
from typing import Any, Final, Literal, NamedTuple

from typing_extensions import override

from tol3d.errors import InputError
from tol3d.files import Files
from tol3d.statistics.distributions.base import Distribution, DistributionSpec
from tol3d.statistics.distributions.default_law import LimitLaw
from tol3d.statistics.distributions.size_limits import size_limits
from tol3d.statistics.standards import din_3967
from tol3d.statistics.standards.iso_286 import Limits
from tol3d.units import Quantity


class Standard(NamedTuple):
    """Limits [um] of a class at a size [mm], and what has them, in words."""

    limits: Callable[[str, float], Limits]
    of: str


SIZE: Final = "size"
"""The standard of limits of a size itself."""
STANDARDS: Final[Mapping[str, Standard]] = {
    "din_3967": Standard(din_3967.thickness, "a tooth_thickness of a cylindrical gear, measured: arc"),
    "din_3964": Standard(din_3967.centre_distance, "a centre_distance of a mesh that states its own"),
    SIZE: Standard(
        size_limits,
        "a tooth_thickness of a cylindrical gear, measured: {span: …}, {pins: …} or {balls: …} (limits of a deviation "
        "have signs, as in +0.12/0 mm)",
    ),
}


class UnsizedSpec(DistributionSpec):
    """Limits by a class, until the scene is read: the entry then puts the law of its size in its place."""

    kind: Literal["unsized"] = "unsized"
    standard: str
    word: str
    law: LimitLaw
    written: Any

    def of(self, size: float) -> DistributionSpec:
        """The law at a size [mm].

        Raises:
            InputError: the standard has none there.
        """
        lower, upper = (Quantity(float(own), "um") for own in STANDARDS[self.standard].limits(self.word, size))
        return self.law.between(lower, upper).as_drawn(self.written, self.law)

    def refusal(self, size: float) -> str:
        """The sentence with which the standard has no law at a size [mm]; "" where it has one."""
        try:
            self.of(size)
        except InputError as error:
            return str(error)
        return ""

    @override
    def resolve(self, files: Files) -> Distribution:
        raise InputError(f"expected {STANDARDS[self.standard].of} in a scene, by which {self.word} has limits")
