"""Commands by import path: those that tol3d ships, then those that mechanisms of other packages bring.

A command is a function with typer's annotations, and has its name. Only the module of the command that is called is
loaded; `tol3d --help` loads those of all, so imports of what is heavy stand inside the functions.
"""

import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, wraps
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, Final, cast

import typer
from typer.core import TyperCommand, TyperGroup

from tol3d.errors import InputError
from tol3d.import_path import GROUP, REGISTRY, named

if TYPE_CHECKING:
    from tol3d.study.system.mechanism import Mechanism

SHIPPED: Final = (
    "tol3d.cli.studies:run",
    "tol3d.apps.workbench.commands:app",
    "tol3d.cli.showing:scenes",
    "tol3d.apps.drafting.commands:new",
    "tol3d.cli.showing:check",
    "tol3d.cli.step:features",
    "tol3d.cli.step:pmi",
    "tol3d.cli.showing:workspace",
    "tol3d.cli.showing:compare",
    "tol3d.cli.showing:report",
    "tol3d.apps.adjustment.commands:shim",
    "tol3d.apps.adjustment.commands:compensate",
    "tol3d.cli.rare:rare",
    "tol3d.cli.analyses:effects",
    "tol3d.cli.analyses:what_if",
    "tol3d.cli.analyses:allocate",
    "tol3d.cli.analyses:changes",
    "tol3d.cli.analyses:methods",
    "tol3d.cli.sweep:sweep",
    "tol3d.apps.records.commands:identify",
    "tol3d.apps.records.commands:rig",
    "tol3d.apps.records.commands:plan_rig",
    "tol3d.apps.design.commands:design",
    "tol3d.cli.showing:export",
    "tol3d.cli.showing:view",
    "tol3d.cli.showing:schema",
)
"""In the order in which help shows them."""


class CommandGroup(TyperGroup):
    """Group of all commands, each loaded when it is first asked for."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes | {"commands": _Commands()})


class _Commands(Mapping[str, TyperCommand]):
    """Commands by name: shipped ones, then those of other packages, which are looked for only if need be."""

    def __init__(self) -> None:
        self._shipped = {_name(path): path for path in SHIPPED}
        self._loaded = dict[str, TyperCommand]()

    def __getitem__(self, name: str) -> TyperCommand:
        if name not in self._shipped:
            return self._others[name]
        if name not in self._loaded:
            self._loaded[name] = _command(name, named(self._shipped[name]))
        return self._loaded[name]

    def __iter__(self) -> Iterator[str]:
        return iter((*self._shipped, *self._others))

    def __len__(self) -> int:
        return len(self._shipped) + len(self._others)

    @cached_property
    def _others(self) -> Mapping[str, TyperCommand]:
        """Commands of mechanisms of other packages; a warning tells of one that cannot be used."""
        found = dict[str, TyperCommand]()
        if REGISTRY not in sys.modules and not entry_points(group=GROUP):
            return found
        for mechanism in named(f"{REGISTRY}:other_mechanisms")():
            for path in mechanism.commands:
                name = _name(path)
                try:
                    if name in self._shipped or name in found:
                        raise InputError(f"there is a command {name!r} already")
                    found[name] = _command(name, _reporting(mechanism, named(path)))
                except Exception as error:  # whatever a stranger's module raises: other commands are as ever
                    words = f"{mechanism.name}: its command {path} cannot be used: {error}"
                    warnings.warn(words, named(f"{REGISTRY}:MechanismWarning"), stacklevel=2)
        return found


def _name(path: str) -> str:
    """Name of the command of an import path, as typer makes it of the function's."""
    return path.rpartition(":")[2].replace("_", "-")


def _command(name: str, function: Callable[..., Any]) -> TyperCommand:
    alone = typer.Typer(add_completion=False)
    alone.command(name)(function)
    return cast("TyperCommand", typer.main.get_command(alone))


def _reporting(mechanism: "Mechanism", function: Callable[..., Any]) -> Callable[..., Any]:
    """A command of another package, whose faults are reported under the mechanism's name."""

    @wraps(function)
    def command(*words: Any, **options: Any) -> Any:
        with named("tol3d.study.system.faults:faults_of")(mechanism.origin):
            return function(*words, **options)

    return command
