"""A move of another mechanism that places bodies of an assembly, and the poses in which its scene reads them."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar

from tol3d.scene.move import MoveSpec
from tol3d.scene.place import KeyPath

if TYPE_CHECKING:
    from tol3d.assembly.from_scene.assembly import Understood
    from tol3d.assembly.from_scene.features import TouchedPoints
    from tol3d.assembly.grammar.feature_name import FeatureName
    from tol3d.assembly.model import Move
    from tol3d.scene import Scene
    from tol3d.system.plain import PlainContributor


class StatedMoveSpec(MoveSpec):
    """A move of any mechanism that places one or several bodies and defines how; see Move."""

    words: ClassVar[str] = "a move that places a part"

    @property
    @abstractmethod
    def parts_placed(self) -> Sequence[tuple[KeyPath, str]]:
        """The parts that it places with their fields, in an order in which each lies on those before."""

    @abstractmethod
    def targets(self) -> Iterator[tuple[KeyPath, "FeatureName"]]:
        """Features with their fields on which it lays them: of parts that are placed, or that it places before."""

    @property
    def pose_names(self) -> Sequence[str]:
        """Poses that measures may be read at; the first one is read where none is named."""
        return ()

    @property
    def path_names(self) -> Mapping[str, Sequence[str]]:
        """Paths that measures may be read over: by name the poses on them, which `stated` gets like others."""
        return {}

    def pose_like(self, pose: str) -> str:
        """A pose of the scene if it is one of this move's, else its first one; "" where it has none."""
        own = (*self.pose_names, *(each for poses in self.path_names.values() for each in poses))
        return pose if pose in own else next(iter(own), "")

    def contributors(self, name: str, scene: "Scene") -> "Sequence[PlainContributor]":
        """Contributors of the move itself, such as floats; a name that begins with . is hidden."""
        return ()

    @abstractmethod
    def stated(
        self, name: str, understood: "Understood", touched: "TouchedPoints", drawn: "Mapping[str, slice]", pose: str
    ) -> "Move":
        """Model of the move.

        Args:
            name: name of the move.
            understood: the scene's drawings; datum frames that the move needs are named here.
            touched: features of all parts, and where parts are nominally.
            drawn: the columns of its contributors.
            pose: one of its poses, on a path too; "" where it has none.

        Raises:
            SceneError: the part cannot be placed; with the key in the scene.
        """
