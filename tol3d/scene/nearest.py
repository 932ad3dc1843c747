"""The known word nearest to an unknown one."""

import difflib
from collections.abc import Collection, Iterable
from itertools import islice

LONGEST_WORD = 100  # characters compared; keeps difflib quick on noise
MOST_WORDS = 2000  # known words compared; a scene of more parts than that still gets its message
LISTED_WORDS = 12  # so many known words are listed where none is near


def nearest(word: str, known: Iterable[str]) -> str:
    """The nearest known word, to end a message; empty if none is near.

    >>> nearest("wall_thicknes", ["eccentricity", "wall_thickness"])
    '; did you mean "wall_thickness"?'
    """
    by_folded = {known_word.casefold(): known_word for known_word in islice(known, MOST_WORDS)}
    near = difflib.get_close_matches(word[:LONGEST_WORD].casefold(), by_folded, n=1)
    return f'; did you mean "{by_folded[near[0]]}"?' if near else ""


def hint(word: str, known: Collection[str]) -> str:
    """The nearest known word, or else the first few of them; empty if nothing is known.

    >>> hint("colour", ["length", "width"])
    '; known here: length, width'
    """
    more = ", …" if len(known) > LISTED_WORDS else ""
    listed = f"; known here: {', '.join(islice(known, LISTED_WORDS))}{more}" if known else ""
    return nearest(word, known) or listed
