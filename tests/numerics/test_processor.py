"""Results belong to a kind of processor: nothing of two kinds is mixed in a run."""

import json
import os
import platform
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from fixtures import Command
from gear_trials import simulated
from places import SPUR_PAIR

from tol3d.errors import RunError
from tol3d.gearing.model import Model
from tol3d.numerics.processor import processor, unlike
from tol3d.simulate import Execution, Overrides, replay, run_scene
from tol3d.study.results.replaying import ElsewhereWarning
from tol3d.study.results.task import Task
from tol3d.study.results.versions import installed_versions, refuse_other_versions
from tol3d.study.runs.run import open_run

ARITHMETIC = re.compile(r"s?sse|avx|fma|xop|f16c|amx")  # features of x86 that floating-point instructions depend on
STUDY = Overrides(trials=50, engine="analytic", witness=0)
OTHER_NUMPY = "NPY_DISABLE_CPU_FEATURES"


@pytest.fixture
def generic(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As if this were a processor for which the compiler knows no name."""
    monkeypatch.setenv("NUMBA_CPU_NAME", "generic")
    forget()
    yield
    monkeypatch.undo()
    forget()


def forget() -> None:
    for kept in (processor, installed_versions, refuse_other_versions):
        kept.cache_clear()


def elsewhere(code: str, **environment: str) -> str:
    """Output of Python in another environment."""
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | environment, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


@pytest.mark.slow
@pytest.mark.skipif(platform.machine().lower() not in ("x86_64", "amd64"), reason="the names are of x86")
def test_what_the_compiler_is_told_to_make_code_for_is_what_it_is_named_by() -> None:
    target = "from numba.core.registry import cpu_target; print(*cpu_target.target_context.codegen().magic_tuple()[1:])"
    own = "from tol3d.numerics.processor import processor; print(processor()['processor'], processor()['instructions'])"
    for settings in ({}, {"NUMBA_CPU_NAME": "generic"}, {"NUMBA_CPU_NAME": "skylake", "NUMBA_CPU_FEATURES": "+avx2"}):
        compiled_for, told = elsewhere(target, **settings).split(), elsewhere(own, **settings).split()
        assert told[0] == compiled_for[0]
        used = {name.removeprefix("+") for name in "".join(compiled_for[1:]).split(",") if name.startswith("+")}
        assert set("".join(told[1:]).split(",")) - {""} == {name for name in used if ARITHMETIC.match(name)}


def test_loops_that_numpy_leaves_out_are_told() -> None:
    found = [name for name in processor()["numpy instructions"].split(",") if name]
    if not found:
        pytest.skip("NumPy has no loops of its own for this processor")
    words = "from tol3d.numerics.processor import processor; print(processor()['numpy instructions'])"
    assert elsewhere(words, **{OTHER_NUMPY: " ".join(found)}) == ""


def test_lists_are_told_apart_by_what_only_one_has() -> None:
    assert unlike("avx,avx2,avx512f,fma", "avx,avx2,fma") == ("avx512f", "nothing more")
    assert unlike("avx", "avx,fma,sse") == ("nothing more", "fma,sse")
    assert unlike("1.2.3", "1.2.4") == ("1.2.3", "1.2.4")
    assert unlike(None, "a,b") == (None, "a,b")


def test_a_run_of_another_processor_is_not_gone_on_with(
    tmp_path: Path, request: pytest.FixtureRequest, tol3d: Command
) -> None:
    run = run_scene(SPUR_PAIR, overrides=STUDY, out=tmp_path / "run")
    run.path.replace(tmp_path / "run.partial")  # as if its end had been cut off
    here = processor()["processor"]
    fingerprint = run.fingerprint
    assert fingerprint["versions"]["processor"] == here
    (tmp_path / "run.partial" / "fingerprint.json").write_text(json.dumps(fingerprint, sort_keys=True, indent=1))
    request.getfixturevalue("generic")
    with pytest.raises(RunError, match=f"versions: processor {here} there, generic now"):
        run_scene(SPUR_PAIR, overrides=STUDY, out=tmp_path / "run", execution=Execution(resume=True))
    arguments = ("--trials", "50", "--engine", "analytic", "--witness", "0", "--out", str(tmp_path / "run"))
    code, _, err = tol3d("run", str(SPUR_PAIR), *arguments, "--resume", "--no-picture")
    assert (code, f"processor {here} there, generic now" in " ".join(err.split())) == (2, True)


def test_a_worker_of_another_processor_is_refused(paper_model: Model, request: pytest.FixtureRequest) -> None:
    asked = installed_versions()
    request.getfixturevalue("generic")
    with pytest.raises(RunError, match=r"a worker has processor generic instead of .*last bit"):
        Task(simulated(paper_model, engine="analytic"), None, {}, "other", True, asked).columns(0, 1)


def test_a_trial_of_another_processor_again_is_told_of(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    run = run_scene(SPUR_PAIR, overrides=STUDY, out=tmp_path / "run")
    first = replay(run, 7).analytic
    request.getfixturevalue("generic")
    with pytest.warns(ElsewhereWarning, match="made elsewhere .*generic now"):
        assert replay(open_run(run.path), 7).analytic == first


MEASURED = """
import sys
from tol3d.simulate import Overrides, run_scene
run_scene(sys.argv[1], overrides=Overrides(trials=2000, witness=0), out=sys.argv[2])
"""


@pytest.mark.slow
def test_other_instructions_change_bits_and_the_run_says_so(tmp_path: Path) -> None:
    runs = []
    for name, settings in (("here", {}), ("generic", {"NUMBA_CPU_NAME": "generic"})):
        command = [sys.executable, "-c", MEASURED, str(SPUR_PAIR), str(tmp_path / name)]
        subprocess.run(command, env=os.environ | settings, check=True)
        runs.append(open_run(tmp_path / name))
    here, there = (np.asarray(run.columns("geometric:normal backlash")["geometric:normal backlash"]) for run in runs)
    # lengths of 172.5 mm in doubles are steps of 2.8e-11 um; a contact adds up some hundred of them
    assert np.abs(here - there).max() < 1e-8
    if processor()["instructions"]:
        assert runs[0].fingerprint["versions"] != runs[1].fingerprint["versions"]
        assert not np.array_equal(here, there)
