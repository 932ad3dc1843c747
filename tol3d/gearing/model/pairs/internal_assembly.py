"""How a gear comes into its ring."""

from tol3d.gearing.model.pairs.pair import assembly_warning
from tol3d.gears import InternalPair


@assembly_warning.register
def _(pair: InternalPair) -> str:
    if pair.radially_assembled:
        return ""
    return (
        f"the gear of {pair.inner.teeth} teeth goes into the ring of {pair.ring.teeth} along its axis only: moved "
        "along the line of centres its teeth meet the ring's"
    )
