"""Printed text goes to any terminal, file or pipe, whatever its encoding."""

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from places import SPUR_PAIR

from tol3d.cli.console import PLAIN_SIGNS, PLAINLY, write_plainly

DEFAULT, OTHERS = ("cp1252",), ("cp437", "latin-1", "ascii")
WESTERN = (*DEFAULT, *OTHERS)


@pytest.mark.parametrize(
    ("text", "encoding", "written"),
    [
        ("34.2″, 1′17″ − 0.5 µm", "ascii", '34.2", 1\'17" - 0.5 um'),
        ("34.2″, 1′17″ − 0.5 µm", "cp1252", '34.2", 1\'17" - 0.5 µm'),
        ("σ ±3, Δθ ≥ 2 °", "ascii", "sigma +-3, Deltatheta >= 2 deg"),
        ("größer, Übermaß", "ascii", "gro?er, Uberma?"),
        ("Zahn 歯", "cp1252", "Zahn ?"),
        ("a file \udcff", "utf-8", "a file ?"),  # a name on disk that is no UTF-8
    ],
)
def test_signs_that_an_encoding_lacks_are_written_plainly(text: str, encoding: str, written: str) -> None:
    write_plainly()
    assert text.encode(encoding, PLAINLY).decode(encoding) == written


def test_every_plain_sign_is_ascii_and_no_longer_than_it_must_be() -> None:
    assert all(plain.isascii() and 1 <= len(plain) <= 3 for plain in PLAIN_SIGNS.values())


@pytest.mark.slow
@pytest.mark.parametrize("encoding", [*DEFAULT, *(pytest.param(each, marks=pytest.mark.slow) for each in OTHERS)])
def test_a_report_is_printed_in_any_encoding(encoding: str, tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONIOENCODING": encoding, "PYTHONUTF8": "0"}
    command = [sys.executable, "-m", "tol3d.cli", "run", str(SPUR_PAIR), "--trials", "30", "--engine", "analytic"]
    command += ["--no-picture", "--out", str(tmp_path / "run")]
    done = subprocess.run(command, capture_output=True, env=environment)
    assert done.returncode == 0, done.stderr
    text = done.stdout.decode(encoding)
    assert "normal backlash" in text
    assert "1'" in text  # minutes of arc, which none of these encodings has
    assert b"UnicodeEncodeError" not in done.stderr


def test_what_asks_for_errors_is_left_alone_where_it_cannot(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", io.StringIO())  # a notebook's, which has no encoding
    write_plainly()
    print("σ")
