"""Cycloid stages with errors on everything, and a dense search for their first contacts that shares no code."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tol3d.gearing.cycloid.exact.contact import AsMade, bearings, linkage, pin_centres
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification

Array = NDArray[np.float64]

CRANK_CIRCLE = 60.0
SHORTENING = 2.2 * 40 / 114.5
CLEARED = Modification(shift=-0.02, offset=-0.02 * math.sqrt(1 - SHORTENING**2))
PROFILE = DiscProfile(40, 114.5, 5.0, 2.2, CLEARED)


def perfect(trials: int = 1, discs: int = 2, profile: DiscProfile = PROFILE) -> AsMade:
    """A stage without errors."""
    return erring(trials, discs, 0.0, seed=0, profile=profile)


def erring(trials: int, discs: int, scale: float, seed: int, profile: DiscProfile = PROFILE) -> AsMade:
    """A stage all of whose numbers err by `scale` [mm, and rad times 100 mm]; pins and lobes by half of it."""
    rng = np.random.default_rng(seed)

    def drawn(*sizes: int) -> Array:
        return scale * rng.standard_normal((trials, *sizes))

    return AsMade(
        linkage(
            bearings(
                profile.eccentricity,
                CRANK_CIRCLE,
                drawn(discs, 2),
                drawn(discs, 3, 2),
                drawn(3, discs, 2),
                drawn(3) / 100,
                drawn(3, 2),
                drawn(2),
            )
        ),
        pin_centres(profile.pin_circle_radius, drawn(profile.pins, 2) / 2),
        profile.pin_radius + drawn(profile.pins) / 2,
        drawn(discs, profile.lobes) / 2,
        drawn(discs, profile.lobes) / 2,
    )


def digest_draw(trials: int, discs: int, seed: int) -> AsMade:
    """The tolerances of the RV-250AII as the geometric Monte Carlo of the paper's digest takes them; no carrier."""
    rng = np.random.default_rng(seed)

    def drawn(sd: float, *sizes: int) -> Array:
        return sd * rng.standard_normal((trials, *sizes))

    circle = drawn(0.0175 / 3, 1, 1)
    pins = np.concatenate([np.repeat(circle, 40, axis=1), drawn(0.0001 / 3, 40, 1)], axis=2)
    cranks = np.repeat(drawn(0.004 / 6, 1, discs, 2), 3, axis=1)
    nothing = np.zeros((trials, discs, 3, 2))
    made = linkage(bearings(
        2.2, CRANK_CIRCLE, drawn(0.012 / 6, discs, 2), nothing, cranks,
        nothing[:, 0, :, 0], nothing[:, 0], nothing[:, 0, 0],
    ))  # fmt: skip
    return AsMade(
        made,
        pin_centres(114.5, pins),
        np.full((trials, 40), 5.0),
        drawn(0.01 / 3, discs, 39),
        drawn(0.0005 / 3, discs, 39),
    )


Tilts = tuple[Array, float]
FLAT: Tilts = (np.zeros((2, 2)), 0.0)


def searched(
    made: AsMade, trial: int, phi: float, sense: int, window: float, rolling: float, profile: DiscProfile = PROFILE,
    tilts: Tilts = FLAT,
) -> tuple[float, int]:  # fmt: skip
    """First contact in a sense by bisection over the turn; each distance is the least to dense points of all flanks.

    Tilts are rotations of the discs about axes in their plane (discs, 2) [rad], and the width of their faces [mm]: pins
    are upright, and see the points of a disc where they lie above their plane.
    """
    discs = made.linkage.shape[1]
    found = [
        (sense * _turn(made, trial, phi, (disc, pin), rolling, profile, tilts), disc * profile.pins + pin)
        for disc in range(discs)
        for pin in range(profile.pins)
        if -sense * _lever(2 * math.pi * (pin / profile.pins - disc / discs) - phi, profile) > window
    ]
    turn, place = min(found)
    return sense * turn, place


def counted(
    made: AsMade, trial: int, phi: float, first: tuple[float, int], window: float, deflection: float,
    profile: DiscProfile = PROFILE,
) -> tuple[int, float]:  # fmt: skip
    """Working pins of the first one's sense whose gap is within a deflection at its turn, and the gap nearest to it."""
    turn, place = first
    sense = 1 if _lever(_phase(place, made, phi, profile), profile) > 0 else -1
    places = [own for own in range(made.linkage.shape[1] * profile.pins)
              if sense * _lever(_phase(own, made, phi, profile), profile) > window]  # fmt: skip
    gaps = [
        _gap(made, trial, phi, at, turn, 0.0, _sections(made, trial, phi, at, profile, FLAT))
        for at in (divmod(own, profile.pins) for own in places)
    ]
    return sum(gap <= deflection for gap in gaps), min(gaps, key=lambda gap: abs(gap - deflection))


def _phase(place: int, made: AsMade, phi: float, profile: DiscProfile) -> float:
    disc, pin = divmod(place, profile.pins)
    return 2 * math.pi * (pin / profile.pins - disc / int(made.linkage.shape[1])) - phi


def _lever(phase: float, profile: DiscProfile) -> float:
    """Lever of a pin about the disc's axis, over a Zc; positive where it stops clockwise turning."""
    k = profile.eccentricity * profile.pins / profile.pin_circle_radius
    return -math.sin(phase) / math.sqrt(1 + k * k - 2 * k * math.cos(phase))


def _turn(
    made: AsMade, trial: int, phi: float, at: tuple[int, int], rolling: float, profile: DiscProfile, tilts: Tilts
) -> float:  # fmt: skip
    """Turn at which the gap of one pin changes its sign."""
    low, high = -4e-4, 4e-4
    sections = _sections(made, trial, phi, at, profile, tilts)
    before = _gap(made, trial, phi, at, low, rolling, sections) > 0
    for _ in range(28):
        middle = (low + high) / 2
        if (_gap(made, trial, phi, at, middle, rolling, sections) > 0) == before:
            low = middle
        else:
            high = middle
    return (low + high) / 2


Sections = Callable[[Array, Array], NDArray[np.complex128]]


def _sections(
    made: AsMade, trial: int, phi: float, at: tuple[int, int], profile: DiscProfile, tilts: Tilts
) -> tuple[Sections, float, float]:  # fmt: skip
    """Points of a disc in the frame of its holes by parameters and heights; a parameter by the pin; half its width."""
    disc, pin = at
    throw = 2 * math.pi * disc / made.linkage.shape[1]
    radius, grinding = profile.pin_circle_radius + profile.modification.shift, profile.pin_radius
    grinding += profile.modification.offset
    tilt = Rotation.from_rotvec([*tilts[0][disc], 0.0]).as_matrix()

    def points(u: Array, heights: Array) -> NDArray[np.complex128]:
        lobe = np.floor(u * profile.lobes / (2 * math.pi)).astype(int) % profile.lobes
        path = radius * np.exp(1j * u) - profile.eccentricity * np.exp(1j * profile.pins * u)
        slope = radius * np.exp(1j * u) - profile.eccentricity * profile.pins * np.exp(1j * profile.pins * u)
        flat = path - (grinding - made.lobe_profile[trial, disc, lobe]) * slope / abs(slope)
        own = made.lobe_pitch[trial, disc, lobe] * profile.shortening / profile.pitch_radius - throw / profile.lobes
        flat = flat * np.exp(1j * (own + profile.modification.rotation * np.sign(np.sin(profile.lobes * u))))
        whole = [np.broadcast_to(each, (len(heights), len(u))) for each in (flat.real, flat.imag, heights[:, None])]
        x, y, _ = np.einsum("ij,jhu->ihu", tilt, np.stack(whole))
        return np.asarray(x + 1j * y)

    return points, 2 * math.pi * pin / profile.pins + (phi + throw) / profile.lobes, tilts[1] / 2


def _gap(
    made: AsMade, trial: int, phi: float, at: tuple[int, int], turn: float, rolling: float,
    sections: tuple[Sections, float, float],
) -> float:  # fmt: skip
    """Distance from a pin's centre to points of the disc's flanks, refined fourfold, less the pin's radius [mm]."""
    (disc, pin), (points, near, half) = at, sections
    parts = made.linkage[trial, disc].view(np.complex128)
    lobes = made.lobe_pitch.shape[2]
    carrier, crank = np.exp(1j * (turn - phi / lobes)), np.exp(1j * (phi + rolling * turn))
    turned = carrier * parts[3] + crank * parts[4]
    turned /= abs(turned)
    centre = carrier * parts[0] + crank * parts[1] - turned * parts[2]
    seen = (complex(*made.pins[trial, pin]) - centre) * np.conj(turned)
    low, high, below, above = near - 1.5 * math.pi / lobes, near + 1.5 * math.pi / lobes, -half, half
    for _ in range(4):
        u, heights = np.linspace(low, high, 301), np.linspace(below, above, 5 if half else 1)
        far = abs(points(u, heights) - seen)
        row, column = np.unravel_index(far.argmin(), far.shape)
        step, rise = 2 * (u[1] - u[0]), (above - below) / 4
        low, high = u[column] - step, u[column] + step
        below, above = max(float(heights[row]) - rise, -half), min(float(heights[row]) + rise, half)
    return float(far.min() - made.pin_radii[trial, pin])
