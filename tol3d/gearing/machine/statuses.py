"""Statuses of gears in a housing: those of gears, or of an assembly."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model.statuses import STATUSES as OF_ASSEMBLIES
from tol3d.assembly.model.statuses import WITH_CLEARANCES as OF_CLEARANCES
from tol3d.assembly.model.statuses import WITH_LOOPS as OF_LOOPS
from tol3d.gearing.engines.gaps import STATUSES as OF_GEARS
from tol3d.study.system.outcome import Statuses


def _with_those_of(assemblies: Statuses) -> Statuses:
    return Statuses(
        (*OF_GEARS.texts, *(text for text in assemblies.texts if text not in OF_GEARS.texts)),
        OF_GEARS.lacking | assemblies.lacking,
        {**assemblies.words, **OF_GEARS.words},
        {**assemblies.states, **OF_GEARS.states},
    )


STATUSES: Final = _with_those_of(OF_ASSEMBLIES)
"""Codes of gears are their own."""

WITH_CLEARANCES: Final = _with_those_of(OF_CLEARANCES)
"""The same, and parts that overlap: of gearboxes with clearances of whole parts."""

WITH_LOOPS: Final = _with_those_of(OF_LOOPS)
"""Further statuses of closed loops."""

FROM_ASSEMBLIES: Final[NDArray[np.int8]] = np.array(
    [WITH_LOOPS.texts.index(text) for text in OF_LOOPS.texts], dtype=np.int8
)
"""Their codes by those of assemblies."""
