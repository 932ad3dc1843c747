"""Labels that fit: users' names broken into lines of a width."""

import warnings
from bisect import bisect_right
from collections.abc import Sequence
from functools import lru_cache
from typing import Final

from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from tol3d.report.heading import legible

POINTS_PER_INCH: Final = 72.0


def wrapped(text: str, width: float, size: float, lines: int, weight: str = "normal") -> str:
    """A user's name in lines of at most `width` [inch]; what does not fit in so many lines ends in an ellipsis."""
    found: list[str] = []
    rest = text
    while rest and len(found) < lines:
        line = _longest_start(rest, width, size, weight)
        found.append(line.strip())
        rest = rest[len(line) :].lstrip()
    if rest:
        last = found[-1] + "…"
        while len(last) > 1 and text_width(last, size, weight) > width:
            last = last[:-2] + "…"
        found[-1] = last
    return "\n".join(legible(line, len(line)) for line in found)


def _longest_start(text: str, width: float, size: float, weight: str) -> str:
    """As many words as fit in a line, or as much of the first word."""
    if text_width(text, size, weight) <= width:
        return text
    ends = [k for k, sign in enumerate(text) if sign == " "]
    if fitting := bisect_right(ends, width, key=lambda k: text_width(text[:k], size, weight)):
        return text[: ends[fitting - 1]]
    cut = bisect_right(range(1, len(text) + 1), width, key=lambda k: text_width(text[:k], size, weight))
    return text[: max(cut, 1)]


@lru_cache(maxsize=4096)
def text_width(text: str, size: float, weight: str) -> float:
    """Width of a line of text [inch], in points of `size`."""
    font = FontProperties(size=size, weight=weight)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph \d+ .* missing")  # of a user's name: shown as a box
        width, _, _ = text_to_path.get_text_width_height_descent(text, font, ismath=False)
    return float(width) / POINTS_PER_INCH


def widest(labels: Sequence[str], size: float) -> float:
    """Width of the widest line of any of the labels [inch]; 0 without any."""
    return max((text_width(line, size, "normal") for label in labels for line in label.split("\n")), default=0.0)
