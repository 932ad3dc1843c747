"""Files in which parts of an assembly stand: taken from its own folder alone, by the rules for strangers' files."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tol3d.cad.step import StepError, StepFile, read_step, shown
from tol3d.cad.step.gate import cycle
from tol3d.files import LARGEST_FILE, FileContent, UnreadableFileError, contained, read_contained

MOST_FILES: Final = 100


def with_other_files(contents: Sequence[FileContent]) -> tuple[list[FileContent], dict[str, str]]:
    """Files, then those in which parts of them stand, each once; and those that are missing, with the reason.

    Raises:
        StepError: a name leads out of the folder, files hold each other, or there are too many.
    """
    found = {own.path.name: own for own in contents}
    missing: dict[str, str] = {}
    files: dict[str, StepFile] = {}
    waiting = list(found)
    while waiting:
        name = waiting.pop(0)
        files[name] = read_step(found[name])
        for own in names_in(files[name]):
            if own in found or own in missing:
                continue
            try:
                path = found[name].path.parent / own
                found[own] = FileContent(path, read_contained(path, path.parent, LARGEST_FILE))
            except UnreadableFileError as error:
                missing[own] = str(error)
                continue
            waiting.append(own)
            if len(found) > MOST_FILES:
                raise StepError(f"{files[name].name}: expected parts in at most {MOST_FILES} files")
    refuse_ring(files)
    return list(found.values()), missing


def names_in(file: StepFile) -> Iterator[str]:
    """Names of the files in which parts of one stand, each once.

    Raises:
        StepError: one is no plain name: nothing is read but from the folder of the file, and nothing is fetched.
    """
    for name in dict.fromkeys(own.file for own in file.elsewhere):
        if not contained(name) or "/" in name or not name.isprintable():
            raise StepError(
                f"{shown(file.name)}: a part stands in {shown(name)!r}: expected the name of a file in its own folder; "
                "copy it there, and export the assembly with plain names"
            )
        yield name


def roots(files: Sequence[StepFile]) -> list[StepFile]:
    """Files that no other one refers to."""
    named = {name for file in files for name in names_in(file)}
    return [file for file in files if file.name not in named]


def refuse_ring(files: Mapping[str, StepFile]) -> None:
    """Refuse files that hold each other.

    Raises:
        StepError: they do, with their names.
    """
    numbers = {name: k for k, name in enumerate(files)}
    names = list(files)
    uses = {numbers[name]: [numbers[own] for own in names_in(file) if own in files] for name, file in files.items()}
    ring = cycle(uses)
    if ring:
        told = " → ".join(shown(names[k]) for k in (*ring[:6], ring[0]))
        raise StepError(f"{shown(names[ring[0]])}: its assembly holds itself ({told})")
