"""Files in which parts of an assembly stand: taken from its folder tree alone, by the rules for strangers' files."""

import posixpath
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from tol3d.cad.step import StepError, StepFile, read_step, shown
from tol3d.cad.step.gate import cycle
from tol3d.files import LARGEST_FILE, FileContent, UnreadableFileError, contained, read_contained

MOST_FILES: Final = 100


def with_other_files(contents: Sequence[FileContent]) -> tuple[dict[str, FileContent], dict[str, str]]:
    """Files, then those in which parts of them stand, each once; and those that are missing, with the reason.

    Both by the names that a scene gives them: from the folder of the first file on, with / between folders.

    Raises:
        StepError: a name leads out of the folder tree, files hold each other, or there are too many.
    """
    found = {given_name(own, contents[0]): own for own in contents}
    folders = {name: own.path.parent for name, own in found.items()}
    missing: dict[str, str] = {}
    files: dict[str, StepFile] = {}
    waiting = list(found)
    while waiting:
        name = waiting.pop(0)
        files[name] = read_step(found[name])
        for own in names_in(name, files[name]):
            if own in found or own in missing:
                continue
            folder = folders[name]
            try:
                found[own] = FileContent(folder / own, read_contained(folder / own, folder, LARGEST_FILE))
            except UnreadableFileError as error:
                missing[own] = str(error)
                continue
            folders[own] = folder
            waiting.append(own)
            if len(found) > MOST_FILES:
                raise StepError(f"{files[name].name}: expected parts in at most {MOST_FILES} files")
    refuse_ring(files)
    return found, missing


def given_name(content: FileContent, first: FileContent) -> str:
    """Name of a file that a person gives, in the folder tree of the first one or copied beside it."""
    own, folder = content.path.absolute(), first.path.parent.absolute()
    return own.relative_to(folder).as_posix() if own.is_relative_to(folder) else own.name


def name_of(file: str, holder: str) -> str:
    r"""Name of a file that another one names; "" where that leads out of the folder tree.

    >>> name_of("bolt.stp", "parts/lid.stp"), name_of(r"parts\bolt.stp", "all.stp"), name_of("../bolt.stp", "all.stp")
    ('parts/bolt.stp', 'parts/bolt.stp', '')
    """
    name = posixpath.normpath(posixpath.join(posixpath.dirname(holder), file.replace("\\", "/")))
    return name if contained(name) and name.isprintable() else ""


def names_in(holder: str, file: StepFile) -> Iterator[str]:
    """Names of the files in which parts of one stand, each once.

    Raises:
        StepError: one leads out of the folder tree: nothing else is read, and nothing is fetched.
    """
    for own in dict.fromkeys(own.file for own in file.elsewhere):
        name = name_of(own, holder)
        if not name:
            raise StepError(
                f"{shown(file.name)}: a part stands in {shown(own)!r}: expected the name of a file in its own folder "
                "or in one below; copy it there, and export the assembly with plain names"
            )
        yield name


def roots(files: Mapping[str, StepFile]) -> list[str]:
    """Names of the files that no other one refers to."""
    named = {own for name, file in files.items() for own in names_in(name, file)}
    return [name for name in files if name not in named]


def refuse_ring(files: Mapping[str, StepFile]) -> None:
    """Refuse files that hold each other.

    Raises:
        StepError: they do, with their names.
    """
    numbers = {name: k for k, name in enumerate(files)}
    names = list(files)
    uses = {
        numbers[name]: [numbers[own] for own in names_in(name, file) if own in files] for name, file in files.items()
    }
    ring = cycle(uses)
    if ring:
        told = " → ".join(shown(names[k]) for k in (*ring[:6], ring[0]))
        raise StepError(f"{shown(names[ring[0]])}: its assembly holds itself ({told})")
