"""stub"""

import json
from pathlib import Path
from typing import Any

from tol3d.errors import RunError


def summary_of(content: bytes, path: Path) -> dict[str, Any]:
    try:
        found = json.loads(content)
    except ValueError as error:
        raise RunError(f"{path}: {error}") from None
    if not isinstance(found, dict):
        raise RunError(f"{path}: expected the summary of a tol3d run")
    return found
