"""What a shaft may carry, or what turns by itself where none does."""

from typing import ClassVar

from tol3d.scene.part import PartSpec


class TurningSpec(PartSpec):
    """A part with an axis of its own, about which it turns or is held: a gear, or that of another mechanism."""

    words: ClassVar[str] = "a gear"
