"""What may become of gears that are brought to contact, as studies count it."""

from typing import Final

from tol3d.gearing.engines.status import INTERFERES, STATUS_TEXT
from tol3d.system.statuses import Statuses

STATUSES: Final = Statuses(
    texts=tuple(STATUS_TEXT[code] for code in range(len(STATUS_TEXT))),
    lacking=frozenset((STATUS_TEXT[INTERFERES],)),
    words={"interferes": "jam", "no contact": "find no contact", "out of range": "are out of range"},
    states={"interferes": "jammed", "no contact": "without contact"},
)
