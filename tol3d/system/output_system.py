"""A system whose trials differ by where one shaft stands, its output: reducers and planetary sets."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.system.plain import PlainSystem
from tol3d.system.system import StreamKey
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


@dataclass(frozen=True)
class OutputSystem(PlainSystem):
    """A system with an output that stands anywhere in its period; see System.

    Args:
        own: what turns the output: its name, and the period in turns of the output until everything meets again.
    """

    own: Any

    @property
    def streams(self) -> tuple[StreamKey, ...]:
        """One, of the position of the output."""
        return ((self.own.name, "position"),)

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        """Turns of the output, uniform over its period."""
        return {self.own.name: uniforms[self.streams[0]] * float(self.own.period)}

    @property
    def position_column(self) -> str:
        """Name of the column of positions."""
        return f"position:{self.own.name} [deg]"

    def columns(self, trials: Trials) -> Mapping[str, NDArray[np.generic]]:
        """Angle of the output."""
        return {self.position_column: 360.0 * trials.positions[self.own.name]}
