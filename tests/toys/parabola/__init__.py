"""Springs that lift by y = a x + b x^2 and more: sums of independent terms, so every moment has a closed form.

grammar     what scenes say
springs     the numbers of a scene
methods       the theory, the parabola itself, and its chords as a witness
system      all that a study asks
cumulants   the closed forms, for tests
summary     what summaries hold besides
showing     bodies, a picture, a table
"""

from typing import Final

from tol3d.study.system.mechanism import Mechanism
from toys.parabola import grammar

PARABOLA: Final = Mechanism(
    name="parabola",
    parts=(grammar.SpringSpec,),
    tolerances=(grammar.AbscissaSpec, grammar.OffsetSpec, grammar.RippleSpec, grammar.WaveSpec),
    moves=(grammar.LiftSpec,),
    measures=(grammar.HeightSpec, grammar.RoomSpec),
    options=grammar.SpringOptions,
    published=grammar.PublishedTerms,
    engines=("exact", "chords"),
    witness="chords",
    system="toys.parabola.system:parabola_system",
    summary="toys.parabola.summary:SUMMARY_KINDS",
    presenter="toys.parabola.showing",
    requires=("jsonschema",),
)
