"""Deviation of a feature from its nominal pose, as seen from another part; and differences of measures."""

from collections.abc import Iterator, Sequence
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec, FeatureMeasureSpec, TimedSpec
from tol3d.assembly.grammar.measures.gap import DistanceSpec, GapSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model.measures import PLACING, TORSORS, Measured, Reading
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.strict import refused
from tol3d.units import Dimension

Component = Literal["x", "y", "z", "size"]
AXES = dict(zip("xyz", np.eye(3), strict=True))


class PoseErrorSpec(TimedSpec):
    """Deviation of a feature from its nominal pose, in the frame of a part."""

    words: ClassVar[str] = "an error of place or turn"
    reads_along: ClassVar[Reading]  # reads the component along an axis, `reads` the size

    of: FeatureName = Field(description="the feature, such as link 6.flange")
    from_: Name = Field(alias="from", description="the part in whose frame it is read, such as base")
    component: Component = Field(
        default="size", description="along, or about, x, y or z of that part; or the size of all three"
    )

    @property
    def of_what(self) -> Sequence[str]:
        """The feature, and the part that sees it."""
        return (self.of, self.from_)

    @property
    def twin(self) -> FeatureName:
        """Name of the feature fixed to the part that sees it, where the measured feature lies nominally."""
        return f"{self.of} nominal in {self.from_}"

    def measured(self, moves: Sequence[str]) -> Measured:
        """Model that reads from the twin to the feature."""
        return Measured(
            self.reads_along if self.component in AXES else self.reads, (self.twin, self.of), AXES.get(self.component)
        )

    @property
    def parts_read(self) -> Sequence[str]:
        return (self.from_, part_of(self.of))

    def references(self) -> tuple[Reference, ...]:
        """Parts of the feature and of `from`, and the move after which it is read."""
        parts = (Reference(("of",), part_of(self.of), (SolidSpec,)), Reference(("from",), self.from_, (SolidSpec,)))
        return (*parts, *self.timing)

    def uses(self) -> Iterator[Use]:
        """The feature."""
        yield Use(("of",), self.of)


class PositionErrorSpec(PoseErrorSpec):
    """Deviation of the feature's position from nominal, as seen from the part `from`.

    Its component along `x`, `y` or `z` of that part, or its `size`.
    """

    reads: ClassVar[Reading] = DistanceSpec.reads
    reads_along: ClassVar[Reading] = GapSpec.reads

    kind: Literal["position_error"]


class OrientationErrorSpec(PoseErrorSpec):
    """Rotation vector that turns the nominal frame of the feature into that of the trial.

    Its component about `x`, `y` or `z` of the part `from`, which sees it, or its `size`.
    """

    dimension: ClassVar[Dimension] = "angle"
    reads: ClassVar[Reading] = Reading("turn", f"{PLACING}:turn", f"{TORSORS}:turn", is_linear=True, worse="high")
    reads_along: ClassVar[Reading] = reads

    kind: Literal["orientation_error"]


class DirectionErrorSpec(TimedSpec):
    """Angle between the axis of the feature and its nominal direction, as the part `from` sees it.

    Its `size`; or, of an axis that tilts from another one, `against`, the component `along` the tilt, positive where it
    tilts further, or `across` it, positive counter-clockwise. If it does not tilt nominally, these are along x and y of
    the axis `against`.
    """

    words: ClassVar[str] = "an error of a direction"
    dimension: ClassVar[Dimension] = "angle"
    reads: ClassVar[Reading] = Reading("lean", f"{PLACING}:lean", f"{TORSORS}:lean", worse="high")
    reads_along: ClassVar[Reading] = Reading("lean", f"{PLACING}:lean", f"{TORSORS}:lean", is_linear=True)

    kind: Literal["direction_error"]
    of: FeatureName = Field(description="the feature whose z is read, such as gear 2.axis")
    from_: Name | None = Field(
        default=None,
        alias="from",
        description="the part in whose frame it is read; default: the first one that is fixed",
    )
    against: FeatureName | None = Field(default=None, description="the axis from which it tilts, such as frame.axis")
    component: Literal["size", "along", "across"] = Field(
        default="size", description="along or across the tilt, or the size of both"
    )

    @property
    def of_what(self) -> Sequence[str]:
        """The feature, and what sees it."""
        return (self.of, self.from_ or "the world")

    @property
    def twin(self) -> FeatureName:
        """Name of the feature fixed to the part that sees it, where the measured feature lies nominally."""
        return f"{self.of} nominal in {self.from_ or 'the world'}"

    def measured(self, moves: Sequence[str]) -> Measured:
        """Model that reads from the twin to the feature, along or across the tilt from `against`."""
        if self.component == "size" or self.against is None:
            return Measured(self.reads, (self.twin, self.of))
        across = np.array([0.0, 1.0]) if self.component == "across" else np.array([1.0, 0.0])
        return Measured(self.reads_along, (self.twin, self.of, self.against), across)

    @property
    @override
    def parts_read(self) -> Sequence[str]:
        others = [self.from_] if self.from_ else []
        return (*others, part_of(self.of), *([part_of(self.against)] if self.against else []))

    def references(self) -> tuple[Reference, ...]:
        """Parts of its features and of `from`, and the move after which it is read."""
        parts = [Reference(("of",), part_of(self.of), (SolidSpec,))]
        if self.from_ is not None:
            parts.append(Reference(("from",), self.from_, (SolidSpec,)))
        if self.against is not None:
            parts.append(Reference(("against",), part_of(self.against), (SolidSpec,)))
        return (*parts, *self.timing)

    def uses(self) -> Iterator[Use]:
        """The feature, and the axis from which it tilts."""
        yield Use(("of",), self.of)
        if self.against is not None:
            yield Use(("against",), self.against)

    @model_validator(mode="after")
    def _refuse_no_axis(self) -> Self:
        if self.component != "size" and self.against is None:
            raise refused("against", f"the axis from which it tilts, beside component: {self.component}", "none")
        return self


class DifferenceSpec(AssemblyMeasureSpec):
    """One measure less another in the same trial, such as the taper of a gap."""

    words: ClassVar[str] = "a difference"

    kind: Literal["difference"]
    of: Name = Field(description="the measure")
    minus: Name = Field(description="the one that is subtracted")

    @classmethod
    def lacking(cls) -> Iterator[str]:
        """Nothing: it needs no reading of its own."""
        return iter(())

    @property
    def of_what(self) -> Sequence[str]:
        """Both measures."""
        return (self.of, self.minus)

    def measured(self, moves: Sequence[str]) -> Measured:
        """Nothing by itself: both measures are read instead.

        Raises:
            TypeError: always.
        """
        raise TypeError("a difference is read as its measures are")

    def references(self) -> tuple[Reference, ...]:
        """Both measures, each of features or of a pose error."""
        specs = (FeatureMeasureSpec, PoseErrorSpec)
        return Reference(("of",), self.of, specs), Reference(("minus",), self.minus, specs)
