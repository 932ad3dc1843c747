"""Draws by the laws of grammar/zone.py: of a feature in its zone, and of a point that touches by its form."""

from typing import Final

from tol3d.assembly.grammar.zone import LawSpec, ProcessLawSpec
from tol3d.assembly.zones import Confined, Process, Zone, normal_in, ring_in, uniform_in
from tol3d.assembly.zones.centred import Centred
from tol3d.files import Files
from tol3d.statistics.distributions import Distribution, TruncatedNormal, Uniform

TILTS: Final = ("rise x", "rise y")
"""Components of planes that a process spreads about 0, whatever its mean: an offset does not tilt a face."""
SIGMAS: Final = 3.0  # of a point that touches, in half of the form's zone, by the law `normal`


def uniform(law: LawSpec, zone: Zone, files: Files) -> Confined:
    """Every displacement that the zone allows."""
    return uniform_in(zone)


def uniform_form(law: LawSpec, half: float, files: Files) -> Distribution:
    """Anywhere in the form's zone."""
    return Uniform(-half, half)


def uniform_fit(law: LawSpec, form: float, files: Files) -> Distribution:
    """Any part of the form."""
    return Uniform(0.0, form)


def normal(law: LawSpec, zone: Zone, files: Files) -> Confined:
    """The middle first, then tilts."""
    return normal_in(zone)


def normal_form(law: LawSpec, half: float, files: Files) -> Distribution:
    """Cut off at the form's zone."""
    return TruncatedNormal(0.0, half / SIGMAS, -half, half)


def normal_fit(law: LawSpec, form: float, files: Files) -> Distribution:
    """The size of a normal law, cut off at the form."""
    return TruncatedNormal(0.0, form / SIGMAS, 0.0, form)


def ring(law: LawSpec, zone: Zone, files: Files) -> Confined:
    """At the edge of a disc."""
    return ring_in(zone)


def process(law: ProcessLawSpec, zone: Zone, files: Files) -> Process:
    """As stated, whatever the zone is."""
    own = law.distribution.resolve(files)
    about_zero = Centred(own)
    return Process(zone, tuple(about_zero if name in TILTS else own for name in zone.components))


def process_form(law: ProcessLawSpec, half: float, files: Files) -> Distribution:
    """As stated."""
    return law.distribution.resolve(files)
