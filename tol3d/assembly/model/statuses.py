"""Statuses of an assembly, measure by measure."""

from typing import Final

from tol3d.study.system.outcome import Statuses

STATUSES: Final = Statuses(
    ("ok", "not unique", "no contact", "no build", "singular", "not held"),
    words={
        "not unique": "have no unique pose",
        "no contact": "have parts that do not touch",
        "no build": "do not fit together",
        "singular": "have no pose that could be found",
        "not held": "tip or slide off their contacts",
    },
    states={
        "not unique": "of no unique pose",
        "no contact": "without contact",
        "no build": "not fitting together",
        "not held": "tipping or sliding off",
    },
)
"""In the order of their codes: assembled; the pose is not unique and the measure varies with it; parts that should
touch do not reach each other; the parts do not fit together; the pose was not found, for the contacts have lost their
rank; a part tips off its one-sided contacts."""

WITH_CLEARANCES: Final = Statuses(
    (*STATUSES.texts, "overlap"),
    frozenset({"overlap"}),
    {**STATUSES.words, "overlap": "overlap"},
    {**STATUSES.states, "overlap": "overlapping"},
)
"""The same, and parts that overlap by an unknown depth: for assemblies with clearances of whole parts."""

WITH_LOOPS: Final = Statuses(
    (*WITH_CLEARANCES.texts, "does not close", "other branch"),
    WITH_CLEARANCES.lacking,
    {**WITH_CLEARANCES.words, "does not close": "do not close", "other branch": "close on another branch"},
    {**WITH_CLEARANCES.states, "does not close": "not closed", "other branch": "on another branch"},
)
"""Further: a loop that does not close; one that closes on another branch than nominally, beyond a singular pose."""

OK: Final = 0
NOT_UNIQUE: Final = 1
NO_CONTACT: Final = 2
NO_BUILD: Final = 3
SINGULAR: Final = 4
NOT_HELD: Final = 5
OVERLAP: Final = 6
DOES_NOT_CLOSE: Final = 7
OTHER_BRANCH: Final = 8

FITS: Final = -1e-9
"""Slack [mm] down to which parts go together: a fit of size and size has it by rounding of its poses."""
