"""What every measure of an RV reducer has in common."""

from pydantic import Field

from tol3d.cycloid.grammar.moves.rv_reducer import RVReducerSpec
from tol3d.scene.measure import AngleSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference


class CycloidMeasureSpec(AngleSpec):
    """An angle of the output."""

    of: Name = Field(description="the RV reducer")

    def references(self) -> tuple[Reference, ...]:
        """The reducer."""
        return (Reference(("of",), self.of, (RVReducerSpec,)),)
