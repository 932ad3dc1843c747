"""What may become of gears in a housing: what may become of gears, or of an assembly."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model.statuses import STATUSES as OF_ASSEMBLIES
from tol3d.gearing.statuses import STATUSES as OF_GEARS
from tol3d.system.statuses import Statuses

STATUSES: Final = Statuses(
    (*OF_GEARS.texts, *(text for text in OF_ASSEMBLIES.texts if text not in OF_GEARS.texts)),
    OF_GEARS.lacking | OF_ASSEMBLIES.lacking,
    {**OF_ASSEMBLIES.words, **OF_GEARS.words},
    {**OF_ASSEMBLIES.states, **OF_GEARS.states},
)
"""Codes of gears are their own."""

FROM_ASSEMBLIES: Final[NDArray[np.int8]] = np.array(
    [STATUSES.texts.index(text) for text in OF_ASSEMBLIES.texts], dtype=np.int8
)
"""Their codes by those of assemblies."""
