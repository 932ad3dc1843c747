"""NIST's models with PMI, unpacked: their bytes, their text by crude expressions, and what tol3d reads of them."""

import gzip
import re
from functools import cache
from typing import Final

from places import TESTS

from tol3d.cad.step import StepText, read_step_text

FOLDER: Final = TESTS / "step" / "nist"
FILES: Final = {
    "CTC-01": "nist_ctc_01_asme1_ap242-e1",
    "FTC-07": "nist_ftc_07_asme1_ap242-e2",
    "FTC-10": "nist_ftc_10_asme1_ap242-e2",
    "STC-06": "nist_stc_06_asme1_ap242-e3",
    "STC-07": "nist_stc_07_asme1_ap242-e3",
    "CTC-05": "nist_ctc_05_asme1_ap242-e1",
}
"""The file of each model, in the order in which counts are told."""


@cache
def step_bytes(model: str) -> bytes:
    """A model's file."""
    return gzip.decompress((FOLDER / f"{FILES[model]}.stp.gz").read_bytes())


@cache
def step_text(model: str) -> StepText:
    """Text read from a model."""
    return read_step_text(step_bytes(model), f"{FILES[model]}.stp")


@cache
def bodies(model: str) -> dict[int, str]:
    """The body of each instance, on one line without blanks outside of strings: an oracle that shares no code."""
    text = step_bytes(model).decode("latin-1").replace("\r", "").replace("\n", " ")
    found = re.findall(r"#(\d+)\s*=\s*((?:[^';]|'[^']*')*?)\s*;", text)
    return {int(identifier): re.sub(r"('[^']*')|\s+", r"\1", body) for identifier, body in found}


@cache
def starting(model: str, start: str) -> dict[int, str]:
    """The bodies that begin so, a regular expression."""
    pattern = re.compile(start)
    return {identifier: body for identifier, body in bodies(model).items() if pattern.match(body)}


def references(body: str) -> list[int]:
    """Entities that one refers to."""
    return [int(each) for each in re.findall(r"#(\d+)", body)]
