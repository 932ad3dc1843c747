"""Touches of a scene."""

from collections.abc import Mapping

from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.moves import TouchSpec
from tol3d.assembly.model import Contact, Feature, Touch
from tol3d.assembly.model.touch import unfit_for_contact
from tol3d.scene import Scene


def touch(scene: Scene, name: str, spec: TouchSpec, features: Mapping[str, Feature]) -> Touch:
    """A touch of a scene.

    Raises:
        SceneError: surfaces that do not touch as contacts ask.
    """
    for path, pair in spec.paired():
        if words := unfit_for_contact(features[pair.from_].shape, features[pair.to].shape):
            raise scene.refuse(("moves", name, *path), words)
    contacts = tuple(Contact(pair.from_, pair.to) for pair in spec.contacts)
    return Touch(name, spec.part, contacts, None if spec.pressed is None else unit(spec.pressed))
