"""What a measure is, in one line of words."""

from collections.abc import Mapping
from typing import Any

from tol3d.report.number import UNIT_SIGNS, given_text

QUANTITY_WORDS: Mapping[str, str] = {
    "normal_backlash": "normal backlash",
    "circumferential_backlash": "circumferential backlash",
    "angular_backlash": "angular backlash",
}
TAKE_WORDS: Mapping[str, str] = {"value": "", "min": "smallest ", "max": "largest ", "range": "range of ", "curve": ""}
OVER_WORDS: Mapping[str, str] = {
    "random": "at a random position of the driver each trial",
    "at": "at one position of the driver",
    "turn": "over one turn of the driver",
    "long_period": "over the long period",
}


READING_WORDS: Mapping[tuple[str, str], str] = {
    ("face", "face"): "",
    ("face", "section"): "; contact over the face, gap in its middle",
    ("section", "section"): "; mean section",
}


def reading_words(reading: Mapping[str, str]) -> str:
    """Where on the face and at which teeth, unless it is everywhere and all.

    >>> reading_words({"contact": "section", "gap": "section", "teeth": "driven"})
    '; mean section, one driven tooth'
    """
    teeth = {"driver": ", one driver tooth", "driven": ", one driven tooth"}
    return READING_WORDS[reading["contact"], reading["gap"]] + teeth.get(reading["teeth"], "")


def heading(measure: Mapping[str, Any]) -> str:
    """Quantity, mesh and positions of a measure's summary.

    >>> heading({"kind": "normal_backlash", "of": "gear pair", "gear": "wheel", "over": "turn", "take": "min"})
    'smallest normal backlash of gear pair over one turn of the driver'
    """
    gear = f" of {measure['gear']} in" if measure["kind"] == "angular_backlash" else " of"
    quantity = TAKE_WORDS[measure["take"]] + QUANTITY_WORDS[measure["kind"]]
    reading = reading_words(measure["reading"]) if "reading" in measure else ""
    return f"{quantity}{gear} {measure['of']} {OVER_WORDS[measure['over']]}{reading}"


def worst_words(measures: Mapping[str, Mapping[str, Any]]) -> str:
    """What makes a trial the worst, see `worst_trial`.

    >>> worst_words({"free play": {"lower_limit": 20.0, "upper_limit": None}})
    'the nearest to a limit of free play, or the furthest beyond it'
    >>> worst_words({"free play": {"lower_limit": None, "upper_limit": None}})
    'the smallest free play, for there are no limits'
    """
    limited = [name for name, m in measures.items() if (m["lower_limit"], m["upper_limit"]) != (None, None)]
    if not limited:
        return f"the smallest {next(iter(measures))}, for there are no limits"
    return f"the nearest to a limit of {' or '.join(limited)}, or the furthest beyond it"


def limits_text(measure: Mapping[str, Any]) -> str:
    """The limits of a measure's summary, with their unit."""
    unit = measure["unit"]
    sign = "" if unit == "arcmin" else f" {UNIT_SIGNS[unit]}"
    given = [
        f"{word} limit {given_text(measure[key], unit)}{sign}"
        for word, key in (("lower", "lower_limit"), ("upper", "upper_limit"))
        if measure.get(key) is not None
    ]
    return ", ".join(given) or "no limits"
