"""A scene's drawings as understood, and the setting in which the model of a move is made."""

from collections.abc import Mapping
from dataclasses import dataclass

from tol3d.assembly.from_scene.contributors import Effects
from tol3d.assembly.from_scene.datums import DatumFrames
from tol3d.assembly.from_scene.features import TouchedPoints
from tol3d.assembly.model import Feature, Measured
from tol3d.scene import Scene


@dataclass(frozen=True, eq=False)
class Understood:
    """A scene's drawings and measures, wherever its parts lie.

    Args:
        scene: the scene.
        effects: its tolerances.
        frames: of its datums.
        features: those that it names.
        measured: what its measures read.
    """

    scene: Scene
    effects: Effects
    frames: DatumFrames
    features: Mapping[str, Feature]
    measured: Mapping[str, Measured]


@dataclass(frozen=True, eq=False)
class Setting:
    """The scene as a move finds it: drawings, places of parts, columns of its own contributors.

    Args:
        understood: the scene's drawings; datum frames that the move needs are named here.
        touched: features of all parts, and where parts are nominally.
        drawn: columns of the move's own contributors, by their names.
        pose: one of its poses, on a path too; "" where it has none.
    """

    understood: Understood
    touched: TouchedPoints
    drawn: Mapping[str, slice]
    pose: str = ""

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.understood.scene

    @property
    def effects(self) -> Effects:
        """Effects of its tolerances."""
        return self.understood.effects

    @property
    def features(self) -> Mapping[str, Feature]:
        """Features of all parts, by their names."""
        return self.touched.features
