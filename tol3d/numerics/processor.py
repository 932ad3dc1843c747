"""Influence of this machine's processor and mathematical library on the last bits of a result.

Three choose their instructions by the processor they find: the compiler of the kernels, NumPy's loops, and the C
library's sines and logarithms. One build read with another choice of any of them differs by 4e-9 um at most, so runs
are of one kind of processor.
"""

import os
import platform
import sys
from collections.abc import Mapping
from functools import cache
from typing import Any

import llvmlite.binding
import numpy as np

ARITHMETIC_OF_X86 = ("sse", "ssse", "avx", "fma", "xop", "f16c", "amx")
"""Prefixes of x86 feature names that widen, fuse or replace floating-point instructions; the others add none.
On other architectures all features count."""
X86 = ("x86", "amd64", "i386", "i686")

NUMBAS_SETTINGS = "numba.core.config"
COMPILER_SETTINGS = ("NUMBA_OPT", "NUMBA_LOOP_VECTORIZE", "NUMBA_SLP_VECTORIZE", "NUMBA_ENABLE_AVX")
"""Variables by which numba makes other code for the same processor."""


@cache
def processor() -> Mapping[str, str]:
    """Properties that decide the last bits here, by name; lists have commas."""
    config = _compilers()
    told = os.environ if config is None else config._env_reloader.old_environ  # of a file too, where numba has read one
    settings = [f"{name}={told[name]}" for name in COMPILER_SETTINGS if told.get(name)]
    named = os.environ.get("NUMBA_CPU_NAME") if config is None else config.CPU_NAME
    return {
        "processor": ",".join([named or llvmlite.binding.get_host_cpu_name(), *settings]),
        "instructions": ",".join(_instructions()),
        "numpy instructions": ",".join(_numpy_instructions()),
        "libm": " ".join(filter(None, platform.libc_ver())) or f"{platform.system()} {platform.release()}",
    }


def target() -> list[str]:
    """All that the compiler makes machine code for: code of another target may not even run here."""
    return [llvmlite.binding.get_process_triple(), *processor().values(), _features()]


def unlike(there: object, here: object) -> tuple[object, object]:
    """Two values that differ, of two lists such as those of `processor` only the entries that the other one lacks."""
    if not (isinstance(there, str) and isinstance(here, str) and ("," in there or "," in here)):
        return there, here
    others, own = there.split(","), here.split(",")
    return _without(others, own), _without(own, others)


def _without(names: list[str], known: list[str]) -> str:
    return ",".join(name for name in names if name not in known) or "nothing more"


def _instructions() -> list[str]:
    """Instructions that the compiler may use, as far as they decide results."""
    used = sorted(name.removeprefix("+") for name in _features().split(",") if name.startswith("+"))
    if not platform.machine().lower().startswith(X86):
        return used
    return [name for name in used if name.startswith(ARITHMETIC_OF_X86)]


def _compilers() -> Any:
    """Settings that the compiler goes by, brought up to date as it does before it compiles; None if not loaded yet.

    It then goes by the environment alone, unless it was imported before tol3d: see tol3d.current_folder.
    """
    config: Any = sys.modules.get(NUMBAS_SETTINGS)
    if config is not None:
        config.reload_config()
    return config


def _features() -> str:
    """Features that the processor has (+) and has not (-), in the compiler's form."""
    config = _compilers()
    if config is not None:
        stated = config.CPU_FEATURES
        return str(llvmlite.binding.get_host_cpu_features().flatten()) if stated is None else str(stated)
    generic = os.environ.get("NUMBA_CPU_NAME", "").lower() == "generic"
    stated = os.environ.get("NUMBA_CPU_FEATURES", "" if generic else None)
    return str(llvmlite.binding.get_host_cpu_features().flatten()) if stated is None else stated


def _numpy_instructions() -> list[str]:
    """Sets of instructions for which NumPy has loops of their own and found the processor to have them."""
    config = np.show_config(mode="dicts") or {}
    return list(config.get("SIMD Extensions", {}).get("found", []))
