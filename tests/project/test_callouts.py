"""Pictures of callouts: made from their table, small, and one in each section of the page of drawings."""

import re
from xml.etree import ElementTree

import pytest
from callouts import CALLOUTS, HERE, picture

MOST = 8000  # bytes
PAGE = (HERE / "drawings.md").read_text("utf-8")


@pytest.mark.parametrize("name", CALLOUTS)
def test_each_file_is_what_the_table_draws(name: str) -> None:
    """Else run `python docs/callouts.py`."""
    text = (HERE / "callouts" / f"{name}.svg").read_text("utf-8")
    assert text == picture(CALLOUTS[name])
    assert len(text) < MOST
    root = ElementTree.fromstring(text)
    width, height = float(root.attrib["width"]), float(root.attrib["height"])
    for own in root.iter("{http://www.w3.org/2000/svg}text"):
        middle, half = float(own.attrib["x"]), float(own.attrib.get("textLength", 9)) / 2
        assert 0 < middle - half < middle + half < width
        assert 0 < float(own.attrib["y"]) < height


def test_each_section_has_its_picture() -> None:
    sections = re.split(r"^## ", PAGE, flags=re.MULTILINE)[1:]
    shown = [re.findall(r"\]\(callouts/(\w+)\.svg\)", own) for own in sections]
    assert all(shown), [own.partition("\n")[0] for own, found in zip(sections, shown, strict=True) if not found]
    assert sorted(name for found in shown for name in found) == sorted(CALLOUTS)
    assert {path.stem for path in (HERE / "callouts").iterdir()} == set(CALLOUTS)
