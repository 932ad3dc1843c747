"""Run-out: how far an axis lies off the datum's axis, seen at a section or at both ends."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.datums import Datums
from tol3d.assembly.grammar.tolerances.location import LocationSpec


class CircularRunOutSpec(LocationSpec):
    """Radial run-out at the middle section: twice the eccentricity; the zone's width is the run-out."""

    words: ClassVar[str] = "a circular run-out tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("cylinder", "axis")

    kind: Literal["circular_run_out"]
    datums: Datums = Field(description="the axis that it turns about")


class TotalRunOutSpec(LocationSpec):
    """Radial run-out at both ends."""

    words: ClassVar[str] = "a total run-out tolerance"
    applies_to: ClassVar[tuple[str, ...]] = ("cylinder", "axis")

    kind: Literal["total_run_out"]
    datums: Datums = Field(description="the axis that it turns about")
