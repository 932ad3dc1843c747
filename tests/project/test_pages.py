"""README.md and the pages of docs/: what they link to, name and quote exists, and is what they say."""

import re
import sys
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from pkgutil import resolve_name

import pytest
import typer
from places import ROOT
from typer.core import TyperGroup

from tol3d.cli import app
from tol3d.import_path import GROUP
from tol3d.scene.bundled import bundled_scenes

PAGES: Mapping[str, Path] = {
    path.relative_to(ROOT).as_posix(): path for path in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
}
HISTORY = "docs/changelog.md"
"""It names what was there once."""

NAMED = [name for name in PAGES if name != HISTORY]
FOLDERS = ("tol3d", "tests", "benchmarks", "parts", "scenes", "docs", ".ci", ".build")
ROOMS = tuple(sorted(path.name for path in (ROOT / "tol3d").iterdir() if (path / "__init__.py").is_file()))
DASKS_OWN = ("--tls-", "--check")
"""Options that pages name of other programs."""


@cache
def text(page: str) -> str:
    return PAGES[page].read_text("utf-8")


@cache
def prose(page: str) -> str:
    """Without what stands in fences or is indented as code."""
    without = re.sub(r"^```.*?^```", "", text(page), flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^    .*\n", "", without, flags=re.MULTILINE)


# links --------------------------------------------------------------------------------------------------------


def anchors(page: Path) -> set[str]:
    """Anchors of its headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text("utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def links(page: str) -> Iterator[tuple[Path, str]]:
    """Targets inside the tree: the file and the anchor in it."""
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        if not target.startswith(("http:", "https:")):
            file, _, anchor = target.partition("#")
            yield (PAGES[page].parent / file).resolve() if file else PAGES[page], anchor


@pytest.mark.parametrize("page", PAGES)
def test_every_link_leads_somewhere(page: str) -> None:
    broken = [
        (target, anchor)
        for target, anchor in links(page)
        if not target.exists() or (anchor and anchor not in anchors(target))
    ]
    assert broken == []


def test_every_page_and_picture_is_reached_from_the_readme() -> None:
    reached, ahead = set[Path](), [ROOT / "README.md"]
    while ahead:
        path = ahead.pop()
        reached.add(path)
        name = path.relative_to(ROOT).as_posix()
        ahead += [target for target, _ in links(name) if target not in reached] if name in PAGES else []
    there = {path for path in (ROOT / "docs").iterdir() if path.suffix in (".md", ".png", ".webp")}
    assert there - reached == set()


# files and modules --------------------------------------------------------------------------------------------


def named_files(said: str) -> set[str]:
    """Paths from the top of the tree, or from the package as its docstrings write them: `study/tallies/tally.py`."""
    tops, rooms = ("|".join(re.escape(name) for name in names) for names in (FOLDERS, ROOMS))
    path = rf"(?:{tops})/(?:[\w.-]+/)*(?:[\w.-]*\w)?|(?:{rooms})/(?:\w+/)*(?:\w+\.py)?"
    return set(re.findall(rf"(?<![\w/.<-])(?:{path})(?![\w<>*])", said))


def test_a_path_is_read_out_of_a_text() -> None:
    assert named_files("see tests/gears/test_x.py, `study/`, tol3d/scene/load.py. runs/spur_pair") == {
        *("tests/gears/test_x.py", "study/", "tol3d/scene/load.py")
    }
    assert named_files("parts/<kind>.py and https://a/docs/b") == set()


@pytest.mark.parametrize("page", NAMED)
def test_every_file_it_names_is_there(page: str) -> None:
    missing = {
        name for name in named_files(text(page)) if not (ROOT / name).exists() and not (ROOT / "tol3d" / name).exists()
    }
    assert missing == set()


@pytest.mark.parametrize("program", sorted(path.name for path in (ROOT / "benchmarks").glob("*.py")))
def test_every_file_a_benchmark_names_is_there(program: str) -> None:
    said = (ROOT / "benchmarks" / program).read_text("utf-8")
    assert {name for name in named_files(said) if not (ROOT / name).exists()} == set()


@pytest.mark.parametrize("page", NAMED)
def test_every_module_and_name_of_the_package_is_there(page: str) -> None:
    for name in set(re.findall(r"\btol3d(?:\.\w+)+", text(page))) - {GROUP}:
        resolve_name(name)  # raises where there is neither a module nor a name in one


def way_of_the_data() -> list[tuple[str, str]]:
    """Place of each stage in the docstring of simulate.py, and the name to look for there."""
    said = resolve_name("tol3d.simulate").__doc__
    tables = "\n".join(part for part in said.split("\n\n") if part.startswith("    "))
    path = r"(?:\w+/)+[\w.]*"
    rows = [re.search(rf" ({path}(?:, {path})*) +(?:\w+\.)?(\w+)", row) for row in tables.splitlines()]
    return [(row[1], row[2]) for row in rows if row]


def test_the_way_of_the_data_names_what_is_there() -> None:
    """The first thing to read: each stage's file or folder, and in it the name."""
    stages = way_of_the_data()
    assert len(stages) > 15
    for places, name in stages:
        homes = [(ROOT if place.startswith("parts") else ROOT / "tol3d") / place for place in places.split(", ")]
        files = [file for home in homes for file in ([home] if home.is_file() else home.rglob("*.py"))]
        assert any(re.search(rf"\b{name}\b", file.read_text("utf-8")) for file in files), (places, name)


# commands -----------------------------------------------------------------------------------------------------


def options() -> Mapping[str, set[str]]:
    """Options of each command, --help aside."""
    group = typer.main.get_command(app)
    assert isinstance(group, TyperGroup)
    return {
        name: {
            option
            for parameter in command.params
            for option in (*parameter.opts, *parameter.secondary_opts)
            if option.startswith("-")
        }
        for name, command in group.commands.items()
    }


def quoted_commands(page: str) -> Iterator[tuple[str, set[str]]]:
    """Commands of tol3d between backticks, in fences and in blocks: the command, the options that stand with it."""
    code = [*re.findall(r"`(tol3d\s[^`]*)`", prose(page)), *re.findall(r"bin/(tol3d [^\n&]*)", text(page))]
    for quoted in code:
        words = re.sub(r'"[^"]*"', "", quoted).replace("\\|", " ").split()
        if words[1].islower():
            yield words[1], {word.strip("[]") for word in words if re.match(r"\[?--?[a-z]", word)}


@pytest.mark.parametrize("page", NAMED)
def test_every_command_it_quotes_is_one_and_has_those_options(page: str) -> None:
    known = options()
    assert {name for name, _ in quoted_commands(page)} <= set(known)
    assert {(name, option) for name, given in quoted_commands(page) for option in given - known[name]} == set()
    alone = {option for option in re.findall(r"`(--[a-z-][a-z0-9-]*)", prose(page)) if not option.startswith(DASKS_OWN)}
    assert alone <= {"--help", *(option for of_one in known.values() for option in of_one)}


def test_the_manual_s_table_has_every_command_with_every_option() -> None:
    shown: dict[str, set[str]] = {}
    for name, given in quoted_commands("docs/manual.md"):
        shown.setdefault(name, set()).update(given)
    short = {"-q": "--quiet", "-v": "--verbose"}
    found = {name: given | {short[option] for option in given & set(short)} for name, given in shown.items()}
    assert {name: of_one - found[name] for name, of_one in options().items() if of_one - found[name]} == {}


@pytest.mark.parametrize("page", NAMED)
def test_every_benchmark_it_quotes_knows_those_options(page: str) -> None:
    for program, rest in re.findall(r"`(?:python )?(benchmarks/\w+\.py)([^`]*)`", text(page)):
        known = (ROOT / program).read_text("utf-8")
        assert all(f'"{option}"' in known for option in re.findall(r"--[a-z-]+", rest))


@pytest.mark.parametrize("page", NAMED)
def test_every_program_of_the_environment_is_installed(page: str) -> None:
    programs = set(re.findall(r"\.venv/bin/([\w-]+)", text(page))) - {"pip"}  # uv's environments have none
    assert {name for name in programs if not Path(sys.executable).with_name(name).exists()} == set()


@pytest.mark.parametrize("page", NAMED)
def test_every_extra_is_declared(page: str) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert set(re.findall(r"(?:tol3d|\.)\[(\w+)\]", text(page))) <= set(project["optional-dependencies"])


# what single pages promise ------------------------------------------------------------------------------------


def test_the_manual_names_every_bundled_scene() -> None:
    paragraph = next(each for each in text("docs/manual.md").split("\n\n") if each.startswith("`SCENE` is a file"))
    assert set(re.findall(r"`(\w+)`", paragraph)) - {"SCENE"} == set(bundled_scenes())


def test_the_page_of_benchmarks_names_every_program() -> None:
    named = set(re.findall(r"benchmarks/(\w+\.py)", text("docs/benchmarks.md")))
    assert named == {path.name for path in (ROOT / "benchmarks").glob("*.py")}


def test_the_newest_version_is_the_first_of_the_changelog() -> None:
    first = re.search(r"^## (\S+)", text(HISTORY), re.MULTILINE)
    version = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    assert first is not None
    assert first[1] == version.removesuffix(".dev0")


def section(page: str, heading: str) -> str:
    return re.split(r"^## ", text(page).partition(f"## {heading}\n")[2], flags=re.MULTILINE)[0]


def test_the_readme_s_figures_are_those_of_the_pages() -> None:
    """Accuracy and speed: every number with its unit stands on the page that a test holds."""
    said = section("README.md", "How accurate, how fast")
    pages = text("docs/validation.md") + text("docs/benchmarks.md")
    numbers = re.findall(r"\d+(?:\.\d+)?(?:e-?\d+)?(?= (?:µm|million|steps))", said)
    assert len(numbers) >= 6
    assert [number for number in numbers if not re.search(rf"(?<![\d.]){re.escape(number)}(?![\d.])", pages)] == []


SOURCE = ("Jiang, Zhong, Lü, Lai, Jin", "Gear backlash modeling and", "doi.org/10.3785/j.issn.1008-973X.2024.08.001")
"""Authors, title and DOI of the paper that the robot is from, on the page that README leads to."""


@pytest.mark.parametrize(
    ("page", "words"),
    [
        ("docs/paper.md", SOURCE),
        ("docs/comparison.md", ("3DCS", "KISSsoft", "otaf", "a spreadsheet", "made for", "loads, strength")),
        ("docs/manual.md", ("GB", "the first of the two commands took", "Linux x86-64 with Python", "Windows are not")),
    ],
)
def test_what_a_stranger_asks_first_is_in_the_readme_or_a_page_that_it_links(page: str, words: tuple[str, ...]) -> None:
    """Whose robot, what others do better, what it takes to set up and where it runs."""
    readme = text("README.md")
    assert f"]({page})" in readme
    assert SOURCE[-1] in readme
    assert "## What it is not for" in readme
    assert [word for word in words if word not in text(page)] == []


WORDS_A_MINUTE = 240


def test_the_readme_is_read_in_three_minutes() -> None:
    """Its prose: what is printed and the scene are looked at rather than read."""
    assert len(re.sub(r"\]\([^)]*\)", "]", prose("README.md")).split()) < 3 * WORDS_A_MINUTE


def test_no_sentence_stands_on_two_pages() -> None:
    """Sentences of a dozen words and more; tables and code aside."""
    where: dict[str, set[str]] = {}
    for page in PAGES:
        lines = " ".join(line for line in prose(page).splitlines() if not line.startswith("|"))
        for sentence in re.split(r"(?<=[.;:]) ", " ".join(lines.split())):
            if len(sentence.split()) >= 12:
                where.setdefault(sentence.casefold(), set()).add(page)
    assert {sentence: pages for sentence, pages in where.items() if len(pages) > 1} == {}
