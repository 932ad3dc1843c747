"""Zones that say how a feature is turned; beside a location zone they refine it and have no law of their own."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.grammar.tolerances.modified import Modified
from tol3d.assembly.grammar.zone import LawUnion, ZoneSpec


class OrientationSpec(Modified, FeatureTolerance):
    """A zone for how a feature is turned."""

    applies_to: ClassVar[tuple[str, ...]] = ("plane", "slot", "cylinder", "axis")

    zone: ZoneSpec
    law: LawUnion | None = Field(
        default=None, description="of a feature without a location zone; else that zone's law counts"
    )
    datums: Datums

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        """See FeatureTolerance."""
        return self.datums


class PerpendicularitySpec(OrientationSpec):
    """Square to a datum."""

    words: ClassVar[str] = "a perpendicularity tolerance"

    kind: Literal["perpendicularity"]


class ParallelismSpec(OrientationSpec):
    """Parallel to a datum."""

    words: ClassVar[str] = "a parallelism tolerance"

    kind: Literal["parallelism"]


class AngularitySpec(OrientationSpec):
    """At an angle to a datum, as it is nominally."""

    words: ClassVar[str] = "an angularity tolerance"

    kind: Literal["angularity"]
