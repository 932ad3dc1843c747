"""The command that begins a scene: of a kind of system, or from STEP files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from tol3d.cli.console import err_console, tell


def new(
    system: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[SYSTEM]",
            help="Kind of system, such as spur_pair; without it they are listed. Of --from more files.",
        ),
    ] = None,
    start: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="FILE...",
            help="STEP files, or one REXS file of a gearbox: a scene of their parts, with their tolerances.",
        ),
    ] = None,
    seat: Annotated[
        list[str] | None,
        typer.Option(metavar="PART.FACE", help="Seat a part of theirs by this face, such as cover.A, …"),
    ] = None,
    on: Annotated[list[str] | None, typer.Option(metavar="PART.FACE", help="… on this face of another part.")] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The scene to write; by default SYSTEM.yaml or FILE.yaml, here.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
    inspect: Annotated[
        bool,
        typer.Option("--inspect", help="Of --from: measure each tolerance of the files against its own limit too."),
    ] = False,
) -> None:
    """Write a scene to start your own from, which runs: of a kind of system, or of files; alone list the kinds."""
    from tol3d.errors import InputError
    from tol3d.kinds import all_mechanisms
    from tol3d.scene.bundled import bundled_scenes
    from tol3d.study.system import starter_lines, starter_named

    words = system or []
    if start is not None:
        _draft([str(start), *words], seat or [], on or [], out, force, inspect)
        return
    if seat or on:
        raise InputError("--seat: expected --from and STEP files beside it, whose parts are placed")
    if inspect:
        raise InputError("--inspect: expected --from and STEP files beside it, whose tolerances are inspected")
    if not words:
        if out is not None:
            raise InputError("--out: expected a kind of system before it; `tol3d new` lists them")
        for line in starter_lines(all_mechanisms()):
            tell(line)
        err_console.print("tol3d new NAME writes the scene NAME.yaml as a starting point")
        return
    if len(words) > 1:
        raise InputError(f"expected one kind of system, got {len(words)}; files stand behind --from")
    try:
        starter = starter_named(words[0], all_mechanisms())
    except InputError as error:
        if words[0] not in bundled_scenes():
            raise
        raise InputError(f"{error}; `tol3d scenes --copy {words[0]}` copies the bundled scene of this name") from None
    _write(out or Path(f"{starter.name}.yaml"), starter.text, force)


def _draft(
    words: Sequence[str], seats: Sequence[str], faces: Sequence[str], out: Path | None, force: bool, inspect: bool
) -> None:
    """Write a scene from STEP files, which are copied beside it where they lie elsewhere."""
    from tol3d.apps.drafting import Seat, scene_from
    from tol3d.apps.drafting.other_files import with_other_files
    from tol3d.apps.drafting.rexs import is_rexs
    from tol3d.errors import InputError, unwritable
    from tol3d.files import read_file
    from tol3d.kinds import all_mechanisms
    from tol3d.study.runs import write_whole
    from tol3d.study.system import starters_of

    kinds = {starter.name for mechanism in all_mechanisms() for starter in starters_of(mechanism)}
    if both := next((word for word in words if word in kinds and not Path(word).exists()), None):
        raise InputError(f"expected a kind of system or --from with STEP files, got both: {both!r} is a kind")
    if any(is_rexs(Path(word)) for word in words):
        _draft_gearbox(words, [*seats, *faces], out, force)
        return
    if len(seats) != len(faces):
        raise InputError(f"--seat: expected an --on for each, got {len(seats)} and {len(faces)}")
    contents = [read_file(Path(word)) for word in words]
    names = [own.path.name for own in contents]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise InputError(f"{twice}: expected files of different names, got two")
    target = out or Path(Path(words[0]).stem + ".yaml")
    _refuse_there(target, force)
    laid = [Seat(*own) for own in zip(seats, faces, strict=True)]
    with err_console.status(f"reading {', '.join(names)}") as status:
        files, _ = with_other_files(contents)
        copies = [(target.parent / name, own.content) for name, own in files.items()]
        for path, content in copies:
            if path.exists() and path.read_bytes() != content:
                raise InputError(f"{path}: another file of that name lies beside the scene; --out names another folder")
        text, drafted = scene_from(contents, laid, inspect=inspect, tell=status.update)
    for path, content in copies:
        if path.exists():
            continue
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, content)
        except OSError as error:
            raise unwritable(path, error, "choose another folder with --out") from None
        tell(str(path))
    _write(target, text, force)
    for note in drafted.notes():
        err_console.print(note, markup=False, highlight=False)


def _draft_gearbox(words: Sequence[str], seats: Sequence[str], out: Path | None, force: bool) -> None:
    """Write a scene from a REXS file, which the scene does not need any more."""
    from tol3d.apps.drafting.rexs import gearbox_scene_from
    from tol3d.errors import InputError
    from tol3d.files import read_file

    if len(words) > 1:
        raise InputError(f"--from: expected one REXS file and no other, got {len(words)} files")
    if seats:
        raise InputError("--seat: expected STEP files, whose parts are placed; a REXS file places its own")
    path = Path(words[0])
    target = out or Path(path.name[: path.name.lower().rindex(".rexs")] + ".yaml")
    _refuse_there(target, force)
    text, drafted = gearbox_scene_from(read_file(path))
    _write(target, text, force)
    for note in drafted.notes():
        err_console.print(note, markup=False, highlight=False)


def _refuse_there(path: Path, force: bool) -> None:
    """Refuse to write over a folder, and over a file without --force."""
    from tol3d.errors import InputError

    if path.is_dir():
        raise InputError(f"{path}: expected a file, this is a folder; --out names another")
    if path.exists() and not force:
        raise InputError(f"{path}: is there already; --force replaces it, --out names another")


def _write(path: Path, text: str, force: bool) -> None:
    """Write a new scene and say what to do with it."""
    from tol3d.errors import unwritable
    from tol3d.study.runs import write_whole

    _refuse_there(path, force)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text.encode())
    except OSError as error:
        raise unwritable(path, error, "choose another file") from None
    tell(str(path))
    err_console.print(f"tol3d check {path} explains it; tol3d run {path} simulates it")
