"""Tooth numbers of a planetary set, and results from them alone: ratios, and numbers of planets that can be assembled.

Every central gear k (a sun or a ring) meshes with one step of the planets. Seen from the carrier its turn per turn of
the planets is u_k = -z_p/z_k for a sun and +z_p/z_k for a ring, and u = 0 for the carrier itself. With h held,
omega_i / omega_o = (u_i - u_h) / (u_o - u_h): Willis' equation for any two members of any such set.
"""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from tol3d.errors import GeometryError

CARRIER: Final = "carrier"


@dataclass(frozen=True)
class CentralMesh:
    """One central gear and the step of the planets that it meshes with.

    Args:
        central: name of the central gear, such as "sun" or "ring 2".
        teeth: of the central gear.
        planet_teeth: of that step of the planets.
        internal: whether the central gear is a ring.
        step: of the planets, counted from 0; gears of one step are one and the same gear.
    """

    central: str
    teeth: int
    planet_teeth: int
    internal: bool
    step: int = 0

    @property
    def tooth_sum(self) -> int:
        """z + z_p of a sun, z - z_p of a ring: twice the reference centre distance in modules."""
        return self.teeth - self.planet_teeth if self.internal else self.teeth + self.planet_teeth

    @property
    def turn(self) -> Fraction:
        """Turns of the central gear per turn of the planet, both seen from the carrier."""
        return Fraction(self.planet_teeth if self.internal else -self.planet_teeth, self.teeth)


@dataclass(frozen=True)
class ToothSet:
    """Tooth numbers of a planetary set.

    Args:
        meshes: of its central gears, each with another name; the planets' steps count from 0.

    Raises:
        GeometryError: fewer than 3 teeth, or a ring that is not larger than its planets.

    >>> built = wolfrom(25, 27, 79, 24, 76)
    >>> built.ratio("sun", "ring 2", "ring 1"), float(built.ratio("sun", "ring 2", "ring 1"))
    (Fraction(1368, 25), 54.72)
    >>> built.assembles(4), built.assembles(3)
    (True, False)
    """

    meshes: tuple[CentralMesh, ...]

    def __post_init__(self) -> None:
        for mesh in self.meshes:
            for whose, teeth in ((mesh.central, mesh.teeth), (f"planet of {mesh.central}", mesh.planet_teeth)):
                if teeth < 3:
                    raise GeometryError(f"{whose}: expected at least 3 teeth, got {teeth}")
            if mesh.tooth_sum <= 0:
                raise GeometryError(
                    f"{mesh.central}: a ring needs more teeth than its planets, got {mesh.teeth} and "
                    f"{mesh.planet_teeth}"
                )
        of_steps = {mesh.step: mesh.planet_teeth for mesh in self.meshes}
        for mesh in self.meshes:
            if mesh.planet_teeth != of_steps[mesh.step]:
                raise GeometryError(
                    f"{mesh.central}: step {mesh.step + 1} of the planets has {of_steps[mesh.step]} teeth in another "
                    f"mesh, got {mesh.planet_teeth}"
                )

    def mesh(self, central: str) -> CentralMesh:
        """The mesh of a central gear, by its name."""
        return next(mesh for mesh in self.meshes if mesh.central == central)

    def turn(self, member: str) -> Fraction:
        """u: turns of a member per turn of the planet, both seen from the carrier."""
        return Fraction(0) if member == CARRIER else self.mesh(member).turn

    def ratio(self, input_member: str, output_member: str, held: str) -> Fraction:
        """Speed of the input over that of the output, one member held; negative: they turn in opposite senses.

        Raises:
            GeometryError: the output does not turn.
        """
        at_rest = self.turn(held)
        output = self.turn(output_member) - at_rest
        if output == 0:
            raise GeometryError(
                f"{output_member} does not turn while {held} is held: their teeth over their planets' are alike"
            )
        return (self.turn(input_member) - at_rest) / output

    @property
    def steps(self) -> tuple[int, ...]:
        """Teeth of each step of the planets."""
        teeth = {mesh.step: mesh.planet_teeth for mesh in self.meshes}
        return tuple(teeth[step] for step in sorted(teeth))

    # assembly ---------------------------------------------------------------------------------------

    def assembles(self, planets: int) -> bool:
        """True if identical planets can be assembled at equal angles."""
        return not self.assembly_faults(planets)

    def assembly_faults(self, planets: int) -> "tuple[AssemblyFault, ...]":
        """Pairs of meshes that keep identical planets at equal angles from being assembled; none where they can be.

        Central gears stand still, planet 0 is in mesh. A planet on the arm at the angle 2 pi/n further sees gear k
        turned back by 1/n of a turn, so it must itself stand turned by psi, in turns, with z_p psi = +z/n (sun) or
        -z/n (ring) modulo 1 in every mesh. Two such congruences have a common psi if and only if
        n gcd(z_p1, z_p2) divides (sign z)_1 z_p2 - (sign z)_2 z_p1, and if every two have one, all have: the sets
        {psi} are cosets of subgroups of the rational numbers, whose lattice is distributive. The same step twice
        (sun and ring of one planet) gives the familiar n | z_S + z_R; two steps of a Wolfrom set give
        n gcd(z_P1, z_P2) | z_S z_P2 + z_R2 z_P1. How step 2 is clocked to step 1 cancels, as long as it is alike in
        all planets.
        """
        return tuple(
            fault
            for k, first in enumerate(self.meshes)
            for second in self.meshes[k + 1 :]
            if (fault := _assembly_fault(first, second, planets)) is not None
        )

    def clocking(self, planets: int, step: int = 1) -> tuple[Fraction, ...]:
        """Turn of a step against step 1 [turns] that each planet at equal angles needs beyond planet 0's; smallest.

        All 0 where identical planets assemble. Both steps fit again after 1/lcm of their teeth.

        Raises:
            GeometryError: one of the two steps does not assemble by itself.

        >>> wolfrom(22, 28, 78, 24, 74).clocking(4)
        (Fraction(0, 1), Fraction(1, 336), Fraction(0, 1), Fraction(1, 336))
        """
        own = {k: [mesh for mesh in self.meshes if mesh.step == k] for k in (0, step)}
        for meshes in own.values():
            for fault in ToothSet(tuple(meshes)).assembly_faults(planets):
                raise GeometryError(fault.words)
        first, second = (Fraction(_phase(own[k][0]), own[k][0].planet_teeth) for k in (0, step))
        again = Fraction(1, math.lcm(*(own[k][0].planet_teeth for k in (0, step))))
        turns = (((second - first) * Fraction(k, planets)) % again for k in range(planets))
        return tuple(turn - again if turn > again / 2 else turn for turn in turns)


@dataclass(frozen=True)
class AssemblyFault:
    """Two meshes that no orientation of the next planet fits both.

    Args:
        meshes: names of both central gears.
        planets: n.
        divisor: n gcd of the planets' teeth.
        product: number that it should divide.
    """

    meshes: tuple[str, str]
    planets: int
    divisor: int
    product: int

    @property
    def words(self) -> str:
        """The condition with its numbers."""
        first, second = self.meshes
        return (
            f"{self.planets} identical planets at equal angles do not assemble between {first} and {second}: "
            f"{self.product} is not divisible by {self.divisor}"
        )


def _assembly_fault(first: CentralMesh, second: CentralMesh, planets: int) -> AssemblyFault | None:
    product = abs(_phase(first) * second.planet_teeth - _phase(second) * first.planet_teeth)
    divisor = planets * math.gcd(first.planet_teeth, second.planet_teeth)
    if product % divisor == 0:
        return None
    if first.step == second.step:
        product, divisor = product // first.planet_teeth, planets
    return AssemblyFault((first.central, second.central), planets, divisor, product)


def _phase(mesh: CentralMesh) -> int:
    """Pitches by which a whole turn of the arm turns the planet on: the sun's teeth, or the ring's backwards."""
    return -mesh.teeth if mesh.internal else mesh.teeth


# the usual sets ---------------------------------------------------------------------------------------


def simple(sun: int, planet: int, ring: int) -> ToothSet:
    """Sun, planets, ring.

    >>> simple(20, 25, 70).ratio("sun", "carrier", "ring")
    Fraction(9, 2)
    """
    return ToothSet((CentralMesh("sun", sun, planet, False), CentralMesh("ring", ring, planet, True)))


def compound(sun: int, planet_1: int, planet_2: int, ring: int) -> ToothSet:
    """A sun on one step of stepped planets, a ring on the other.

    >>> compound(20, 40, 20, 80).ratio("sun", "carrier", "ring")
    Fraction(9, 1)
    """
    return ToothSet((CentralMesh("sun", sun, planet_1, False), CentralMesh("ring", ring, planet_2, True, 1)))


def wolfrom(sun: int, planet_1: int, ring_1: int, planet_2: int, ring_2: int) -> ToothSet:
    """The 3K set: a sun and a ring on step 1 of the planets, a second ring on step 2.

    With ring 1 held, sun over ring 2 turns by (1 + I1)/(1 - I2), I1 = z_R1/z_S, I2 = z_R1 z_P2/(z_R2 z_P1).
    """
    return ToothSet(
        (
            CentralMesh("sun", sun, planet_1, False),
            CentralMesh("ring 1", ring_1, planet_1, True),
            CentralMesh("ring 2", ring_2, planet_2, True, 1),
        )
    )
