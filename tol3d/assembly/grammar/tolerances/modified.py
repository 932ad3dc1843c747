"""Tolerances that may have a material modifier: a feature's departure from its material condition widens the zone."""

from pydantic import Field

from tol3d.assembly.model.bonus import Modifier
from tol3d.strict import Strict


class Modified(Strict):
    """A tolerance that a bonus may widen."""

    modifier: Modifier | None = Field(
        default=None, description="mmc or lmc: the size of the feature widens the zone; none, regardless of size"
    )
