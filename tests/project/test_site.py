"""The site: built from docs/ with warnings as errors, opened from the file system in a browser without a network."""

import re
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import pytest
from browser import Page, browser
from places import ROOT
from pydantic import Field
from scene_reference import Reference, UndescribedError, reference_pages

from tol3d.kinds import all_kinds
from tol3d.scene import Grammar, Vocabulary
from tol3d.scene.bases import Length, PartSpec
from tol3d.scene.entry import kind_of

DOCS = ROOT / "docs"
WIDE = "article :is(p, li, h1, h2, h3, pre, .table-wrapper, .cell_output)"  # what the page must hold


class CamSpec(PartSpec):
    """A cam of another package."""

    kind: Literal["cam"]
    lift: Length = Field(description="how far it lifts")


class BareSpec(PartSpec):
    """A part of whose field nothing is said."""

    kind: Literal["bare"]
    weight: float


# the scene reference ------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pages() -> dict[str, str]:
    """Those of every kind that is shipped: made only where every field has a description."""
    return reference_pages(all_kinds(), DOCS)


def test_the_reference_is_that_of_the_grammar(pages: dict[str, str]) -> None:
    """`python docs/scene_reference.py` writes it anew."""
    assert {path.stem: path.read_text("utf-8") for path in (DOCS / "reference").glob("*.md")} == pages


def test_every_kind_is_on_a_page_with_its_fields_and_an_example(pages: dict[str, str]) -> None:
    shown = defaultdict[str, list[set[str]]](list)
    for entry in re.split(r"^##+ ", "\n".join(pages.values()), flags=re.MULTILINE):
        own = re.findall(r"^\| `([^`]+)` \|", entry, re.MULTILINE)
        also = re.findall("^Also, as above: (.*)", entry, re.MULTILINE)
        if "```yaml\n" in entry:
            shown[entry.partition("\n")[0]].append({*own, *re.findall(r"\w+", "".join(also))})
    for vocabulary in all_kinds().vocabularies:
        for spec in (*vocabulary.parts, *vocabulary.tolerances, *vocabulary.moves, *vocabulary.measures):
            fields = {field.alias or name for name, field in spec.model_fields.items()} - {"kind"}
            assert fields in shown[f"`{kind_of(spec)}`"], spec


def test_a_field_has_its_unit_default_and_values(pages: dict[str, str]) -> None:
    rows = pages["gearing"] + pages["scene_file"]
    assert "| `pressure_angle` | angle | `20 deg` |" in rows
    assert "| `teeth` | whole number ≥ 1, ≤ 10000 | required |" in rows
    assert "| `facing` | `forward`, `backward` | `forward` |" in rows
    assert "| `sampler` | `monte_carlo`, `sobol`, `latin_hypercube` | `monte_carlo` |" in rows


def pages_with(spec: type[PartSpec]) -> dict[str, str]:
    return Reference(Grammar((*all_kinds().vocabularies, Vocabulary("workshop", parts=(spec,)))), []).pages()


def test_a_kind_that_is_registered_has_a_page_by_itself() -> None:
    made = pages_with(CamSpec)["workshop"]
    assert made.startswith("# Kinds of workshop\n")
    assert "### `cam`\n\nA cam of another package.\n" in made
    assert "| `lift` | length | required | how far it lifts |" in made


def test_a_field_without_a_description_is_refused() -> None:
    with pytest.raises(UndescribedError, match=r"^1 fields of scenes lack a description: BareSpec\.weight$"):
        pages_with(BareSpec)


# the site -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built site; python.md is run as a notebook."""
    out = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-j", "2", str(DOCS), str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)  # s; a guard against hanging
    assert done.returncode == 0, done.stderr
    return out


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    with browser() as opened:
        yield opened


@pytest.mark.slow
def test_every_page_is_opened_without_network_or_error_and_nothing_leaves_a_narrow_window(
    site: Path, page: Page
) -> None:
    built = sorted(path for path in site.rglob("*.html") if "_static" not in path.parts)
    assert {path.stem for path in DOCS.glob("*.md")} <= {path.stem for path in built}
    for path in built:
        page.open(path, 390)
        assert page.ask("document.documentElement.scrollWidth <= innerWidth"), path
        beyond = f"[...document.querySelectorAll('{WIDE}')].filter(e => !e.parentElement.closest('.table-wrapper, pre, "
        beyond += (
            ".cell_output') && e.getBoundingClientRect().right > innerWidth + 1).map(e => e.textContent.slice(0, 60))"
        )
        assert page.ask(beyond) == [], path
    assert page.told == []
    assert [url for url in page.asked if not url.startswith(("file:", "data:"))] == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("word", "found"), [("carrier_pins", "reference/machine.html"), ("kisssoft", "comparison.html")]
)
def test_a_search_finds_the_page(site: Path, page: Page, word: str, found: str) -> None:
    page.call("Page.navigate", url=f"{(site / 'search.html').as_uri()}?q={word}")
    page.wait("document.querySelectorAll('#search-results li a').length > 0")
    hits = page.ask("[...document.querySelectorAll('#search-results li a')].map(a => a.href)")
    assert any(found in hit for hit in hits), hits


@pytest.mark.slow
def test_the_notebook_shows_its_results(site: Path) -> None:
    text = (site / "python.html").read_text("utf-8")
    assert text.count("cell_output") > 10
    assert "verdict" in text
    assert '<img alt="' in text
