"""What may become of an RV reducer that is put together."""

from typing import Final

from tol3d.system.statuses import Statuses

NO_CONTACT: Final = 1
NO_FIT: Final = 2
NO_REST: Final = 3
STATUSES: Final = Statuses(
    texts=("ok", "no contact", "cranks do not fit", "no rest found"),
    words={
        "no contact": "have no pin that touches",
        "cranks do not fit": "have cranks that do not fit into discs and carrier",
        "no rest found": "do not come to rest",
    },
)
"""Builds whose pins press on both sides keep a value, a lost motion below 0: the discs give way."""
