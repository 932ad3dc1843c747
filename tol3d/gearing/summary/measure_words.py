"""Words for the values of gear measures, their positions, and the places on the teeth."""

from collections.abc import Mapping
from typing import Final, Literal

from tol3d.study.runs.summary.values import Section

QUANTITY_WORDS: Final[Mapping[str, str]] = {
    "normal_backlash": "normal backlash",
    "circumferential_backlash": "circumferential backlash",
    "angular_backlash": "angular backlash",
}
TAKE_WORDS: Final[Mapping[str, str]] = {
    "value": "",
    "min": "smallest ",
    "max": "largest ",
    "range": "range of ",
    "curve": "",
}
OVER_WORDS: Final[Mapping[str, str]] = {
    "random": "at a random position of the driver each trial",
    "at": "at one position of the driver",
    "turn": "over one turn of the driver",
    "long_period": "over the long period",
    "swing": "over the swing of the output",
}
TRAIN_OVER_WORDS: Final[Mapping[str, str]] = {
    **OVER_WORDS,
    "random": "at a random position each trial",
    "at": "at one position",
}
READING_WORDS: Final[Mapping[tuple[str, str], str]] = {
    ("face", "face"): "",
    ("face", "section"): "; contact over the face, gap in its middle",
    ("section", "section"): "; mean section",
}
TEETH_WORDS: Final[Mapping[str, str]] = {"all": "", "driver": ", one driver tooth", "driven": ", one driven tooth"}


class Reading(Section):
    """Place on the face, and teeth, at which contact and gap of a mesh are read."""

    contact: Literal["face", "section"]
    gap: Literal["face", "section"]
    teeth: Literal["all", "driver", "driven"]

    @property
    def words(self) -> str:
        """Words for the place of reading, unless it is everywhere and at all teeth.

        >>> Reading(contact="section", gap="section", teeth="driven").words
        '; mean section, one driven tooth'
        """
        return READING_WORDS[self.contact, self.gap] + TEETH_WORDS[self.teeth]


def readings_words(readings: Mapping[str, Reading]) -> str:
    """The same of several meshes by name, once where they are alike.

    >>> section = Reading(contact="section", gap="section", teeth="driven")
    >>> readings_words({"first": section, "second": section})
    '; mean section, one driven tooth'
    >>> readings_words({"first": section, "second": Reading(contact="face", gap="face", teeth="all")})
    '; first: mean section, one driven tooth'
    """
    each = {mesh: reading.words for mesh, reading in readings.items()}
    if len(set(each.values())) == 1:
        return next(iter(each.values()))
    return "".join(f"; {mesh}: {words[2:]}" for mesh, words in each.items() if words)
