"""The drawing of one part in the file, as it grows while its tolerances and dimensions are read."""

from dataclasses import dataclass, field

from tol3d.apps.drafting.entry import Entry
from tol3d.apps.drafting.features import Features
from tol3d.apps.drafting.words import Names, scalar
from tol3d.step import Meanings, StepText


@dataclass
class Drawn:
    """Drawing of one part in the file, as far as it is said: entries of a scene.

    Args:
        text: of the file.
        meanings: of all its tolerances.
        part: the name of the part in the scene.
        features: of the part.
        names: those of the scene.
        spread: the kind of distribution of sizes and dimensions, as the law of zones.
        reasons: why tolerances and dimensions are left out, beyond their meaning; grows.
        entries: tolerances and measures; grows.
        datums: the feature of each letter; grows.
        located: the tolerance or dimension that locates each group of features; grows.
        sizes: the entry of the size of each group; grows.
        frames: the datums of that, as they are written, and how many there are; grows.
        doubled: losses of tolerances of a feature that another one locates; grows.
    """

    text: StepText
    meanings: Meanings
    part: str
    features: Features
    names: Names
    spread: str = "normal"
    reasons: dict[int, str] = field(default_factory=dict)
    entries: list[Entry] = field(default_factory=list)
    datums: dict[str, str] = field(default_factory=dict)
    located: dict[str, int] = field(default_factory=dict)
    sizes: dict[str, Entry] = field(default_factory=dict)
    doubled: dict[int, str] = field(default_factory=dict)
    frames: dict[str, tuple[tuple[tuple[str, str], ...], int]] = field(default_factory=dict)

    def of(self, feature: str) -> str:
        """A feature with its part, as YAML."""
        return scalar(f"{self.part}.{feature}")
