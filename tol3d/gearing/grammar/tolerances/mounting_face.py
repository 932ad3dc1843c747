"""Surface profile of a face that a gear's place along its axis rests on."""

from typing import Literal

from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec


class MountingFaceSpec(GearToleranceSpec):
    """Delta P, a length: the face lies off its true place, and the gear with it along its own +z.

    Each face of the stack (the gear's back, the housing's seat, an end cover) is a contributor of its own.
    """

    kind: Literal["mounting_face"]
