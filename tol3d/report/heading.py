"""What a measure is, in one line of words."""

from collections.abc import Mapping
from typing import Any

from tol3d.report.number import given_text, unit_suffix
from tol3d.runs.worst import TRAIN_KINDS

QUANTITY_WORDS: Mapping[str, str] = {
    "normal_backlash": "normal backlash",
    "circumferential_backlash": "circumferential backlash",
    "angular_backlash": "angular backlash",
    "lost_motion": "lost motion",
    "tip_displacement": "displacement by the lost motion",
    "tip_error": "error by the lost motion",
}
TAKE_WORDS: Mapping[str, str] = {"value": "", "min": "smallest ", "max": "largest ", "range": "range of ", "curve": ""}
OVER_WORDS: Mapping[str, str] = {
    "random": "at a random position of the driver each trial",
    "at": "at one position of the driver",
    "turn": "over one turn of the driver",
    "long_period": "over the long period",
    "swing": "over the swing of the output",
}
TRAIN_OVER_WORDS: Mapping[str, str] = {
    **OVER_WORDS,
    "random": "at a random position each trial",
    "at": "at one position",
}

READING_WORDS: Mapping[tuple[str, str], str] = {
    ("face", "face"): "",
    ("face", "section"): "; contact over the face, gap in its middle",
    ("section", "section"): "; mean section",
}


def reading_words(measure: Mapping[str, Any]) -> str:
    """Where on the face and at which teeth a measure is read, unless it is everywhere and all; of a train, each mesh.

    >>> section = {"contact": "section", "gap": "section", "teeth": "driven"}
    >>> reading_words({"reading": section})
    '; mean section, one driven tooth'
    >>> reading_words({"reading": None, "readings": {"first": section, "second": section}})
    '; mean section, one driven tooth'
    >>> reading_words({"readings": {"first": section, "second": {"contact": "face", "gap": "face", "teeth": "all"}}})
    '; first: mean section, one driven tooth'
    """
    if measure.get("reading"):
        return _reading_words(measure["reading"])
    each = {mesh: _reading_words(reading) for mesh, reading in measure.get("readings", {}).items()}
    if len(set(each.values())) == 1:
        return next(iter(each.values()))
    return "".join(f"; {mesh}: {words[2:]}" for mesh, words in each.items() if words)


def _reading_words(reading: Mapping[str, str]) -> str:
    teeth = {"driver": ", one driver tooth", "driven": ", one driven tooth"}
    return READING_WORDS[reading["contact"], reading["gap"]] + teeth.get(reading["teeth"], "")


def heading(measure: Mapping[str, Any]) -> str:
    """Quantity, mesh or train, and positions of a measure's summary.

    >>> heading({"kind": "normal_backlash", "of": "gear pair", "gear": "wheel", "over": "turn", "take": "min"})
    'smallest normal backlash of gear pair over one turn of the driver'
    >>> lost = {"of": "swing", "shaft": "flange", "held": "motor", "over": "random"}
    >>> heading({"kind": "lost_motion", **lost})
    'lost motion of flange, motor held, at a random position each trial'
    >>> heading({"kind": "tip_displacement", "arm": "arm", "point": "tip", **lost})
    'displacement of tip of arm by the lost motion, at a random position each trial'
    """
    if measure["kind"] in TRAIN_KINDS:
        return f"{_train_quantity(measure)}, {TRAIN_OVER_WORDS[measure['over']]}{reading_words(measure)}"
    gear = f" of {measure['gear']} in" if measure["kind"] == "angular_backlash" else " of"
    quantity = TAKE_WORDS[measure["take"]] + QUANTITY_WORDS[measure["kind"]]
    return f"{quantity}{gear} {measure['of']} {OVER_WORDS[measure['over']]}{reading_words(measure)}"


def _train_quantity(measure: Mapping[str, Any]) -> str:
    if measure["kind"] == "lost_motion":
        return f"lost motion of {measure['shaft']}, {measure['held']} held"
    word = "error" if measure["kind"] == "tip_error" else "displacement"
    return f"{word} of {measure['point']} of {measure['arm']} by the lost motion"


def position_of(measure: Mapping[str, Any]) -> str:
    """What a measure's positions are positions of.

    >>> position_of({"kind": "tip_error"}), position_of({"kind": "normal_backlash"})
    ('output', 'driver')
    """
    return "output" if measure["kind"] == "tip_error" else "driver"


def worst_words(measures: Mapping[str, Mapping[str, Any]]) -> str:
    """What makes a trial the worst, see `worst_trial`.

    >>> worst_words({"free play": {"lower_limit": 20.0, "upper_limit": None, "status": {"interferes": 3}}})
    'the deepest jammed by free play'

    >>> worst_words({"free play": {"lower_limit": 20.0, "upper_limit": None}})
    'the nearest to a limit of free play, or the furthest beyond it'
    >>> worst_words({"free play": {"lower_limit": None, "upper_limit": None, "kind": "normal_backlash"}})
    'the smallest free play, for there are no limits'
    """
    limited = [name for name, m in measures.items() if (m["lower_limit"], m["upper_limit"]) != (None, None)]
    judged = limited or [*measures][:1]
    if jammed := [name for name in judged if measures[name].get("status", {}).get("interferes")]:
        return f"the deepest jammed by {' or '.join(jammed)}"
    if not limited:
        name, measure = next(iter(measures.items()))
        word = "largest" if measure["kind"] in TRAIN_KINDS else "smallest"
        return f"the {word} {name}, for there are no limits"
    return f"the nearest to a limit of {' or '.join(limited)}, or the furthest beyond it"


def limits_text(measure: Mapping[str, Any]) -> str:
    """The limits of a measure's summary, with their unit."""
    unit = measure["unit"]
    given = [
        f"{word} limit {given_text(measure[key], unit)}{unit_suffix(unit)}"
        for word, key in (("lower", "lower_limit"), ("upper", "upper_limit"))
        if measure.get(key) is not None
    ]
    return ", ".join(given) or "no limits"
