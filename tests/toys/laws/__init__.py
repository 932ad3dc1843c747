"""A law of deviations and no kinds of entry: scenes of any mechanism may state it.

power       deviations that crowd towards the upper limit, as a wearing tool makes them
"""

from typing import Final

from tol3d.study.system.mechanism import Mechanism
from toys.laws.power import PowerSpec

LAWS: Final = Mechanism(name="laws", distributions=(PowerSpec,), requires=("jsonschema",))
