"""Folders of the tree, for tests wherever they stand."""

from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parent.parent
TESTS: Final = ROOT / "tests"
SCENES: Final = ROOT / "scenes"
SPUR_PAIR: Final = SCENES / "spur_pair.yaml"
