"""The door to numba: functions become machine code, at their first use and once a machine.

What was compiled is kept in the user's cache, in a folder named by the sources of the kernel's package: a kernel is
made of many functions, of which numba itself would only notice the outermost one's change. Studies of other engines
than the exact one compile nothing.
"""

import hashlib
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numba
import platformdirs
from llvmlite import ir
from numba import types as numba_types
from numba.core import sigutils as numba_signatures
from numba.extending import intrinsic, overload

Function = TypeVar("Function", bound=Callable[..., Any])

# forced inlining keeps the tuples of numbers in registers: a third of the time; fused products round once, not twice
SETTINGS: Any = {"error_model": "numpy", "nogil": True, "forceinline": True, "fastmath": {"contract"}}


def part(function: Function) -> Function:
    """A function that kernels are made of: compiled into them, for whatever they hand it."""
    compiled: Function = numba.njit(**SETTINGS)(function)
    return compiled


def variant(of: Callable[..., Any], kind: type) -> Callable[[Function], Function]:
    """What a function does for a first argument of some kind, a NamedTuple; chosen as kernels compile."""

    def register(function: Function) -> Function:
        @overload(of, strict=False, jit_options=SETTINGS)
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
        function: what it does, in the words of Python.
        tuples: kinds of its first arguments, NamedTuples of floats.
        arrays: types of the others in numba's words. It is compiled for these only.
        reassociated: whether sums may be taken in another order than they are written, for speed; on one machine that
            is always the same.
    """

    def __init__(
        self, function: Callable[..., None], tuples: Sequence[Any], arrays: str, *, reassociated: bool = False
    ) -> None:
        self._function = function
        self._tuples = tuples
        self._arrays = arrays
        self._settings = SETTINGS | {"fastmath": {"contract", "reassoc", "nsz"}} if reassociated else SETTINGS

    def __call__(self, *arguments: Any) -> None:
        """Run it; results go into arrays among the arguments."""
        self._compiled(*arguments)

    @property
    def kept(self) -> bool:
        """Whether this machine has compiled it before: whether using it takes no more than loading it."""
        return any(self._folder.glob(f"*/*.{self._function.__name__}-*.nbi"))

    @property
    def _folder(self) -> Path:
        kinds = "-".join(kind.__name__ for kind in self._tuples) or "arrays"
        return folder(Path(self._function.__code__.co_filename).parent) / kinds

    @cached_property
    def _compiled(self) -> Callable[..., None]:
        types: Any = numba_types
        numbers = [types.NamedUniTuple(types.float64, len(kind._fields), kind) for kind in self._tuples]
        signatures: Any = numba_signatures
        arrays, _ = signatures.normalize_signature(f"void({self._arrays})")
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
        except OSError:  # numba would keep it beside the sources, by the date of one of them
            return self._made((*numbers, *arrays), cache=False)
        with _kept_in(self._folder):
            try:
                return self._made((*numbers, *arrays), cache=True)
            except RuntimeError:  # nowhere to keep it: compiled for this process only
                return self._made((*numbers, *arrays), cache=False)

    def _made(self, signature: tuple[Any, ...], *, cache: bool) -> Callable[..., None]:
        made: Callable[..., None] = numba.njit(signature, cache=cache, **self._settings)(self._function)
        return made


def kernel(*tuples: Any, arrays: str, reassociated: bool = False) -> Callable[[Callable[..., None]], Kernel]:
    """Make a function a kernel; see Kernel."""
    return lambda function: Kernel(function, tuples, arrays, reassociated=reassociated)


def folder(package: Path) -> Path:
    """Where the kernels of a package are kept: named by its sources."""
    sources = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(package.glob("*.py"))))
    sources.update(Path(__file__).read_bytes())
    base = os.environ.get("TOL3D_CACHE") or platformdirs.user_cache_dir("tol3d", appauthor=False)
    return Path(base) / f"kernels-{package.name}-{sources.hexdigest()[:16]}"


@contextmanager
def _kept_in(folder: Path) -> Iterator[None]:
    """Let numba keep what it compiles in a folder."""
    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, str(folder)
    try:
        yield
    finally:
        config.CACHE_DIR = before
