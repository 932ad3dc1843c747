"""Commands of registered mechanisms, in this process; tests/project/test_add_a_mechanism.py installs a package."""

import pytest
from fixtures import Command
from toys import registered

from tol3d.study.system.mechanism import Mechanism

PLACES = Mechanism(name="places", commands=(f"{__name__}:least_place", f"{__name__}:broken_place"))


def least_place(words: list[str], *, last: bool = False) -> None:
    """Print the first of some words by the alphabet."""
    print(sorted(words)[-1 if last else 0])


def broken_place() -> None:
    """Divide by nothing."""
    print(1 / 0)


def run() -> None:
    """Take the place of tol3d's own command."""
    raise AssertionError


def test_an_application_has_commands_and_no_kinds(tol3d: Command) -> None:
    with registered.known(PLACES):
        assert tol3d("least-place", "b", "a", "c") == (0, "a\n", "")
        assert tol3d("least-place", "b", "a", "c", "--last") == (0, "c\n", "")
        code, out, err = tol3d("--help")
        code_of_its_own, words, _ = tol3d("least-place", "--help")
    assert (code, err, code_of_its_own) == (0, "", 0)
    assert out.index(" least-place ") > out.index(" schema ")
    assert "Print the first of some words by the alphabet." in words
    code, _, err = tol3d("least-place", "b")
    assert code == 2
    assert "No such command 'least-place'" in err


def test_its_fault_is_reported_to_its_authors(tol3d: Command) -> None:
    with registered.known(PLACES):
        code, _, err = tol3d("broken-place")
    assert code == 3
    assert (
        f"a fault in the mechanism 'places' (Python module '{__name__}'), not in your scene: ZeroDivisionError" in err
    )
    assert "please report it to its authors" in err


@pytest.mark.parametrize(
    ("path", "why"),
    [
        (f"{__name__}:run", "there is a command 'run' already"),
        (f"{__name__}:least_place", "there is a command 'least-place' already"),
        ("no_such_module:command", "No module named 'no_such_module'"),
    ],
)
def test_one_that_cannot_be_used_is_told_of_and_the_others_are_as_ever(path: str, why: str, tol3d: Command) -> None:
    with registered.known(PLACES, Mechanism(name="others", commands=(path,))):
        code, out, err = tol3d("least-place", "b", "a")
    assert (code, out) == (0, "a\n")
    assert err == f"warning: others: its command {path} cannot be used: {why}\n"
