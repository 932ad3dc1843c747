"""Any RV reducer with all kinds of errors, by search, from its numbers and a trial's columns alone.

Everything lies in the world, as complex numbers; the sun stands. Feet of pins on a flank are looked for from a dense
row of places, discs that lean are cut at many heights, and the output goes on by the least gap over its lever until
nothing is left of it: no pin is sought by itself.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from oracles.drawn_columns import DrawnColumns

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

PRESSURE_ANGLE: Final = np.radians(20.0)
PLACES: Final = np.linspace(-0.05, 0.55, 49)  # of a lobe, and a bit of what lies beyond its half
HEIGHTS: Final = 81
CENTRAL: Final = ("sun", "carrier", "pin ring")


def involute(angle: Array) -> Array:
    return np.asarray(np.tan(angle) - angle)


@dataclass(frozen=True)
class Numbers:
    """Numbers of a reducer [mm, rad].

    Args:
        pins, circle, pin_radius, eccentricity: of the ring and the cranks.
        shift, offset, rotation: modifications of the discs.
        width: of a disc.
        discs, cranks, window: how many, and the least share of the longest lever with which a pin works.
        cranks_circle: radius on which the cranks lie.
        teeth: of the sun and of a planet of 20 degrees; None without a first stage.
        module: of those.
    """

    pins: int
    circle: float
    pin_radius: float
    eccentricity: float
    shift: float
    offset: float
    rotation: float
    width: float
    discs: int
    cranks: int
    window: float
    cranks_circle: float
    teeth: tuple[int, int] | None
    module: float

    @property
    def lobes(self) -> int:
        return self.pins - 1

    @property
    def around(self) -> Complex:
        """Directions of the cranks in the carrier."""
        return np.exp(2j * np.pi * np.arange(self.cranks) / self.cranks)


class WholeReducer:
    """One trial. Tolerances have the names by which they are read here; those of bores rest in the world."""

    def __init__(self, own: Numbers, drawn: DrawnColumns) -> None:
        self.own = own
        pins, discs, cranks = own.pins, range(1, own.discs + 1), range(1, own.cranks + 1)
        each = [f"pin {pin + 1}" for pin in range(pins)]
        outwards = drawn.one("circle") + drawn.all("outwards", *each) + 1j * drawn.all("round", *each)
        towards = np.exp(2j * np.pi * np.arange(pins) / pins)
        self.pins = (own.circle + outwards + drawn.plane("anywhere", *each)) * towards + drawn.plane("ring", "")[0]
        bores = {name: complex(drawn.one(f"{name} bore x"), drawn.one(f"{name} bore y")) for name in CENTRAL}
        self.sun_bore, self.carrier_bore, self.pins = bores["sun"], bores["carrier"], self.pins + bores["pin ring"]
        self.radii = own.pin_radius + drawn.all("radii", *each)
        lobes = [[f"disc {disc} lobe {lobe + 1}" for lobe in range(own.lobes)] for disc in discs]
        self.pitch = np.stack([drawn.all("pitch", *one) for one in lobes])
        self.profile = np.stack([drawn.all("profile", *one) for one in lobes])
        named = [f"disc {disc}" for disc in discs]
        self.offsets, self.tilts = drawn.plane("run-out", *named), drawn.plane("tilts", *named)
        holes = [drawn.plane("disc holes", *(f"disc {disc} hole {crank}" for crank in cranks)) for disc in discs]
        self.bored = own.cranks_circle * own.around + np.stack(holes)
        throws = [drawn.plane("throws", *(f"crank {crank} disc {disc}" for crank in cranks)) for disc in discs]
        self.thrown = np.stack(throws) + drawn.plane("throws alike", *named)[:, None]
        self.phases = drawn.all("phases", *(f"crank {crank}" for crank in cranks))
        self.axes = own.cranks_circle * own.around + drawn.plane("bearing", "") + drawn.plane("circle of holes", "")
        self.axes = self.axes + drawn.plane("holes", *(f"hole {crank}" for crank in cranks))
        planets = [f"planet {crank}" for crank in cranks]
        self.sun_off, self.planets_off = drawn.plane("sun", "")[0], drawn.plane("planets", *planets)
        self.thicker = drawn.one("sun teeth"), drawn.all("planet teeth", *planets) / np.cos(PRESSURE_ANGLE)

    def throws_at(self, position: float, carrier: float, sense: int) -> Array:
        """Angles of the throws (cranks,) in the world, where the sun holds the planets that a load presses on it."""
        own = self.own
        nominal = -own.lobes * position
        if own.teeth is None:
            return nominal + self.phases
        z1, z2 = own.teeth
        bases = own.module * np.cos(PRESSURE_ANGLE) / 2 * np.array([z1, z2])
        sun = self.sun_off * np.exp(1j * position * (1 + z2 / z1 * own.pins)) + self.sun_bore
        ray = 2 * np.pi * np.arange(own.cranks) / own.cranks
        # a planet's x points so that where its crank's throw has turned by 0 a space of its teeth faces the sun
        x = np.exp(1j * (np.pi + np.pi / z2 + ray * (1 + z1 / z2)))
        wide = np.pi / 2 + self.thicker[0] / own.module, np.pi / 2 + self.thicker[1] / own.module
        half = wide[0] / z1 + involute(PRESSURE_ANGLE), wide[1] / z2 + involute(PRESSURE_ANGLE)
        pitch = np.pi * own.module * np.cos(PRESSURE_ANGLE)
        turned = np.full(own.cranks, nominal)
        for _ in range(12):
            line = (
                np.exp(1j * carrier) * self.axes + self.carrier_bore + self.planets_off * x * np.exp(1j * turned) - sun
            )
            meets = np.arccos(bases.sum() / abs(line))
            room = pitch / 2 - bases[0] * half[0] - bases[1] * half[1] + bases.sum() * involute(meets)
            aside = np.angle(line * np.exp(-1j * (position + ray)))
            turned = nominal + (bases.sum() * aside - sense * room) / bases[1]
        throws = turned + self.phases
        return np.full(own.cranks, throws.max() if sense > 0 else throws.min())

    def gaps(self, position: float, turn: float, sense: int, disc: int, pins: NDArray[np.int64]) -> Array:
        """Gaps of pins to a disc [mm], where the output stands a turn beyond its position."""
        own, carrier = self.own, position + turn
        throw = 2 * np.pi * disc / own.discs
        throws = self.throws_at(position, carrier, sense)
        eccentrics = np.exp(1j * carrier) * self.axes + self.carrier_bore
        eccentrics = eccentrics + np.exp(1j * throws) * (own.eccentricity * np.exp(1j * throw) + self.thrown[disc])
        bored, middle = self.bored[disc], eccentrics.mean()
        leads = np.angle(np.sum((eccentrics - middle) * np.conj(bored - bored.mean())))
        centre = middle + np.exp(1j * leads) * (self.offsets[disc] - bored.mean())
        seen = (self.pins[pins] - centre) * np.exp(-1j * (leads - throw / own.lobes))
        lobe = np.floor(np.mod(np.angle(seen), 2 * np.pi) * own.lobes / (2 * np.pi)).astype(int) % own.lobes
        turned = self.pitch[disc, lobe] * own.pins / (own.lobes * own.circle)
        seen = seen * np.exp(-1j * turned)
        tilt = self.tilts[disc] * np.exp(1j * throw / own.lobes)
        gaps = self.flank_gaps(cut(seen, tilt, own.width)) - self.radii[pins] - self.profile[disc, lobe]
        if not tilt:
            return np.asarray(gaps[0])
        least = gaps.argmin(axis=0)
        inside = np.flatnonzero((least > 0) & (least < HEIGHTS - 1))
        before, at, after = (gaps[least[inside] + k, inside] for k in (-1, 0, 1))
        found = gaps.min(axis=0)
        found[inside] = at - (before - after) ** 2 / (8 * (before - 2 * at + after))  # of the parabola through them
        return np.asarray(found)

    def flank_gaps(self, seen: Complex) -> Array:
        """Distances of points from the flank of a nominal lobe and its mirror, plus the pin's radius [mm]."""
        own, period = self.own, 2 * np.pi / self.own.lobes
        along = np.mod(np.angle(seen), period)
        folded = abs(seen) * np.exp(1j * (np.minimum(along, period - along) - own.rotation))
        scan = PLACES * period
        u = scan[abs(folded[..., None] - self.path(scan)[0]).argmin(axis=-1)]
        for _ in range(8):
            point, slope, bend = self.path(u)
            off = folded - point
            step = (off * np.conj(slope)).real / ((off * np.conj(bend)).real - abs(slope) ** 2)
            u = u - step.clip(-0.02 * period, 0.02 * period)
        point, slope, _ = self.path(u)
        return np.asarray(((folded - point) * np.conj(-1j * slope / abs(slope))).real + own.pin_radius + own.offset)

    def path(self, u: Array) -> tuple[Complex, Complex, Complex]:
        """Path of pin centres about the disc, its slope and its bend."""
        own = self.own
        circle, wave = (own.circle + own.shift) * np.exp(1j * u), own.eccentricity * np.exp(1j * own.pins * u)
        return circle - wave, 1j * (circle - own.pins * wave), own.pins**2 * wave - circle

    def output(self, position: float, sense: int) -> tuple[float, int, int]:
        """Turn of the output until the first pin touches [rad], the disc and the pin, counted from 1."""
        own = self.own
        k, longest = own.eccentricity * own.pins / own.circle, own.eccentricity * own.lobes
        azimuths = 2 * np.pi * np.arange(own.pins) / own.pins
        turn = 0.0
        for _ in range(40):
            steps: list[float] = []
            places: list[tuple[int, int]] = []
            for one in range(own.discs):
                phase = own.lobes * (azimuths - position) + 2 * np.pi * one / own.discs
                lever = -longest * np.sin(phase) / np.sqrt(1 + k * k - 2 * k * np.cos(phase))
                works = np.flatnonzero(sense * lever > own.window * longest)
                steps.extend(self.gaps(position, turn, sense, one, works) / abs(lever[works]))
                places.extend((one + 1, int(pin) + 1) for pin in works)
            first = int(np.argmin(steps))
            turn += sense * steps[first]
            if abs(steps[first]) < 1e-13:
                break
        return (turn, *places[first])


def cut(seen: Complex, tilt: complex, width: float) -> Complex:
    """Intersections of upright lines with planes of a disc (heights, lines), in its frame; one plane if it lies flat.

    Args:
        seen: intersections with its middle, were it upright.
        tilt: the axis it leans about, as long as the angle [rad].
        width: of the disc [mm].
    """
    if not tilt:
        return seen[None]
    size, (x, y) = abs(tilt), (tilt.real / abs(tilt), tilt.imag / abs(tilt))
    cross = np.array([[0.0, 0.0, y], [0.0, 0.0, -x], [-y, x, 0.0]])
    back = (np.eye(3) + np.sin(size) * cross + (1 - np.cos(size)) * cross @ cross).T
    heights = np.linspace(-width / 2, width / 2, HEIGHTS)[:, None]
    up = (heights - back[2, 0] * seen.real - back[2, 1] * seen.imag) / back[2, 2]
    point = back[:, 0, None, None] * seen.real + back[:, 1, None, None] * seen.imag + back[:, 2, None, None] * up
    return np.asarray(point[0] + 1j * point[1])
