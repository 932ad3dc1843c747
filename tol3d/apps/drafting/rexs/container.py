"""Containers of REXS: XML and JSON as they are, and zip with one of them in it."""

import io
import lzma
import zipfile
import zlib
from pathlib import Path
from typing import Final

from tol3d.apps.drafting.rexs.document import Document, RexsError
from tol3d.apps.drafting.rexs.json_text import read_json
from tol3d.apps.drafting.rexs.xml_text import read_xml
from tol3d.cad.step import shown
from tol3d.files import FileContent

ENDINGS: Final = (".rexs", ".rexsj", ".rexsz", ".rexs.zip")
IN_ZIP: Final = (".rexs", ".rexsj", ".xml", ".json")
RUBBISH: Final = ("__MACOSX/", "._")
LARGEST_TEXT: Final = 20_000_000  # bytes unpacked; as of every file that tol3d reads
MOST_MEMBERS: Final = 1000  # files in a zip
DAMAGED: Final = (
    zipfile.BadZipFile, zlib.error, lzma.LZMAError, NotImplementedError, RuntimeError, EOFError, OSError, ValueError,
)  # fmt: skip
"""What the reader of zips raises on damaged, encrypted and unknown ones."""
BLANKS: Final = b"\xef\xbb\xbf \t\r\n"


def is_rexs(path: Path) -> bool:
    """True if a file's name is that of a REXS file."""
    return path.name.lower().endswith(ENDINGS)


def read_document(content: FileContent) -> Document:
    """A document of a file, by its content: the name only decides that it is REXS.

    Raises:
        RexsError: it cannot be read.
    """
    data = content.content
    if data.startswith(b"PK"):
        data = unpacked(data)
    if data.lstrip(BLANKS)[:1] in (b"{", b"["):
        return read_json(data)
    return read_xml(data)


def unpacked(data: bytes) -> bytes:
    """The one REXS text of a zip.

    Raises:
        RexsError: it is damaged, encrypted or too large, or has no such text, or several.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            members = packed.infolist()
            if len(members) > MOST_MEMBERS:
                raise RexsError(f"expected at most {MOST_MEMBERS} files in the zip, got {len(members)}")
            texts = [own for own in members if own.filename.lower().endswith(IN_ZIP) and not _is_rubbish(own.filename)]
            texts = [own for own in texts if is_rexs(Path(own.filename))] or texts
            if len(texts) != 1:
                names = ", ".join(shown(own.filename) for own in texts[:4])
                raise RexsError(f"expected one .rexs or .rexsj in the zip, got {len(texts)}{names and ': '}{names}")
            with packed.open(texts[0]) as stream:
                text = stream.read(LARGEST_TEXT + 1)
    except DAMAGED as error:
        raise RexsError(f"expected a zip that can be unpacked, got: {shown(error)}") from None
    if len(text) > LARGEST_TEXT:
        raise RexsError(f"{shown(texts[0].filename)}: expected at most {LARGEST_TEXT // 10**6} MB unpacked")
    return text


def _is_rubbish(name: str) -> bool:
    return name.startswith(RUBBISH) or name.rpartition("/")[2].startswith(RUBBISH)
