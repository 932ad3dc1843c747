"""Kinds of joints as kernels know them."""

from typing import Final

BALL: Final = 0
REVOLUTE: Final = 1
PRISMATIC: Final = 2
CYLINDRICAL: Final = 3
UNIVERSAL: Final = 4
SWING: Final = 5
SCREW: Final = 6
ROLLING: Final = 7
ALONG: Final = 8
"""The z of both frames are one direction: of an output that a pose names."""
FIXED: Final = 9
"""Both frames coincide: of such an output too."""
ON_AXES_KINDS: Final = frozenset([REVOLUTE, PRISMATIC, CYLINDRICAL, SCREW])
"""Kinds with two axes on one line."""
