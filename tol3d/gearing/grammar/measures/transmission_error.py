"""Transmission error of a mesh or a train, on one of its flanks."""

from typing import ClassVar, Final, Literal

from pydantic import Field

from tol3d.gearing.grammar.measures.flank_measure import FlankMeasureSpec
from tol3d.gearing.grammar.measures.mesh_measure import FEWEST_POSITIONS
from tol3d.gearing.grammar.moves import GearMeshSpec, TrainSpec
from tol3d.scene.measure import AngleLimit
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.units import Dimension

MOST_POSITIONS: Final = 32_000
"""A turn: 16 a tooth of 2000 teeth."""


class TransmissionErrorSpec(FlankMeasureSpec):
    """An angle: how far the driven gear leads its nominal position while one side of the teeth touches.

    Counted in the sense in which the working flank of the driver pushes the driven gear, 0 at the first position.
    """

    dimension: ClassVar[Dimension] = "angle"

    kind: Literal["transmission_error"]
    of: Name = Field(description="the mesh move, or the train: from its driven shaft to its output")
    flank: Literal["drive", "back"] = Field(
        default="drive", description="the driver's flanks that touch: drive, its working ones, or back, the others"
    )
    over: Literal["turn", "long_period"] = Field(
        default="long_period",
        description="positions of the driver: turn (one of it) or long_period (until the same teeth meet again)",
    )
    take: Literal["min", "max", "range", "curve"] = Field(
        default="range", description="min, max, range (peak to peak) or curve of these positions"
    )
    positions: int = Field(
        default=72,
        ge=FEWEST_POSITIONS,
        le=MOST_POSITIONS,
        description="positions a turn of the driver; at least 16 a tooth where single teeth deviate",
    )
    lower_limit: AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: AngleLimit | None = Field(default=None, description="more than this is out of limits")

    @property
    def gives_curve(self) -> bool:
        """Whether a trial gives a value at every position instead of one."""
        return self.take == "curve"

    @property
    def several_positions(self) -> bool:
        """Always."""
        return True

    def references(self) -> tuple[Reference, ...]:
        """The mesh or the train."""
        return (Reference(("of",), self.of, (GearMeshSpec, TrainSpec)),)
