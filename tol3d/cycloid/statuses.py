"""What may become of an RV reducer that is put together."""

from typing import Final

from tol3d.system.statuses import Statuses

NO_CONTACT: Final = 1
STATUSES: Final = Statuses(texts=("ok", "no contact"), words={"no contact": "have no pin that touches"})
"""Builds whose pins press on both sides keep a value, a lost motion below 0: the discs give way."""
