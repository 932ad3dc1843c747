"""Numbers kept beside the scenes, in scenes/*.expected.toml."""

import tomllib
from functools import cache
from typing import Any

from places import SCENES


@cache
def expected(scene: str) -> dict[str, Any]:
    """What a scene must give, by measure, and with how many trials."""
    return tomllib.loads((SCENES / f"{scene}.expected.toml").read_text("utf-8"))
