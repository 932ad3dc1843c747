"""Pictures of the pages: each is the one that was drawn, of the scenes and by the sources that are there now."""

import pytest
from pictures import HERE, PICTURES, checksum, kept, shown_by


def test_every_picture_of_the_pages_says_how_it_is_drawn() -> None:
    assert {path.name for path in HERE.iterdir() if path.suffix in (".png", ".webp")} == set(PICTURES) == set(kept())


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_is_not_older_than_what_it_shows(name: str) -> None:
    entry = kept()[name]
    assert entry["shows"] == shown_by(PICTURES[name]), f"drawn on {entry['drawn']}: python docs/pictures.py {name}"
    assert entry["picture"] == checksum(HERE / name), f"not what docs/pictures.py drew on {entry['drawn']}"
