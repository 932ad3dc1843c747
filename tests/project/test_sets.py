"""Tests that tests/sets.toml takes out of the default are there; for nightly ones a quicker test finds a mutant."""

import re
import tomllib

import pytest
from places import ROOT
from thinned import CI, KEPT, NIGHTLY, SETS, SLOW

MUTANTS = {
    entry["fault"]: entry["tests"]
    for entry in tomllib.loads((ROOT / "tests" / "mutants.toml").read_text("utf-8"))["mutant"]
    if "nightly" not in entry
}


def defined(test: str) -> bool:
    file, _, name = test.partition("::")
    return bool(re.search(rf"^def {name}\(", (ROOT / file).read_text("utf-8"), re.MULTILINE))


def test_tests_that_are_listed_are_there() -> None:
    assert [test for test in (*SLOW, *CI, *NIGHTLY) if not defined(test)] == []
    assert len(NIGHTLY) == len(SETS["nightly"])
    assert KEPT.keys() <= CI.keys()
    assert not CI.keys() & NIGHTLY.keys()
    assert all(every > 1 for every in CI.values())


@pytest.mark.parametrize("entry", NIGHTLY.values(), ids=lambda entry: entry["test"].rpartition("::")[2])
def test_a_quicker_test_of_ci_stands_for_a_nightly_one_and_finds_a_mutant(entry: dict[str, str]) -> None:
    assert set(entry) == {"test", "quicker", "mutant"}
    assert defined(entry["quicker"])
    assert entry["quicker"] not in NIGHTLY
    assert entry["quicker"] in {test.partition("[")[0] for test in MUTANTS[entry["mutant"]]}


def test_no_test_that_finds_a_mutant_is_left_out_whole() -> None:
    assert NIGHTLY.keys() & {test.partition("[")[0] for tests in MUTANTS.values() for test in tests} == set()
