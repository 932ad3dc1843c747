"""An interrupted analysis goes on: what it evaluated is read, the result is the same, and nothing stays behind."""

from pathlib import Path

import pytest

from tol3d.analyses import kept_batches, rare
from tol3d.analyses.kept_batches import PREFIX
from tol3d.analyses.response import Codes, Response
from tol3d.analyses.subject import subject_of
from tol3d.cli.analysed import asked_of
from tol3d.numerics.arrays import Array
from tol3d.numerics.cache_folder import cache_folder
from tol3d.scene.bundled import scene_path
from tol3d.study.system.trials import Trials

SOME = 3


def test_an_interrupted_analysis_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "pair.yaml"
    scene.write_text(scene_path("spur_pair").read_text() + "# of this test alone\n")
    monkeypatch.setattr(kept_batches, "LONG", 0.0)
    evaluate, asked = Response._in_pieces, list[int]()
    most = 10**6

    def counted(self: Response, trials: Trials) -> tuple[Array, Codes]:
        if len(asked) == most:
            raise KeyboardInterrupt
        asked.append(len(trials))
        return evaluate(self, trials)

    def found() -> list[float | None]:
        subject = subject_of(str(scene))
        with asked_of(subject, "rare"):
            return [own.estimate.probability for own in rare(subject, draws=500).events]

    def files() -> list[Path]:
        return [*cache_folder().glob(f"{PREFIX}{subject_of(str(scene)).batches.owner}-*")]

    monkeypatch.setattr(Response, "_in_pieces", counted)
    truth, whole = found(), len(asked)
    assert whole > SOME
    assert files() == []
    asked.clear()
    most = SOME
    with pytest.raises(KeyboardInterrupt):
        found()
    assert len(files()) == SOME
    assert "the same command resumes from there" in capsys.readouterr().err
    files()[0].write_bytes(b"torn")
    asked.clear()
    most = 10**6
    assert found() == truth
    assert len(asked) == whole - SOME + 1
    assert files() == []
