"""Sets for a wished ratio, condition by condition; where none is left, the condition that fails and its numbers."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from tol3d.apps.design.families import Family, Teeth
from tol3d.apps.design.optimum import Goal, LimitsNotKeptError, Task, best_shifts
from tol3d.apps.design.shifted_set import PLANET_GAP, Limits, ShiftedSet, refuse_interference, step_name
from tol3d.apps.design.working_mesh import BasicRack
from tol3d.errors import GeometryError
from tol3d.gearing.planetary import ToothSet


@dataclass(frozen=True)
class Wish:
    """Requirements on a set.

    Args:
        ratio: speed of the input over that of the output; negative where they turn in opposite senses.
        tolerance: of the ratio, either way.
        planets: number of identical planets at equal angles.
        teeth: numbers of teeth allowed.
        goal: that of the choice of profile shifts.
        centre_distance: stated [mm], or None.

    Raises:
        GeometryError: the ratio is 0 or no number.
    """

    family: Family
    ratio: float
    tolerance: float = 0.005
    planets: int = 3
    teeth: Teeth = field(default_factory=Teeth)
    rack: BasicRack = field(default_factory=BasicRack)
    limits: Limits = field(default_factory=Limits)
    goal: Goal = Goal.SMALLEST
    friction: float = 0.08
    centre_distance: float | None = None

    def __post_init__(self) -> None:
        if not math.isfinite(self.ratio) or self.ratio == 0.0:
            raise GeometryError(f"ratio: expected a number other than 0, got {self.ratio:g}")

    def task(self, teeth: ToothSet) -> Task:
        """The same for one set."""
        return Task(teeth, self.rack, self.family.drive, self.planets, self.limits, self.friction, self.centre_distance)


@dataclass(frozen=True)
class Candidate:
    """A set that keeps every condition, with its task."""

    own: ShiftedSet
    task: Task

    @property
    def ratio(self) -> float:
        """Speed of the input over that of the output."""
        return self.task.drive.ratio(self.own.teeth)

    @property
    def forward(self) -> float:
        """Efficiency in the sense of the drive."""
        return self.task.efficiency(self.own, self.task.drive)

    @property
    def backward(self) -> float:
        """Driven at the output; at most 0: it locks itself."""
        return self.task.efficiency(self.own, self.task.drive.reversed)


@dataclass(frozen=True)
class Fallen:
    """Sets that fail one condition: their number, and the reason of the nearest one."""

    condition: str
    count: int
    nearest: str


@dataclass(frozen=True)
class Found:
    """Candidates, nearest ratio first and small before large; those rejected before; number not looked at."""

    candidates: tuple[Candidate, ...]
    fallen: tuple[Fallen, ...]
    left: int


def find(wish: Wish, most: int = 10) -> Found:
    """Candidates for a wish.

    Args:
        most: largest number of candidates.

    Raises:
        GeometryError: none; with each condition in turn, the number of sets left out, and the nearest one's numbers.
    """
    with_ratio, nearest = wish.family.near(wish.ratio, wish.tolerance, wish.teeth)
    if not with_ratio:
        raise GeometryError(_no_ratio(wish, nearest))
    assembled, not_assembled = _assembled(wish, with_ratio)
    ordered = sorted(assembled, key=lambda own: (round(abs(_ratio(wish, own) - wish.ratio), 9), _size(own)))
    candidates: list[Candidate] = []
    touching: list[tuple[float, str]] = []
    failed: list[str] = []
    for teeth in ordered:
        if len(candidates) == most:
            break
        try:
            own = best_shifts(wish.task(teeth), wish.goal)
            refuse_interference(own)
        except GeometryError as error:
            words = f"{teeth_text(teeth)}: {error}"
            if isinstance(error, LimitsNotKeptError) and error.margin.what == PLANET_GAP:
                touching.append((-error.margin.kept, words))
            else:
                failed.append(words)
            continue
        candidates.append(Candidate(own, wish.task(teeth)))
    adjacent = (Fallen("adjacency", len(touching), min(touching)[1]),) if touching else ()
    interfering = (Fallen("limits of the teeth", len(failed), failed[0]),) if failed else ()
    fallen = (*not_assembled, *adjacent, *interfering)
    if not candidates:
        raise GeometryError(_none_left(wish, len(with_ratio), fallen))
    return Found(tuple(candidates), fallen, len(ordered) - len(candidates) - len(touching) - len(failed))


def teeth_text(teeth: ToothSet) -> str:
    """Teeth of a set in the order of its family: 25/27/79/24/76.

    >>> from tol3d.gearing.planetary.model.tooth_set import wolfrom
    >>> teeth_text(wolfrom(25, 27, 79, 24, 76))
    '25/27/79/24/76'
    """
    planets = {step_name(teeth, step): count for step, count in enumerate(teeth.steps)}
    return "/".join(map(str, in_order(teeth, planets | {mesh.central: mesh.teeth for mesh in teeth.meshes})))


def in_order(teeth: ToothSet, of_gears: Mapping[str, float]) -> tuple[float, ...]:
    """Values of gears, by their names, in the order in which a family writes them: a sun, its planets, their rings."""
    names: list[str] = []
    for mesh in teeth.meshes:
        planet = step_name(teeth, mesh.step)
        names += [planet, mesh.central] if mesh.internal else [mesh.central, planet]
    return tuple(of_gears[name] for name in dict.fromkeys(names))


def _ratio(wish: Wish, teeth: ToothSet) -> float:
    return wish.family.drive.ratio(teeth)


def _size(teeth: ToothSet) -> int:
    return max(mesh.teeth for mesh in teeth.meshes)


def _assembled(wish: Wish, sets: Iterable[ToothSet]) -> tuple[list[ToothSet], tuple[Fallen, ...]]:
    kept, failed = list[ToothSet](), list[str]()
    for teeth in sorted(sets, key=_size):
        faults = teeth.assembly_faults(wish.planets)
        if faults:
            failed.append(f"{teeth_text(teeth)}: {faults[0].words}")
        else:
            kept.append(teeth)
    return kept, (Fallen("assembly", len(failed), failed[0]),) if failed else ()


def _no_ratio(wish: Wish, nearest: ToothSet | None) -> str:
    teeth = wish.teeth
    among = (
        f"with sun and planets of at least {teeth.least} teeth, rings of at most {teeth.largest} and tooth sums within "
        f"{teeth.sum_difference}"
    )
    if nearest is None:
        return f"ratio: there is no {wish.family.words} {among}"
    return (
        f"ratio: no {wish.family.words} {among} has a ratio within {wish.tolerance:g} of {wish.ratio:g}; the nearest, "
        f"{teeth_text(nearest)}, has {_ratio(wish, nearest):.6g}"
    )


def _none_left(wish: Wish, count: int, fallen: Iterable[Fallen]) -> str:
    lines = [f"  {own.condition}: {own.count} fail; {own.nearest}" for own in fallen]
    return "\n".join([f"no {wish.family.words} is left of {count} with that ratio:", *lines])
