"""What scenes say of a study of gears besides what every study has."""

from typing import Final

from pydantic import Field

from tol3d.scene.options import StudyOptions

FEWEST_PROFILE_STEPS: Final = 8
MOST_PROFILE_STEPS: Final = 2000


class GearStudyOptions(StudyOptions):
    """How finely flanks are measured."""

    profile_steps: int = Field(
        default=120,
        ge=FEWEST_PROFILE_STEPS,
        le=MOST_PROFILE_STEPS,
        description="flat facets along a curved profile, for engines that measure facets",
    )
