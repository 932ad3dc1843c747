"""Side of a tooth: the sign sigma that every formula of tol3d shares."""

from typing import Final, Literal

Flank = Literal[1, -1]
"""sigma: +1 the right flank, on the low-azimuth side of its tooth; -1 the left flank."""

RIGHT: Final[Flank] = 1
LEFT: Final[Flank] = -1


def opposite(flank: Flank) -> Flank:
    """The other flank of the tooth.

    >>> opposite(RIGHT) == LEFT
    True
    """
    return LEFT if flank == RIGHT else RIGHT
