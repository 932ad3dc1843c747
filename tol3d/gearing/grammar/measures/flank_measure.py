"""What every measure of flanks in contact says: where on the face they are read, and at which teeth."""

from abc import ABC
from typing import Literal

from pydantic import Field

from tol3d.scene.measure import MeasureSpec


class FlankMeasureSpec(MeasureSpec, ABC):
    """A measure of one mesh, or of the meshes on the path of a train."""

    read_at: Literal["mean_section", "face_contact", "face"] | None = Field(
        default=None,
        description="where on the face: contact and gap in the section in its middle (bevel gears if not given), "
        "contact over the face and the gap in that section, or both over the face (spur gears if not given)",
    )
    tooth: Literal["driver", "driven", "all"] = Field(
        default="all",
        description="which teeth: all that may touch, or one tooth of the driver or of the driven gear in its space, "
        "where both of its flanks are in action",
    )
