"""The site: how Sphinx builds the pages of this folder. contributing.md says by which command.

Pages are written to be read as files too. What only the site has is made here: the scene reference, pages of the files
of the tree that others link, and the outputs of python.md, which is run as a notebook.
"""

import re
import sys
from pathlib import Path
from typing import Any

DOCS = Path(__file__).resolve().parent
TREE = DOCS.parent
sys.path.insert(0, str(DOCS))

from scene_reference import reference_pages  # noqa: E402, lies beside this file

from tol3d.kinds import all_kinds  # noqa: E402

project = "tol3d"
author = "the tol3d authors"
copyright = f"2026, {author}"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]

myst_heading_anchors = 4  # as file views make them, so that links work in both

nb_execution_mode = "auto"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 120  # s a cell
nb_merge_streams = True

default_role = "code"  # of single backticks in docstrings
smartquotes = False
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True

html_theme = "furo"
html_title = "tol3d"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_search_summary = False  # excerpts are fetched, which browsers refuse from the file system
html_copy_source = False
html_use_index = False  # the search finds names, too
html_domain_indices = False

MADE = DOCS / "reference"  # pages that git ignores are in its folder tree
LINK = re.compile(r"\]\(\.\./([^)#]+)(#[^)]*)?\)")
LANGUAGES = {".yaml": "yaml", ".py": "python", ".toml": "toml"}
NOTEBOOK = "---\nfile_format: mystnb\nkernelspec: {name: python3, display_name: Python 3}\n---\n"


def place_of(file: str) -> str:
    """The page of a file of the tree, from the top of the site."""
    return f"/reference/tree/{file.removesuffix('.md').lower()}.md"


def page_of(file: str) -> str:
    """The text of that page."""
    path = TREE / file
    if path.suffix == ".md":
        return "---\norphan: true\n---\n" + re.sub(r"\]\(docs/", "](/", path.read_text("utf-8"))
    up = "../" * (3 + file.count("/"))
    include = f"```{{literalinclude}} {up}{file}\n:language: {LANGUAGES.get(path.suffix, 'text')}\n```\n"
    return f"---\norphan: true\n---\n# {file}\n\n{include}"


def write_pages(app: Any) -> None:
    """Write the pages that are made, where they have changed; others that were made before are deleted."""
    linked = {own[1] for page in DOCS.glob("*.md") for own in LINK.finditer(page.read_text("utf-8"))}
    pages = {MADE / f"{name}.md": text for name, text in reference_pages(all_kinds(), DOCS).items()}
    pages |= {DOCS / place_of(file)[1:]: page_of(file) for file in linked}
    for old in set(MADE.rglob("*.md")) - pages.keys():
        old.unlink()
    for path, text in pages.items():
        if not path.exists() or path.read_text("utf-8") != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8")


def as_the_site_reads(app: Any, name: str, source: list[str]) -> None:
    """Links that leave the folder lead to pages, and the blocks of python.md are cells."""
    source[0] = LINK.sub(lambda own: f"]({place_of(own[1])}{own[2] or ''})", source[0])
    if name == "python":
        source[0] = NOTEBOOK + re.sub(r"^```python\n", "```{code-cell}\n", source[0], flags=re.MULTILINE)


def first_sentence(app: Any, what: str, name: str, found: object, options: object, lines: list[str]) -> None:
    """Keep the first line of a module's docstring: the rest is for readers of its source."""
    if what == "module":
        del lines[1:]


def setup(app: Any) -> None:
    """Hook them in."""
    app.connect("autodoc-process-docstring", first_sentence)
    app.connect("builder-inited", write_pages)
    app.connect("source-read", as_the_site_reads)
