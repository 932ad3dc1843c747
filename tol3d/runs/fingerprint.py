"""Fingerprint that identifies the blocks of an interrupted run, kept while the run is written."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tol3d.files import UnreadableFileError, read_contained
from tol3d.numerics.processor import unlike

FINGERPRINT = "fingerprint.json"
STUDY = ("scene", "files", "study")  # of a fingerprint; the rest decides the last bits only
LARGEST_FINGERPRINT = 10_000_000  # bytes; it names every file of the scene and every `until`

Fingerprint = Mapping[str, Any]


def differences(there: Fingerprint, asked: Fingerprint) -> list[str]:
    """Differences of an existing run from the one that is asked for, in words."""
    found = []
    for key in {**there, **asked}:
        old, new = there.get(key), asked.get(key)
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            found += [f"{key}: {words}" for words in differences(old, new)]
        elif old != new:
            there_only, now_only = unlike(old, new)
            found.append("the scene's text" if key == "scene" else f"{key} {there_only} there, {now_only} now")
    return found


def another_study(there: Fingerprint, asked: Fingerprint) -> list[str]:
    """Differences of an existing run's study from the one that is asked for, in words."""
    found = differences(*({key: print_.get(key) for key in STUDY} for print_ in (there, asked)))
    if _keeps(there) and not _keeps(asked):
        found.append("it holds the trials, too, and this would keep statistics only")
    return found


def _keeps(fingerprint: Fingerprint) -> bool:
    return bool((fingerprint.get("blocks") or {}).get("kept"))


def interrupted(partial: Path) -> Fingerprint | None:
    """The fingerprint of the interrupted run in a folder; None if there is none, {} if it was being cleared."""
    try:
        read: Any = json.loads(read_contained(partial / FINGERPRINT, partial, LARGEST_FINGERPRINT))
    except (UnreadableFileError, ValueError, RecursionError):
        return None
    return read if isinstance(read, Mapping) and (not read or "scene" in read) else None
