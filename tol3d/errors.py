"""What a user must mend, said in the user's words; everything else is a fault of ours."""


class Tol3dError(Exception):
    """Base of every error that tol3d raises on purpose; its text is meant for people."""


class InputError(Tol3dError):
    """Something the user gave (a scene, an option, a folder) cannot be used; exit code 2."""


class SceneError(InputError):
    """A scene cannot be read or understood.

    Args:
        problems: one or several finished messages, each with file, line, place and expectation.
    """

    def __init__(self, *problems: str) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


class GeometryError(InputError):
    """Gears that cannot be made, or cannot run together; the text carries the numbers."""


class RunError(InputError):
    """A folder is not a run, is damaged, or cannot be written."""


class DiskError(RunError):
    """The disk or the system refuses a write: neither the input nor tol3d is at fault; exit code 4."""
