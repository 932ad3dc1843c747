"""Limits of a process that reads untrusted files."""

from importlib import import_module
from typing import Any, Final

MEGABYTE: Final = 1_000_000
LARGEST_ANSWER: Final = 2_000 * MEGABYTE
"""Bytes; limit of what such a process may write to one file."""


def limit_this_process(megabytes: int, seconds: float) -> None:
    """Limit the address space and computing time of this process, and leave no core behind.

    Where the system knows no such limits, the wall clock of the one that started it is the only one.

    Args:
        megabytes: of address space.
        seconds: of processor time.
    """
    try:
        resource: Any = import_module("resource")
    except ImportError:  # Windows
        return
    wanted = {
        resource.RLIMIT_AS: megabytes * MEGABYTE,
        resource.RLIMIT_CPU: int(seconds) + 1,
        resource.RLIMIT_FSIZE: LARGEST_ANSWER,
        resource.RLIMIT_CORE: 0,
    }
    for kind, most in wanted.items():
        _, hard = resource.getrlimit(kind)
        least = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(kind, (least, hard))
