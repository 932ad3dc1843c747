"""Which features pictures name, and what they call them."""

from collections.abc import Iterator, Mapping
from typing import Final

from tol3d.assembly.model import Assembly
from tol3d.assembly.model.measures import Measured

MOST_NAMED: Final = 16
"""Features that a picture names."""
MOST_LISTED: Final = 4
"""Features that a note lists of those that it does not name."""
PLACES: Final = ("1st datum", "2nd datum", "3rd datum")


def labels(assembly: Assembly) -> Mapping[str, str]:
    """What pictures call features that they name, by these: of datums also their place in their frames."""
    places = _datum_places(assembly)
    named = _by_importance(assembly)[:MOST_NAMED]
    return {name: f"{name}, {places[name]}" if name in places else name for name in named}


def unnamed(assembly: Assembly) -> tuple[str, ...]:
    """A note of the features that pictures do not name, if there are any."""
    others = _by_importance(assembly)[MOST_NAMED:]
    if not others:
        return ()
    more = f" and {len(others) - MOST_LISTED} more" if others[MOST_LISTED:] else ""
    words = f"{', '.join(others[:MOST_LISTED])}{more}"
    return (f"named are {MOST_NAMED} features, those that measures read and datums before others; not {words}",)


def _by_importance(assembly: Assembly) -> list[str]:
    """Named features: what measures read, datums, what deviates, all others; each in the scene's order."""
    ranks = {name: 3 for name, own in assembly.features.items() if own.is_named}
    ranks |= {name: 2 for name in ranks if assembly.features[name].moved_by}
    ranks |= {name: 1 for name in _datum_places(assembly) if name in ranks}
    ranks |= {name: 0 for own in assembly.measures.values() for name in _read(own) if name in ranks}
    return sorted(ranks, key=lambda name: ranks[name])


def _read(measured: Measured) -> Iterator[str]:
    yield from measured.features
    if measured.minus is not None:
        yield from _read(measured.minus)


def _datum_places(assembly: Assembly) -> Mapping[str, str]:
    """The place of each datum in its frames; "datum" where these differ."""
    found: dict[str, str] = {}
    for frame in assembly.datum_frames.values():
        for place, datum in zip(PLACES, frame.datums, strict=False):
            for name in datum.features:
                found[name] = place if found.get(name, place) == place else "datum"
    return found
