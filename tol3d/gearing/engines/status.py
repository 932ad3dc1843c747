"""Status of a mesh that was brought to contact; a larger code is worse, for less is known of the build."""

from typing import Final

OK: Final = 0
INTERFERES: Final = 1
NO_CONTACT: Final = 2
OUT_OF_RANGE: Final = 3

STATUS_TEXT: Final = {OK: "ok", INTERFERES: "interferes", NO_CONTACT: "no contact", OUT_OF_RANGE: "out of range"}
"""INTERFERES: the non-working flanks overlap, by what a measure below 0 says. OUT_OF_RANGE: so far from nominal that
other teeth may meet, or do, where one tooth is looked at and has left the path of contact."""
