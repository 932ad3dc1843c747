"""Which measures of an assembly FCL can read too. Loads neither FCL nor solids."""

from tol3d.assembly.model import Assembly
from tol3d.assembly.model.moves import is_inner


def reads(assembly: Assembly, name: str) -> bool:
    """True if FCL reads a measure: a clearance of parts, or a gap of surfaces neither of which is a hole or socket."""
    measured = assembly.measures[name]
    if measured.minus is not None or measured.rocking is not None or measured.over_play is not None:
        return False
    if measured.reads.by_solids:
        return True
    shapes = (assembly.features[feature].shape for feature in measured.features)
    return measured.kind == "surface_gap" and not any(map(is_inner, shapes))
