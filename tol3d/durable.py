"""Files that are whole or not there, also after a kill or a power cut."""

import errno
import os
from pathlib import Path

NO_SPACE = (errno.ENOSPC, errno.EDQUOT)


def write_whole(path: Path, content: bytes | memoryview) -> None:
    """Write beside the file's place, bring it to the disk and rename it there; nothing is left of a failure."""
    beside = path.with_name(path.name + ".writing")
    try:
        with beside.open("wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(beside, path)
    except OSError:
        beside.unlink(missing_ok=True)
        raise


def lacks_space(error: OSError) -> bool:
    """Whether a write failed because the disk, or the user's share of it, is full."""
    return error.errno in NO_SPACE
