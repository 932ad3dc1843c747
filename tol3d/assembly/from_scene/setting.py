"""A scene's drawings as understood, and the setting in which the model of a move is made."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tol3d.assembly.from_scene.datums import DatumFrames
from tol3d.assembly.from_scene.effects import Effects
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.model import Feature, Measured
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene


@dataclass(frozen=True, eq=False)
class Understood:
    """A scene's drawings and measures, wherever its parts lie.

    Args:
        drawing: tolerances of the scene, feature by feature.
        effects: its contributors.
        frames: of its datums.
        features: those that it names.
        measured: what its measures read.
    """

    drawing: Drawing
    effects: Effects
    frames: DatumFrames
    features: Mapping[str, Feature]
    measured: Mapping[str, Measured]

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.drawing.scene


@dataclass(frozen=True, eq=False)
class Setting:
    """The scene as a move finds it: drawings, places of parts, columns of its own contributors.

    Args:
        understood: the scene's drawings.
        features: of all parts, by their names; points of planes that moves touch are among them.
        poses: of parts, nominally in the world (4, 4).
        drawn: columns of the move's own contributors, by their names.
        pose: one of its poses, on a path too; "" where it has none.
    """

    understood: Understood
    features: Mapping[str, Feature]
    poses: Mapping[str, Array]
    drawn: Mapping[str, slice]
    pose: str = ""

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.understood.scene

    @property
    def drawing(self) -> Drawing:
        """Its tolerances, feature by feature."""
        return self.understood.drawing

    @property
    def effects(self) -> Effects:
        """Effects of its tolerances."""
        return self.understood.effects

    def origin(self, name: str) -> Array:
        """Nominal origin of a feature in the world (3,) [mm]."""
        own = self.features[name]
        return np.asarray((self.poses[own.part] @ own.frame)[:3, 3])
