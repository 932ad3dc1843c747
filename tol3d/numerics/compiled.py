"""The only module that imports numba: functions become machine code, at their first use and once a machine.

What was compiled is kept in the user's cache, under a name made of all that it is made of: the sources of the kernel's
module and of all that they import (a kernel freezes the constants it finds there), the compiler, and the processor it
compiles for. Processes that want the same kernel at once compile it once. Studies of gears by other engines than the
exact one compile nothing.
"""

import contextlib
import hashlib
import io
import itertools
import json
import os
import platform
import shutil
import stat
import tempfile
import threading
import time
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Any, Final, TypeVar

import llvmlite
import numba
import numpy as np
from llvmlite import ir
from numba import types as numba_types
from numba.core import sigutils as numba_signatures
from numba.core.base import BaseContext
from numba.core.caching import FunctionCache
from numba.core.codegen import CPUCodeLibrary
from numba.core.compiler import Compiler as NumbaCompiler
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.runtime import nrt as numba_runtime
from numba.extending import intrinsic, overload

from tol3d.numerics.cache_folder import packed, read_entry, sole_maker, write_entry
from tol3d.numerics.processor import target
from tol3d.numerics.sources import sources_of

Function = TypeVar("Function", bound=Callable[..., Any])

# forced inlining keeps the tuples of numbers in registers: a third of the time; fused products round once, not twice
SETTINGS: Any = {"error_model": "numpy", "nogil": True, "forceinline": True, "fastmath": {"contract"}}
PART_SETTINGS: Any = SETTINGS | {"nopython": True, "boundscheck": None}  # as numba's own decorators have them

FULL, QUICK = 3, 2  # LLVM's levels of optimization
NUMBAS_FOLDER = "tol3d-kernel-"  # begins the names of folders for temporary files
LEFT_BEHIND = 3600.0  # s; such a folder is in use for as long as a kernel compiles, unless its process was killed
LONGEST_WAIT = 150.0  # s, while another process compiles a kernel; the largest takes 20 s on a core of its own


class PartCompiler(NumbaCompiler):
    """Compiles a part for kernels to be linked with: without an entry for Python, no machine code of its own.

    numba by itself makes both for each part, in a fifth to two fifths of the time of compiling.
    """

    optimizing = True

    def compile_extra(self, func: Any) -> Any:
        """Compile a function, and the parts it is made of."""
        state = self.state
        state.flags.no_cpython_wrapper = state.flags.no_cfunc_wrapper = state.flags.no_compile = True
        if state.library is None:
            state.library = state.targetctx.codegen().create_library(func.__qualname__)
            state.library.enable_object_caching()
        # numba's methods; where they are gone, parts are optimized, and become machine code
        state.library._finalize_final_module = partial(_finished, state.library)
        if not self.optimizing:
            state.library._optimize_final_module = _left_as_it_is
        compiled: Any = super()
        made = compiled.compile_extra(func)
        known_by: Any = {}.__getitem__  # numba demands a builtin of its own for each function; this one is never called
        state.targetctx.insert_user_function(known_by, made.fndesc, [made.library])
        return made._replace(entry_point=known_by)


class NestedCompiler(PartCompiler):
    """Compiles a part without optimizing it."""

    optimizing = False


def _finished(library: Any) -> None:
    library._finalized = True


def _left_as_it_is() -> None:
    pass


PLAINLY: Final = "TOL3D_PLAIN_NUMBA"
"""Variable of the environment: where it is set, parts are compiled as numba by itself compiles functions."""


def plainly() -> bool:
    """True if parts are compiled by numba alone: asked for, or this numba lacks the methods that PartCompiler changes.

    It takes about twice as long, and last bits differ where products are fused with other sums.
    """
    changed = ("_finalize_final_module", "_optimize_final_module", "enable_object_caching")
    known = all(hasattr(CPUCodeLibrary, own) for own in changed) and hasattr(BaseContext, "insert_user_function")
    return PLAINLY in os.environ or not known


class Part(CPUDispatcher):
    """Function that kernels are made of; called from Python, it runs as Python."""

    def __call__(self, *arguments: Any) -> Any:
        """Do what its lines say."""
        return self.py_func(*arguments)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile it once for numbers that are written out and for those that are not: numba by itself does both."""
        types: Any = numba_types
        template: Any = super()
        return template.get_call_template(tuple(map(types.unliteral, args)), kws)


def part(function: Function) -> Function:
    """A function that kernels are made of: compiled into them, for any arguments."""
    return _part(function, PartCompiler)


def nested(function: Function) -> Function:
    """A part that is optimized once, in its kernel: half the time of compiling where parts are nested deep.

    numba by itself optimizes each part with all that it is made of, the innermost as often as parts are nested. The
    machine code is another one, and its last bits where products are fused with other sums.
    """
    return _part(function, NestedCompiler)


def _part(function: Function, compiler: type[PartCompiler]) -> Function:
    pipeline = NumbaCompiler if plainly() else compiler
    made: Any = Part(function, targetoptions=PART_SETTINGS, pipeline_class=pipeline)
    compiled: Function = made
    return compiled


def inlined(function: Function) -> Function:
    """A part whose lines take the place of the call: the same machine code, and bits, as if they were written there.

    Calls of other parts are inlined later, by LLVM, which may then fuse other products with their sums.
    """
    compiled: Function = numba.njit(inline="always", **SETTINGS)(function)
    return compiled


_VARIANTS_IN: dict[type, set[str]] = {}  # modules of the variants for a kind


def variant(of: Callable[..., Any], kind: type) -> Callable[[Function], Function]:
    """Variant of a function for a first argument of some kind, a NamedTuple; chosen as kernels compile."""

    def register(function: Function) -> Function:
        _VARIANTS_IN.setdefault(kind, set()).add(function.__module__)

        pipeline = NumbaCompiler if plainly() else PartCompiler

        @overload(of, strict=False, jit_options=SETTINGS | {"pipeline_class": pipeline})
        def chosen(*arguments: Any) -> Function | None:
            return function if getattr(arguments[0], "instance_class", None) is kind else None

        return function

    return register


def _high_product(context: Any, left: Any, right: Any) -> Any:
    """Upper 64 bits of the product of two 64-bit words, for which Python's words have no operator."""

    def made(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        wide = ir.IntType(128)
        product = builder.mul(*(builder.zext(argument, wide) for argument in arguments))
        return builder.trunc(builder.lshr(product, ir.Constant(wide, 64)), ir.IntType(64))

    return numba_types.uint64(numba_types.uint64, numba_types.uint64), made


high_product: Any = intrinsic(_high_product)


class Kernel:
    """A compiled function of arrays; it holds no lock while it runs, so that threads run several at once.

    Args:
        function: its definition in Python.
        tuples: kinds of its first arguments, NamedTuples of floats.
        arrays: types of the others in numba's words. It is compiled for these only.
        reassociated: whether sums may be taken in another order than they are written, for speed; on one machine that
            is always the same.
        level: of LLVM's optimization, FULL or QUICK. FULL is worth it where most of the time goes into one long loop of
            arithmetic; of many short loops it makes variants, which take twice as long to compile.
    """

    def __init__(
        self,
        function: Callable[..., None],
        tuples: Sequence[Any],
        arrays: str,
        *,
        reassociated: bool = False,
        level: int = FULL,
    ) -> None:
        self._function = function
        self._tuples = tuples
        self._arrays = arrays
        self._level = level
        self._settings = SETTINGS | {"fastmath": {"contract", "reassoc", "nsz"}} if reassociated else SETTINGS

    def __call__(self, *arguments: Any) -> None:
        """Run it; results go into arrays among the arguments."""
        self._compiled(*arguments)

    def make(self) -> None:
        """Compile it now, unless this machine has."""
        if not self.kept:
            _ = self._compiled

    @property
    def kept(self) -> bool:
        """True if this machine has compiled it before, so that using it takes no more than loading it."""
        return self._read() is not None

    @cached_property
    def name(self) -> str | None:
        """Name of its entry in the cache: changes with all that it is made of. None if that is unknown."""
        try:
            made_of = _made_of(self._function, self._tuples)
        except OSError:
            return None
        own = [self._arrays, self._settings, self._level, *(["plain"] if plainly() else [])]
        made = json.dumps([made_of, own], sort_keys=True, default=sorted)  # sets have no order
        return f"kernel-{self._function.__name__}-{hashlib.sha256(made.encode()).hexdigest()[:32]}.zip"

    @cached_property
    def _compiled(self) -> Callable[..., None]:
        types: Any = numba_types
        numbers = [types.NamedUniTuple(types.float64, len(kind._fields), kind) for kind in self._tuples]
        signatures: Any = numba_signatures
        arrays, _ = signatures.normalize_signature(f"void({self._arrays})")
        signature = (*numbers, *arrays)
        with _ONE_AT_A_TIME:
            kept = self._read()
            return self._loaded(signature, kept) or self._compiled_once(signature, kept)

    def _compiled_once(self, signature: tuple[Any, ...], useless: bytes | None) -> Callable[..., None]:
        """Kernel compiled, or loaded when another process has compiled it since the cache held something useless."""
        if self.name is None:
            return self._compiled_now(signature)
        with sole_maker(self.name, LONGEST_WAIT):
            kept = self._read()
            made = self._loaded(signature, kept) if kept != useless else None
            return made or self._compiled_now(signature)

    def _loaded(self, signature: tuple[Any, ...], content: bytes | None) -> Callable[..., None] | None:
        """Kernel from an entry of the cache; None if there is none, or it cannot be used."""
        if content is None:
            return None
        try:
            with _numbas_folder():
                # numba looks in a subfolder named after the source's path; an entry serves copies of it elsewhere too
                place: Any = FunctionCache
                zipfile.ZipFile(io.BytesIO(content)).extractall(place(self._function).cache_path)
                with _loading_only():
                    made: Any = self._made(signature, cache=True)
        except Exception:  # whole, but of no use to this numba: whatever it stumbles over, compiling does without
            return None
        used: Callable[..., None] | None = made if made.stats.cache_hits else None
        return used

    def _compiled_now(self, signature: tuple[Any, ...]) -> Callable[..., None]:
        """Kernel compiled, and kept where that is possible."""
        _clear_left_folders()
        with contextlib.ExitStack() as stack:
            try:
                folder = stack.enter_context(_numbas_folder())
                made = self._made(signature, cache=True)
            except (OSError, RuntimeError):  # nowhere to put it: compiled for this process only
                return self._made(signature, cache=False)
            files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
            if files and self.name:
                with contextlib.suppress(OSError):
                    write_entry(self.name, packed(files))
        return made

    def _read(self) -> bytes | None:
        return read_entry(self.name) if self.name else None

    def _made(self, signature: tuple[Any, ...], *, cache: bool) -> Callable[..., None]:
        with _optimizing(self._level):
            made: Callable[..., None] = numba.njit(signature, cache=cache, **self._settings)(self._function)
        return made


_ONE_AT_A_TIME = threading.RLock()  # numba's folder is one for the whole process


def _made_of(function: Callable[..., None], tuples: Sequence[type]) -> dict[str, Any]:
    """All that a kernel is made of but its own types and settings."""
    modules = {function.__module__, *(kind.__module__ for kind in tuples)}
    modules = modules.union(*(_VARIANTS_IN.get(kind, set()) for kind in tuples))
    return {
        "function": [function.__module__, function.__qualname__],
        "kinds": [f"{kind.__module__}.{kind.__qualname__}" for kind in tuples],
        "sources": sources_of(*modules),
        "versions": [numba.__version__, llvmlite.__version__, np.__version__, platform.python_version()],
        "target": target(),
    }


def kernel(
    *tuples: Any, arrays: str, reassociated: bool = False, level: int = QUICK
) -> Callable[[Callable[..., None]], Kernel]:
    """Make a function a kernel; see Kernel."""
    return lambda function: Kernel(function, tuples, arrays, reassociated=reassociated, level=level)


@contextmanager
def _optimizing(level: int) -> Iterator[None]:
    """Set numba's optimisation level while it is open."""
    config: Any = numba.config
    before = config.OPT
    config.OPT = type(before)(level)  # an integer of numba's own
    try:
        yield
    finally:
        config.OPT = before


@contextmanager
def _loading_only() -> Iterator[None]:
    """Let numba load cached kernels without its compiler: 0.06 s instead of 0.6 s for the first one.

    To load a function, numba has its target refreshed, of which only the runtime is needed. It compiles where there is
    nothing to load, and has it refreshed again: that is refused.
    """
    used: Any = cpu_target
    runtime: Any = numba_runtime.rtsys
    target = used.target_context
    asked = itertools.count()

    def refresh() -> None:
        if next(asked):
            raise RuntimeError("nothing to load")
        runtime.initialize(target)

    target.refresh = refresh
    try:
        yield
    finally:
        del target.refresh


@contextmanager
def _numbas_folder() -> Iterator[Path]:
    """A private folder for numba's files while it is open."""
    config: Any = numba.config
    with tempfile.TemporaryDirectory(prefix=NUMBAS_FOLDER) as name:
        before, config.CACHE_DIR = config.CACHE_DIR, name
        try:
            yield Path(name)
        finally:
            config.CACHE_DIR = before


@cache
def _clear_left_folders() -> None:
    """Delete numba's folders that processes of this user left when they were killed; once a process."""
    with contextlib.suppress(OSError):
        for folder in Path(tempfile.gettempdir()).glob(f"{NUMBAS_FOLDER}*"):
            found = folder.lstat()
            own = not hasattr(os, "getuid") or found.st_uid == os.getuid()
            if own and stat.S_ISDIR(found.st_mode) and time.time() - found.st_mtime > LEFT_BEHIND:
                shutil.rmtree(folder, ignore_errors=True)
