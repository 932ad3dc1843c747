"""Damaged STEP files by a seed: read or refused in one line, within a limit, and nothing outside of the folder is read.

Two hundred of them, which are drafted too: benchmarks/step_mutations.py.
"""

from collections import Counter
from pathlib import Path

import pytest
from step_mutations import DAMAGES, bases, tried, variants, watch

from tol3d.cad.step.reading import MEGABYTES_VARIABLE, SECONDS_VARIABLE

NUMBER, SEED = 20, 5


def test_twenty_damaged_files_are_read_or_refused_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(SECONDS_VARIABLE, "10")
    monkeypatch.setenv(MEGABYTES_VARIABLE, "4000")
    folder = tmp_path / "inner"
    folder.mkdir()
    texts = bases(folder)
    (tmp_path / "secret.stp").write_text(texts["block.stp"], "latin-1")
    watch()
    kinds: Counter[str] = Counter()
    outcomes: Counter[str] = Counter()
    for _, base, kind, text in variants(texts, SEED, NUMBER):
        assert text != texts[base]
        found = tried(text, folder, drafts=kind == "files elsewhere")
        assert found.outcome != "fault", f"{kind} of {base}: {found.words}"
        kinds[kind] += 1
        outcomes[found.outcome] += 1
    assert {*kinds} == {*DAMAGES}
    assert outcomes["refused"] >= NUMBER // 2
    assert outcomes["read"] >= 1


def test_what_is_not_damaged_is_drafted(tmp_path: Path) -> None:
    """The files from which damages are drawn, so that refusals are of the damage."""
    texts = bases(tmp_path)
    assert {"block.stp", "assembly.stp", "parted.stp"} < {*texts}
    assert [tried(texts[name], tmp_path).outcome for name in ("block.stp", "assembly.stp", "parted.stp")] == [
        "drafted"
    ] * 3
