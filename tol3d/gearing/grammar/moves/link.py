"""What every link of two shafts that is no gear mesh has in common."""

from abc import abstractmethod
from typing import ClassVar, Self

from pydantic import Field, model_validator

from tol3d.gearing.grammar.parts.shaft_reference import ShaftReference
from tol3d.gearing.links import StatedLink
from tol3d.scene import Scene
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.strict import refused


class LinkSpec(MoveSpec):
    """Two shafts that turn with each other; a kind of link, of whatever mechanism, is a subclass and says its link."""

    words: ClassVar[str] = "a link of two shafts"

    driver: Name = Field(description="the shaft, or the gear that is its own, towards the motor")
    driven: Name = Field(description="the shaft, or the gear that is its own, behind it")

    @model_validator(mode="after")
    def _refuse_one_shaft(self) -> Self:
        if self.driver == self.driven:
            raise refused("driven", "another shaft than the driver", repr(self.driven))
        return self

    def references(self) -> tuple[Reference, ...]:
        """Two shafts."""
        return ShaftReference(("driver",), self.driver), ShaftReference(("driven",), self.driven)

    @abstractmethod
    def link(self, name: str, scene: Scene) -> StatedLink:
        """What the move of that name stands for in a scene.

        Raises:
            SceneError: nothing that can be built, with its place.
        """
