"""A tolerance that a slider moves, in round numbers: the factor is a hand's, the numbers are what a drawing has."""

import math
from typing import Final

from tol3d.analyses.stated_changes import Change, changed
from tol3d.apps.workbench.card import numbers_of, written
from tol3d.apps.workbench.session import Session
from tol3d.errors import InputError

FINEST: Final = 0.0095
"""Most that neighbours among round numbers differ, of half the width: less than a step of a slider, so none stands
still."""
ALIKE: Final = 0.02
"""Most that widths differ, of themselves, by rounding."""


def in_round_numbers(session: Session, line: str, words: str) -> str:
    """A change by a factor as round numbers, such as `±29 µm`; a limit that stays is as it was.

    Args:
        session: the scene.
        line: of it, which states the tolerance.
        words: the change: "x1.45".

    Returns:
        Words as a field takes them; the factor where a tolerance is stated by no numbers of its own.

    Raises:
        InputError: no such line, or a factor that cannot be.
    """
    moved, (name, *_) = session.changed({line: words}), session.response.lines[line]
    contributor = next(own for own in session.response.contributors if own.name == name)
    wished, per = numbers_of(moved.drawn_by(name)), contributor.per_unit
    width = wished[-1] - wished[0] if len(wished) > 1 else 2.0 * wished[0]
    if not width > 0.0:
        return words
    numbers = [
        own if math.isclose(own, was, rel_tol=1e-9) else per * _rounded(own / per, FINEST * width / (2.0 * per))
        for own, was in zip(wished, numbers_of(session.response.drawn_by(name)), strict=True)
    ]
    change = Change(line, size=numbers[0]) if len(numbers) == 1 else Change(line, limits=(numbers[0], numbers[1]))
    try:
        draw = changed(session.response, [change]).drawn_by(name)
    except InputError:
        return words
    sigmas = [own.distribution.sigma for own in (draw, moved.drawn_by(name))]
    return written(contributor, draw) if math.isclose(*sigmas, rel_tol=ALIKE) else words


def _rounded(number: float, finest: float) -> float:
    """The nearest multiple of the largest 1, 2 or 5 of a decimal place that is no more than `finest`.

    >>> _rounded(28.9971, 0.29), _rounded(-30.5712, 0.06)
    (29.0, -30.55)
    """
    place = 10.0 ** math.floor(math.log10(finest))
    step = max(own * place for own in (1.0, 2.0, 5.0) if own * place <= finest * (1.0 + 1e-9))
    return float(f"{round(number / step) * step:.9g}")
