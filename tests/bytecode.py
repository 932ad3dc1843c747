"""Imported before all that is compiled: what Python makes of sources is kept for the processes that come after."""

import os
import sys

sys.dont_write_bytecode = False  # else each of the hundred processes that tests start would compile the same sources
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
