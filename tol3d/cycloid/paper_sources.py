"""Which contributors of a scene the published formula knows, and by what tolerances."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from tol3d.cycloid.paper_formula import RUN_OUT_SIGMAS, RUN_OUTS, TOLERANCE_SIGMAS, Source

SOURCES: Final[Mapping[str, Source]] = {
    "disc offset": "disc run-out",
    "crank throw of a disc": "crank run-out",
    "pin circle": "pin circle radius",
    "pin round": "pin pitch",
    "lobe pitch": "disc pitch",
    "lobe profile": "disc profile",
    "carrier circle": "carrier hole centre",
    "carrier offset": "main bearing run-out",
}
"""By what a contributor acts on."""


@dataclass(frozen=True)
class PaperSources:
    """What of a scene goes into the formula.

    Args:
        tolerances: of each source [mm], so large that it scales back to the scene's standard deviations; the root sum
            square of several contributors to one source.
        left_out: names of contributors that the formula has no place for.
    """

    tolerances: Mapping[Source, float]
    left_out: tuple[str, ...]

    @classmethod
    def of(cls, contributors: Iterable[tuple[str, str, float]]) -> "PaperSources":
        """From each contributor's name, what it acts on, and the standard deviation of one component [mm]."""
        found: dict[Source, float] = {}
        left_out = []
        for name, effect, sigma in contributors:
            if effect not in SOURCES:
                left_out.append(name)
                continue
            source = SOURCES[effect]
            scale = RUN_OUT_SIGMAS if source in RUN_OUTS else TOLERANCE_SIGMAS
            found[source] = math.hypot(found.get(source, 0.0), scale * sigma)
        return cls({source: found[source] for source in SOURCES.values() if source in found}, tuple(left_out))
