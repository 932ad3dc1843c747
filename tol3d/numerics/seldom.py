"""Parts of numpy that scipy.special loads, for it imports all of numpy by name, and that hardly anybody uses."""

import importlib.util
import sys
from typing import Final

import numpy as np

SELDOM: Final = ("f2py", "testing", "ma")  # 0.1 s of a command of 2 s; f2py looks for compilers and character sets


def load_when_used() -> None:
    """Let these parts of numpy load when something of theirs is asked for; where one is loaded, it stays as it is."""
    for part in SELDOM:
        name = f"numpy.{part}"
        spec = None if name in sys.modules else importlib.util.find_spec(name)
        if spec is None or spec.loader is None:
            continue
        spec.loader = importlib.util.LazyLoader(spec.loader)
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        setattr(np, part, module)
