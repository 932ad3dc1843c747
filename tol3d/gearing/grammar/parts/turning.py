"""What a shaft may carry, or what turns by itself where none does."""

from typing import ClassVar

from tol3d.scene.part import PartSpec


class TurningSpec(PartSpec):
    """A part that turns about an axis of its own: a gear, or whatever another mechanism drives."""

    words: ClassVar[str] = "a gear"
