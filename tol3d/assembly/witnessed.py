"""Which measures of an assembly FCL can read too. Loads neither FCL nor solids."""

import numpy as np

from tol3d.assembly.model import Assembly, Feature
from tol3d.assembly.placing.surfaces import PARALLEL


def reads(assembly: Assembly, name: str) -> bool:
    """True if FCL reads a measure: a clearance of parts, or a gap of surfaces neither of which is a hole or socket."""
    measured = assembly.measures[name]
    if measured.minus is not None or measured.rocking is not None or measured.over_play is not None:
        return False
    if measured.reads.by_solids:
        return True
    if measured.kind != "surface_gap":
        return False
    features = [assembly.features[feature] for feature in measured.features]
    return not any(feature.shape.inner for feature in features) and not _face_with_their_ends(assembly, *features)


def _face_with_their_ends(assembly: Assembly, start: Feature, end: Feature) -> bool:
    """True for parallel cylinders that nominally have no length in common."""
    if (start.shape.surface, end.shape.surface) != ("axis", "axis"):
        return False
    own, other = (assembly.part[feature.part].pose @ feature.frame for feature in (start, end))
    apart = abs(float(own[:3, 2] @ (other[:3, 3] - own[:3, 3])))
    is_parallel = float(np.linalg.norm(np.cross(own[:3, 2], other[:3, 2]))) < PARALLEL
    return is_parallel and apart > start.shape.reach[0] + end.shape.reach[0]
