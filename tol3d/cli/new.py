"""The command that begins a scene."""

from pathlib import Path
from typing import Annotated

import typer

from tol3d.cli.console import err_console, tell


def new(
    system: Annotated[
        str | None,
        typer.Argument(metavar="SYSTEM", help="Kind of system, such as spur_pair; without it they are listed."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The scene to write; by default SYSTEM.yaml, here.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
) -> None:
    """Write a commented scene to start your own from, which runs as it is; without SYSTEM list the kinds."""
    from tol3d.errors import InputError
    from tol3d.kinds import all_mechanisms
    from tol3d.system.starter import starter_lines, starter_named

    if system is None:
        if out is not None:
            raise InputError("--out: expected a kind of system before it; `tol3d new` lists them")
        for line in starter_lines(all_mechanisms()):
            tell(line)
        err_console.print("tol3d new NAME writes that scene here, to start your own from")
        return
    starter = starter_named(system, all_mechanisms())
    _write(out or Path(f"{starter.name}.yaml"), starter.text, force)


def _write(path: Path, text: str, force: bool) -> None:
    """Write a new scene and say what to do with it."""
    from tol3d.errors import InputError, unwritable
    from tol3d.runs.atomic_write import write_whole

    if path.is_dir():
        raise InputError(f"{path}: expected a file, this is a folder; --out names another")
    if path.exists() and not force:
        raise InputError(f"{path}: is there already; --force replaces it, --out names another")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text.encode())
    except OSError as error:
        raise unwritable(path, error, "choose another file") from None
    tell(str(path))
    err_console.print(f"tol3d check {path} tells what it means; tol3d run {path} simulates it")
