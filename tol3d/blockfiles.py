"""A folder of Parquet files, one a block of trials, each with its SHA-256 in the list beside them.

The list is the one that `sha256sum --check` reads; its name begins with an underscore, for readers of a whole folder
of Parquet pass such names over. A line is added after its file is whole, so a kill leaves at most a file without one.
"""

import hashlib
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path

from tol3d.durable import write_whole
from tol3d.errors import RunError
from tol3d.parquet import Columns, ParquetError, columns_of, names_of, parquet_of

CHECKSUMS = "_SHA256SUMS"
SUFFIX = ".parquet"
MENDED = "`tol3d run` with --resume makes it again"


def block_name(index: int) -> str:
    """Name of the file of a finished block.

    >>> block_name(12)
    'block-000012'
    """
    return f"block-{index:06d}"


class BlockFiles:
    """The files of a folder, by their names without suffix.

    Args:
        folder: where they are.
        units: unit of each column, kept in the files' metadata.
    """

    def __init__(self, folder: Path, units: Mapping[str, str] | None = None) -> None:
        self.folder = folder
        self._units = units or {}
        self._list = folder / CHECKSUMS
        self._adding = threading.Lock()
        self._sums = dict(_listed(self._list))

    def path(self, name: str) -> Path:
        """The file of that name."""
        return self.folder / (name + SUFFIX)

    @property
    def names(self) -> list[str]:
        """The files that are there or should be, in order."""
        return sorted({path.stem for path in self.folder.glob(f"*{SUFFIX}")} | self._sums.keys())

    def __contains__(self, name: object) -> bool:
        """Whether a file was finished; it may be damaged or gone since."""
        return name in self._sums

    @property
    def column_names(self) -> tuple[str, ...]:
        """Names of the columns, as the first file has them."""
        first = self.names[0]
        try:
            return names_of(self._content(first))
        except ParquetError as error:
            raise self._damaged(first, str(error)) from None

    def read(self, name: str, columns: Sequence[str] | None = None) -> Columns:
        """Columns of a file, all of them by default.

        Raises:
            RunError: it is missing, damaged, or not the file that was written.
        """
        try:
            return columns_of(self._content(name), columns)
        except ParquetError as error:
            raise self._damaged(name, str(error)) from None

    def verify(self, name: str) -> None:
        """Compare a file with its checksum.

        Raises:
            RunError: it is missing, damaged, or not the file that was written.
        """
        self._content(name)

    def _content(self, name: str) -> bytes:
        try:
            content = self.path(name).read_bytes()
        except OSError as error:
            raise self._damaged(name, error.strerror or str(error)) from None
        # a folder without any list was written before there were checksums
        if (self._sums or self._list.exists()) and hashlib.sha256(content).hexdigest() != self._sums.get(name):
            raise self._damaged(name, "not the file that was written: its SHA-256 is another")
        return content

    def _damaged(self, name: str, reason: str) -> RunError:
        return RunError(f"{self.path(name)}: damaged or unreadable ({reason}); {MENDED}")

    def write(self, name: str, columns: Columns) -> None:
        """Write a file, all or nothing; several threads may write different ones."""
        content = parquet_of(columns, self._units)
        sha256 = hashlib.sha256(content).hexdigest()
        write_whole(self.path(name), content)
        with self._adding, self._list.open("a", encoding="utf-8") as stream:
            stream.write(_line(name, sha256))
            self._sums[name] = sha256

    def remove(self, names: Sequence[str]) -> None:
        """Take files away."""
        for name in names:
            self.path(name).unlink(missing_ok=True)
            self._sums.pop(name, None)

    def settle(self) -> None:
        """Write the list anew: each file once, no line that a kill or a full disk cut short."""
        write_whole(self._list, "".join(_line(name, self._sums[name]) for name in sorted(self._sums)).encode())


def _line(name: str, sha256: str) -> str:
    return f"{sha256}  {name}{SUFFIX}\n"


def _listed(path: Path) -> list[tuple[str, str]]:
    """Names and checksums of a list; lines that were cut short are none."""
    try:
        lines = path.read_text("utf-8", errors="replace").splitlines()
    except OSError:
        return []
    pairs = (line.split("  ", 1) for line in lines if line.endswith(SUFFIX))
    return [(pair[1].removesuffix(SUFFIX), pair[0]) for pair in pairs if len(pair) == 2 and len(pair[0]) == 64]
