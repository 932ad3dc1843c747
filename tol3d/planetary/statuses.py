"""What may become of a planetary set that is put together."""

from typing import Final

from tol3d.system.statuses import Statuses

STATUSES: Final = Statuses(
    texts=("ok", "interferes", "singular"),
    lacking=frozenset(("interferes",)),
    words={"interferes": "jam", "singular": "cannot be solved"},
    states={"interferes": "jammed"},
)
"""By the codes of tol3d.numerics.programme; a set interferes where contacts of a closed loop lack room."""
