"""The commands that README.md and the pages of docs/ show, run as they stand there, page by page in their order.

Bundled scenes have few trials here: a file of the scene's name lies in the folder, which comes before the bundled one.
"""

import re
import shlex
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import pytest
import typer
from fixtures import Command
from places import ROOT, SCENES
from typer.core import TyperGroup

from tol3d import load_scene
from tol3d.cli import app
from tol3d.scene.bundled import bundled_scenes

TRIALS: Final = 64
HISTORY: Final = {"changelog.md"}
"""It quotes what was there once."""

OTHERS: Final = {"records.md": "tests/records/test_records_page.py"}
"""Pages whose commands another test runs."""

PLACEHOLDER: Final = re.compile(r"…|\||\[|\b[A-Z]{3,}\b|--from$|design \w+$|export --format step$")
READ_ONLY: Final = (
    r"^tol3d view (?!.*--(?:screenshot|animate))",  # opens a window
    r"^tol3d view .*--animate",  # takes long to draw; tests/report/test_animation.py looks at such films
    r"^tol3d app ",  # serves until Ctrl-C
    r"^tol3d check spherical_drive",  # compiles for long; tests/linkage looks at its tables
    r"^tol3d allocate gearbox_in_housing ",  # takes minutes; the same for spur_pair_25.yaml is run
    r"^tol3d new --from .* --seat ",  # of two files of the reader's; tests/drafting runs it
)
"""Commands that are not run: the command line's own parser reads them, and scenes that they name are there."""


def quoted(text: str) -> Iterator[str]:
    """Whole commands of a page, in their order; one without arguments is a command's name in a sentence."""
    joined = re.sub(r"\\\n\s*", " ", text)
    inline, block, behind = r"`(tol3d\s[^`]*)`", r"^(?: {4})?(?:\.venv/bin/)?(tol3d [^\n]*)$", r"bin/(tol3d [^\n&`]*)"
    for found in re.finditer("|".join((inline, block, behind)), joined, re.MULTILINE):
        command = " ".join(next(filter(None, found.groups())).split()).partition(" # ")[0].strip()
        words = command.split()
        if len(words) > 2 and words[1] in COMMANDS and not PLACEHOLDER.search(command):
            yield command


def is_read_only(command: str, later: Sequence[str]) -> bool:
    """Also a plain run of a bundled scene that no later command goes on from: tests/scenes runs every one of them."""
    plain = re.fullmatch(r"tol3d run (\w+)", command)
    if plain and plain[1] in bundled_scenes():
        return not any(f"runs/{plain[1]}" in each and not is_read_only(each, ()) for each in later)
    return any(re.search(own, command) for own in READ_ONLY)


GROUP: Final = typer.main.get_command(app)
assert isinstance(GROUP, TyperGroup)
COMMANDS: Final = GROUP.commands
DEAR: Final = ("step.md", "planetary.md")
"""Pages whose commands take most of a minute: nightly."""
PAGES: Final[Mapping[str, list[str]]] = {
    page.name: commands
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
    if page.name not in HISTORY | OTHERS.keys() and (commands := [*dict.fromkeys(quoted(page.read_text("utf-8")))])
}


def thin(name: str, **changes: object) -> str:
    """A bundled scene with few trials."""
    scene = load_scene(name)
    fewer: dict[str, object] = {"study.witness": 2} if scene.study.witness > 2 else {}
    if scene.study.trials != "auto" and scene.study.trials > TRIALS:
        fewer["study.trials"] = TRIALS
    return scene.with_({**fewer, **changes}).dump()


@pytest.fixture(scope="module")
def thinned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of a page's reader: every bundled scene that a page names, with few trials, and what these read."""
    folder = tmp_path_factory.mktemp("thinned")
    commands = [(command, page[k + 1 :]) for page in PAGES.values() for k, command in enumerate(page)]
    named = {word for command, later in commands if not is_read_only(command, later) for word in command.split()[2:]}
    for name in named & set(bundled_scenes()):
        (folder / name).write_text(thin(name), "utf-8")
    for path in SCENES.glob("*.csv"):
        shutil.copy(path, folder)
    return folder


def prepare(page: str, tol3d: Command) -> None:
    """Files and runs of the reader's own that a page goes on from."""
    if page == "README.md":
        Path("scenes").mkdir()
        Path("scenes/spur_pair.yaml").write_text(thin("spur_pair"), "utf-8")
    elif page == "analyses.md":
        limit = {"measures.normal backlash.lower_limit": "25 um"}
        Path("spur_pair_25.yaml").write_text(thin("spur_pair", **limit), "utf-8")
    elif page == "assemblies.md":
        Path("scene.yaml").write_text(thin("two_plates"), "utf-8")
    elif page == "rexs.md":
        shutil.copy(ROOT / "tests" / "drafting" / "spur_stage.rexs", "gearbox.rexs")
    elif page == "gear_engineers.md":
        (scene,) = re.findall(r"```yaml\n(.*?)```", (ROOT / "docs" / page).read_text("utf-8"), re.DOTALL)
        Path("edited.yaml").write_text(scene.replace("trials: 10000", f"trials: {TRIALS}"), "utf-8")
    elif page == "step.md":
        for name, file in (
            ("box", "nist_ctc_01"),
            ("cover", "nist_ftc_10"),
            ("nist_ftc_10_asme1_ap242-e2", "nist_ftc_10"),
        ):
            shutil.copy(SCENES / f"{file}.stp", f"{name}.stp")
    elif page == "manual.md":
        for name in ("spur_pair", "before", "after"):
            assert tol3d("run", "spur_pair", "--out", f"runs/{name}")[0] == 0


def test_a_command_is_read_out_of_a_page() -> None:
    page = "as `tol3d check` says\n```\ntol3d run a.yaml \\\n    --out first  # here\ntol3d view RUN --worst\n```\n"
    assert [*quoted(page)] == ["tol3d run a.yaml --out first"]


def test_pages_whose_commands_others_run_are_there() -> None:
    assert all((ROOT / "docs" / page).is_file() and (ROOT / test).is_file() for page, test in OTHERS.items())


@pytest.mark.parametrize(
    "page", [pytest.param(own, marks=pytest.mark.nightly if own in DEAR else pytest.mark.slow) for own in PAGES]
)
def test_the_commands_of_a_page_run_as_they_stand(
    page: str, thinned: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tol3d: Command
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(thinned, tmp_path, dirs_exist_ok=True)
    prepare(page, tol3d)
    for k, command in enumerate(PAGES[page]):
        line, _, file = command.partition(" > ")
        name, *arguments = shlex.split(line)[1:]
        if is_read_only(command, PAGES[page][k + 1 :]):
            COMMANDS[name].make_context(name, arguments)
            continue
        code, out, err = tol3d(name, *arguments)
        assert code == 0, (command, err)
        if file:
            Path(file).write_text(out, "utf-8")
