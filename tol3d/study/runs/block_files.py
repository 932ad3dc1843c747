"""A folder of Parquet files, one a block of trials, each with its SHA-256 in the list beside them.

The list is the one that `sha256sum --check` reads; its name begins with an underscore, for readers of a whole folder
of Parquet pass such names over. A line is added after its file is whole, so a kill leaves at most a file without one.
"""

import hashlib
import re
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from tol3d.errors import RunError
from tol3d.files import UnreadableFileError, read_contained
from tol3d.study.runs.atomic_write import UNFINISHED, named_in_errors, write_whole
from tol3d.study.runs.parquet import Columns, ParquetError, Shape, columns_of, names_of, parquet_of

CHECKSUMS = "_SHA256SUMS"
SUFFIX = ".parquet"
MENDED = "`tol3d run` with --resume makes it again"
NAME = re.compile(r"block-[0-9]{6,}(-[0-9]+)?")  # of a block, or of a piece of one that begins at a trial
LARGEST_LIST = 100_000_000  # bytes; a line a block, of 10^10 trials 14 MB
LARGEST_BLOCK = 2**31  # bytes; 65 536 trials of 4000 columns


def block_name(index: int) -> str:
    """Name of the file of a finished block.

    >>> block_name(12)
    'block-000012'
    """
    return f"block-{index:06d}"


class BlockFiles:
    """The files of a folder, by their names without suffix.

    Args:
        folder: of the files.
        units: unit of each column, kept in the files' metadata.
        shape: of each file, where that is known; another one is damage, found before anything is unpacked.
    """

    def __init__(
        self,
        folder: Path,
        units: Mapping[str, str] | None = None,
        shape: Callable[[str], Shape | None] = lambda name: None,
    ) -> None:
        self.folder = folder
        self._shape = shape
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
        there = {path.stem for path in self.folder.glob(f"*{SUFFIX}") if NAME.fullmatch(path.stem)}
        return sorted(there | self._sums.keys())

    def __contains__(self, name: object) -> bool:
        """True if a file was finished; it may be damaged or gone since."""
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
            return columns_of(self._content(name), columns, self._shape(name))
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
            content = read_contained(self.path(name), self.folder, LARGEST_BLOCK)
        except UnreadableFileError as error:
            raise self._damaged(name, str(error)) from None
        if hashlib.sha256(content).hexdigest() != self._sums.get(name):
            raise self._damaged(name, "not the file that was written: its SHA-256 is another")
        return content

    def _damaged(self, name: str, reason: str) -> RunError:
        return RunError(f"{self.path(name)}: damaged or unreadable ({reason}); {MENDED}")

    def write(self, name: str, columns: Columns) -> None:
        """Write a file, all or nothing; several threads may write different ones."""
        content = parquet_of(columns, self._units)
        sha256 = hashlib.sha256(content).hexdigest()
        write_whole(self.path(name), content)
        with self._adding, named_in_errors(self._list), self._list.open("a", encoding="utf-8") as stream:
            stream.write(_line(name, sha256))
            self._sums[name] = sha256

    def remove(self, names: Sequence[str]) -> None:
        """Take files away."""
        for name in names:
            self.path(name).unlink(missing_ok=True)
            self._sums.pop(name, None)

    def clear(self) -> None:
        """Take all of them away, their list, and the folder if nothing else is in it."""
        self._remove_unfinished()
        self.remove(self.names)
        self._list.unlink(missing_ok=True)
        with suppress(OSError):
            self.folder.rmdir()

    def _remove_unfinished(self) -> None:
        """Delete remains of files that were being written when a process was killed."""
        for path in self.folder.glob(f"*{UNFINISHED}"):
            if path.name == CHECKSUMS + UNFINISHED or NAME.fullmatch(path.name.removesuffix(SUFFIX + UNFINISHED)):
                path.unlink(missing_ok=True)

    def settle(self) -> None:
        """Write the list anew: each file once, no line that a kill or a full disk cut short."""
        self._remove_unfinished()
        write_whole(self._list, "".join(_line(name, self._sums[name]) for name in sorted(self._sums)).encode())


def _line(name: str, sha256: str) -> str:
    return f"{sha256}  {name}{SUFFIX}\n"


def _listed(path: Path) -> Iterator[tuple[str, str]]:
    """Names and checksums of a list; lines that were cut short are none."""
    try:
        lines = read_contained(path, path.parent, LARGEST_LIST).decode("utf-8", errors="replace").splitlines()
    except UnreadableFileError:
        return
    for line in lines:
        sha256, _, file = line.partition("  ")
        name = file.removesuffix(SUFFIX)
        if len(sha256) == 64 and file.endswith(SUFFIX) and NAME.fullmatch(name):
            yield name, sha256
