"""What summary.json holds, read from a file that a stranger may have made."""

import json
from pathlib import Path
from typing import Any

from tol3d.errors import RunError


def summary_of(content: bytes, path: Path) -> dict[str, Any]:
    """The summary of a run.

    Raises:
        RunError: it is none.
    """
    try:
        found = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise RunError(f"{path}: cannot be read ({error})") from None
    if not isinstance(found, dict) or not {"trials", "measures", "study", "files", "blocks"} <= found.keys():
        raise RunError(f"{path}: expected the summary of a tol3d run")
    return found
