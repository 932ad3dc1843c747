"""What became of a mesh that was brought to contact."""

from typing import Final

OK: Final = 0
INTERFERES: Final = 1
NO_CONTACT: Final = 2
OUT_OF_RANGE: Final = 3

STATUS_TEXT: Final = {OK: "ok", INTERFERES: "interferes", NO_CONTACT: "no contact", OUT_OF_RANGE: "out of range"}
"""INTERFERES: the non-working flanks overlap. OUT_OF_RANGE: so far from nominal that other teeth may meet."""
