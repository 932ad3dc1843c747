"""The names that a user gives to parts, tolerances, moves, measures and columns, and remarks that are printed."""

import unicodedata
from typing import Annotated

from pydantic import AfterValidator, Field

from tol3d.strict import refused
from tol3d.units import shown

LONGEST_NAME = 80  # characters; names become columns of tables and headings of reports
LONGEST_REMARK = 2000  # characters; a page
FORBIDDEN = "/\\:"  # they would make paths, and mark the method in the columns of a result
INVISIBLE = {"Cc", "Cf", "Cs", "Zl", "Zp"}  # Unicode categories: control, format, surrogates, line and paragraph ends
COMPONENT_ENDINGS = (".x", ".y")  # columns of a result end so where a contributor has two components


def checked_title(name: str) -> str:
    """The name of a scene as it is kept, NFC-normalised: files and columns of results are not called by it.

    Raises:
        PydanticCustomError: no such text may be a name.
    """
    if not name or name != name.strip():
        raise refused("", "a name without spaces around it", shown(name))
    if len(name) > LONGEST_NAME:
        raise refused("", f"a name of up to {LONGEST_NAME} characters", f"{len(name)} of them")
    if any(unicodedata.category(c) in INVISIBLE for c in name):
        raise refused("", "a name without line breaks or invisible characters", shown(name))
    return unicodedata.normalize("NFC", name)


def checked_name(name: str) -> str:
    """The name of an entry as it is kept, NFC-normalised.

    Raises:
        PydanticCustomError: no such text may be a name.
    """
    name = checked_title(name)
    if any(c in FORBIDDEN for c in name):
        raise refused("", r"a name without / \ :", shown(name))
    if name.endswith(COMPONENT_ENDINGS):
        raise refused("", 'a name that does not end in ".x" or ".y" (columns of results do)', shown(name))
    return name


_LENGTH = Field(json_schema_extra={"minLength": 1, "maxLength": LONGEST_NAME})
Name = Annotated[str, AfterValidator(checked_name), _LENGTH]
"""Any text of 1 to 80 characters without / \\ : or invisible characters, NFC-normalised."""
Title = Annotated[str, AfterValidator(checked_title), _LENGTH]
"""The name of a scene: any text of 1 to 80 visible characters, NFC-normalised."""


def _one_line(text: str) -> str:
    words = " ".join(text.split())
    if len(words) > LONGEST_REMARK:
        raise refused("", f"a text of up to {LONGEST_REMARK} characters", f"{len(words)} of them")
    if any(unicodedata.category(sign) in INVISIBLE for sign in words):
        raise refused("", "a text without invisible characters", shown(words))
    return words


Remark = Annotated[str, AfterValidator(_one_line), Field(json_schema_extra={"maxLength": LONGEST_REMARK})]
"""Words that are printed below a table: up to 2000 characters in one line, however they were wrapped."""
