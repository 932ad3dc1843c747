"""Draws of other tolerances: the same features, their deviations by another law, or as many times as wide.

A draw that is a dataclass of a distribution is made again with another one. Others say themselves what their tolerance
is, such as a zone's width. A draw that says nothing of it, such as one of measured values, has no other one.
"""

from dataclasses import is_dataclass, replace
from typing import Any, Final, Protocol, runtime_checkable

from tol3d.errors import InputError
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.base import Stays
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import Draw
from tol3d.study.system.normals import groups_of
from tol3d.study.system.remembered import Remembered


@runtime_checkable
class Scalable(Protocol, metaclass=Remembered):
    """A Draw that defines its own draw with another tolerance."""

    def scaled(self, factor: float) -> Draw:
        """Draw of a multiple of the width, about its mean.

        Raises:
            InputError: it cannot be scaled.
        """
        ...


@runtime_checkable
class Lawful(Protocol, metaclass=Remembered):
    """A Draw that defines its own draw by another law."""

    def with_law(self, law: Distribution) -> Draw:
        """The same by another law."""
        ...


@runtime_checkable
class Zoned(Protocol, metaclass=Remembered):
    """A Draw in a zone of a width [mm]."""

    @property
    def width(self) -> float:
        """Width of the zone."""
        ...

    def sized(self, width: float) -> Draw:
        """The same in a zone of another width.

        Raises:
            InputError: that is no width, or less than the zone that refines it.
        """
        ...


@runtime_checkable
class Following(Protocol, metaclass=Remembered):
    """A Draw that knows the tolerance of the contributor that it reads."""

    def following(self, name: str, draw: Draw) -> Draw:
        """The same where a contributor that it reads is drawn otherwise."""
        ...


@runtime_checkable
class Holding(Protocol, metaclass=Remembered):
    """A Contributor whose tolerance may act by more than its own draw."""

    @property
    def held(self) -> str:
        """Holder of it, such as the gauge that inspects; "" for none."""
        ...


def with_law(draw: Draw, law: Distribution) -> Draw:
    """A draw by another law.

    Raises:
        InputError: it has no law of its own.
    """
    if isinstance(draw, Lawful):
        return draw.with_law(law)
    own: Any = draw
    if _is_of_law(draw):
        made: Draw = replace(own, distribution=law)
        return made
    raise InputError(f"expected a contributor that is drawn by a law, got {_words(draw)}")


def naturally_stays(draw: Draw) -> Stays:
    """Fixed point of a draw that is scaled: its mean; 0 of a length in any direction that begins there."""
    law = draw.distribution
    if any(own.kind in DIRECTED for own in groups_of(draw) or ()) and isinstance(law, Distribution):
        return "low" if law.limits is not None and law.limits[0] == 0.0 else "middle"
    return "middle"


def scaled(draw: Draw, factor: float, stays: Stays | None = None) -> Draw:
    """A draw as many times as wide.

    Args:
        draw: its tolerance as it is.
        factor: above 0.
        stays: its mean, or one of its limits; default: see `naturally_stays`.

    Raises:
        InputError: it has no tolerance of its own, its law cannot be scaled, or has no such limit.
    """
    if isinstance(draw, Scalable):
        if stays not in (None, "middle"):
            raise InputError(f"expected the middle to stay, got {stays}, of {_words(draw)}")
        return draw.scaled(factor)
    if not _is_of_law(draw):
        raise InputError(f"expected a contributor that can be scaled, got {_words(draw)}")
    own: Any = draw
    return with_law(draw, own.distribution.scaled_at(factor, stays or naturally_stays(draw)))


def shifted(draw: Draw, by: float) -> Draw:
    """A draw of the same width whose mean lies elsewhere.

    Raises:
        InputError: it has no law of its own, or one that begins where it begins.
    """
    if not _is_of_law(draw):
        raise InputError(f"expected a contributor that is drawn by a law, got {_words(draw)}")
    own: Any = draw
    return with_law(draw, own.distribution.shifted(by))


def refuse_held(contributor: Contributor) -> None:
    """Refuse a tolerance that acts elsewhere too.

    Raises:
        InputError: naming the contributor.
    """
    if isinstance(contributor, Holding) and contributor.held:
        words = "expected a tolerance that acts by its deviation alone"
        raise InputError(f"{contributor.name}: {words}, got one that {contributor.held}; write it into the scene")


def refuse_impossible(contributor: Contributor, draw: Draw) -> None:
    """Refuse a draw below its physical limit.

    Raises:
        InputError: naming the contributor.
    """
    least, per = contributor.least, contributor.per_unit
    if least is None:
        return
    law = draw.distribution  # of a zone with a bonus it takes long
    if law.low < min(least, contributor.distribution.low) - LEAST_OFF:
        raise InputError(
            f"{contributor.name}: expected at least {least / per:g} {contributor.unit}, for less is not physical, "
            f"got down to {law.low / per:.4g} {contributor.unit}"
        )


DIRECTED: Final = ("plane", "space")
LEAST_OFF: Final = 1e-12
"""mm, rad or K; rounding."""


def _is_of_law(draw: Draw) -> bool:
    fields: Any = getattr(draw, "__dataclass_fields__", {})
    return is_dataclass(draw) and "distribution" in fields and isinstance(draw.distribution, Distribution)


def _words(draw: Draw) -> str:
    own = getattr(draw, "words", "")
    return str(own) if isinstance(own, str) and own else f"a {type(draw).__name__}"
