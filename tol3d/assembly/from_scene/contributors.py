"""Contributors of a scene, and the effect of each on features and locators."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tol3d.assembly.from_scene.effects import NO_EFFECTS, Drawn, Effect, Effects, Touch
from tol3d.assembly.from_scene.segments import motion_of
from tol3d.assembly.from_scene.zones import drawn_in, enveloped, sized_by
from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.forms import whole_form
from tol3d.assembly.grammar.moves import AssemblyMoveSpec
from tol3d.assembly.grammar.tolerances.location import FormSpec, LocationSpec, OrientationSpec, is_of_round_surface
from tol3d.assembly.grammar.tolerances.plus_minus import LocatorSpec, PlusMinusSpec, SizeSpec
from tol3d.assembly.zones import EnvelopedForm, FittedForm
from tol3d.import_path import named
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.statistics.distributions import Distribution
from tol3d.study.system.draw import Draw, Each, Scalar
from tol3d.study.system.plain import PlainContributor


@dataclass(frozen=True)
class _Tolerances:
    """Tolerances of a scene, and what decides how each of them acts.

    Args:
        drawing: tolerances by feature.
        touching: the pairs at which each feature touches, by what touches it there; the same for all pairs of two
            features.
        fitting: features that engage with play.
    """

    drawing: Drawing
    touching: Mapping[str, Mapping[str, Sequence[Touch]]]
    fitting: frozenset[str]

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.drawing.scene

    def drawn(self) -> Iterator[Drawn]:
        """Their draws, in the scene's order; the motion of a pattern after its last feature."""
        for own in self.drawing.stated:
            if isinstance(own, str):
                yield self._locator(own)
                continue
            match own.spec:
                case PlusMinusSpec() | SizeSpec():
                    yield self._dimension(own, own.spec)
                case LocationSpec():
                    yield self._zone(own)
                case OrientationSpec() if own.spec.law is not None:
                    yield self._zone(own)
                case FormSpec() if own.spec.law is not None:
                    yield from self._form(own, own.spec)
            if (pattern := self.drawing.composite(own)) and own is pattern[-1]:
                yield self._motion(pattern)

    def _motion(self, pattern: Sequence[Stated]) -> Drawn:
        """The motion of a pattern as a whole, which a composite tolerance leaves it."""
        own = pattern[0]
        draw, moved, word = motion_of(self.scene, self.drawing, pattern)
        made = PlainContributor(
            motion_name(own, word),
            own.spec.kind,
            draw,
            description=f"of all features of {own.entry} together",
            line=f"{own.entry} {word}",
            nominal="",
        )
        return Drawn(made, tuple(Effect("moved_by", feature, matrix) for feature, matrix in moved.items()))

    def _locator(self, name: str) -> Drawn:
        spec = self.scene.tolerances[name]
        assert isinstance(spec, LocatorSpec)
        draw = Scalar(spec.distribution.resolve(self.scene.files))
        made = PlainContributor(name, spec.kind, draw, description=spec.description, nominal=spec.nominal)
        return Drawn(made, (Effect("locators", (spec.of, spec.pair), np.eye(1)),))

    def _dimension(self, own: Stated, spec: PlusMinusSpec | SizeSpec) -> Drawn:
        draw = Scalar(spec.distribution.resolve(self.scene.files))
        made = _of_line(own, draw, nominal=spec.nominal)
        if not isinstance(spec, SizeSpec):
            return Drawn(made, (Effect("moved_by", own.feature, self._along(own.feature, spec)[:, None]),))
        self._refuse_no_size(own, draw)
        effects = [Effect("size_by", own.feature, np.eye(1))]
        if (by_size := self.drawing.kind(own.feature).shape.by_size).any():
            effects.append(Effect("moved_by", own.feature, by_size[:, None]))
        return Drawn(made, tuple(effects))

    def _refuse_no_size(self, own: Stated, draw: Scalar) -> None:
        """A law that leaves nothing of a diameter or width, or more than doubles it."""
        shape = self.drawing.kind(own.feature).shape
        nominal = shape.nominal_size
        if nominal is not None and nominal + draw.distribution.low <= 0.0:
            words = f"expected sizes above 0, got down to {draw.distribution.low:g} mm on a nominal {nominal:g} mm"
            raise self.scene.refuse(("tolerances", own.entry, "distribution"), words)
        if nominal is not None and draw.distribution.high >= nominal:
            words = (
                f"expected deviations smaller than the nominal {nominal:g} mm, got up to {draw.distribution.high:g} mm"
            )
            advice = "state the deviation from nominal, not the size, and check the unit"
            raise self.scene.refuse(("tolerances", own.entry, "distribution"), f"{words}; {advice}")

    def _along(self, feature: str, spec: PlusMinusSpec) -> Array:
        """Change of a feature's components per mm along a dimension."""
        own = self.drawing.kind(feature)
        direction = self.drawing.positive(feature, spec)
        assert direction is not None, "refused before"
        along = own.frame[:3, :3].T @ direction
        return own.shape.moved(lambda _: along)

    def _zone(self, own: Stated) -> Drawn:
        draw, matrix = drawn_in(self.scene, own, self.drawing)
        effects = [Effect("moved_by", own.feature, matrix)]
        if is_of_round_surface(own.spec, self.drawing.kind(own.feature).kind):
            shape, larger = self.drawing.kind(own.feature).shape, np.zeros((1, matrix.shape[1]))
            larger[0, 0] = (-2.0 if shape.inner else 2.0) * shape.slant  # outward is out of the material
            effects.append(Effect("size_by", own.feature, larger))
        return Drawn(_of_line(own, draw), tuple(effects))

    def _form(self, own: Stated, spec: FormSpec) -> Iterator[Drawn]:
        others = self.touching.get(own.feature, {})
        alike = [each.feature for each in self.drawing.stated if isinstance(each, Stated) and each.entry == own.entry]
        if own.feature in self.fitting:
            yield self._form_in_fit(own, spec)
            return
        if not others and (own.alike or any(self.touching.get(each) or each in self.fitting for each in alike)):
            return  # a copy of the toleranced part, or one of a pattern, without a touch
        if not others:
            raise self.scene.refuse(("tolerances", own.entry, "law"), self._untouched(own))
        assert spec.law is not None
        if not spec.law.touching:
            words = f"expected uniform, normal or process, got {spec.law.kind} of a {spec.kind} of {own.feature!r}"
            raise self.scene.refuse(("tolerances", own.entry, "law"), f"{words}; {spec.law.lies}")
        law: Distribution = named(spec.law.touching)(
            spec.law, 0.5 * whole_form(spec, self.drawing.kind(own.feature).shape), self.scene.files
        )
        heights = zip(np.eye(len(others)), others.values(), strict=True)
        effects = (Effect("heights", touch, row[None]) for row, touches in heights for touch in touches)
        yield Drawn(_of_line(own, Each(law, tuple(others))), tuple(effects))

    def _form_in_fit(self, own: Stated, spec: FormSpec) -> Drawn:
        """The form by which a fit sees a larger pin or tab, or a smaller hole or slot."""
        assert spec.law is not None
        if not spec.law.fitting:
            words = f"expected uniform or normal, got {spec.law.kind} of a {spec.kind} of {own.feature!r}"
            raise self.scene.refuse(("tolerances", own.entry, "law"), f"{words}, whose form takes of a fit")
        others = [each for each in self.drawing.of(own.feature, FormSpec) if getattr(each.spec, "law", None)]
        if other := next((each for each in others if each.entry != own.entry), None):
            words = (
                f"expected one form of {own.feature!r} with a law, for they do not add up in a fit, got {other.entry!r}"
            )
            raise self.scene.refuse(("tolerances", own.entry, "law"), f"{words} too; leave out that of the wider one")
        shape, law = self.drawing.kind(own.feature).shape, named(spec.law.fitting)
        form = whole_form(spec, shape)
        draw: Draw = FittedForm(law(spec.law, form, self.scene.files))
        if self.drawing.is_enveloped(own.feature):
            size = sized_by(self.drawing, own.feature, "mmc")
            share = law(spec.law, 1.0, self.scene.files)
            draw = EnvelopedForm(share, spec.law.kind, enveloped(size, self.drawing, own.feature, form))
        sign = np.array([[-1.0 if shape.inner else 1.0]])
        return Drawn(_of_line(own, draw), (Effect("formed_by", own.feature, sign),))

    def _untouched(self, own: Stated) -> str:
        words = f"expected a feature that touches a point in a move, got {own.feature!r}"
        lay = "lay it on points (kind: three_two_one, with points_on: fixture where its part is the one that is placed)"
        located = self.drawing.of(own.feature, LocationSpec)
        then = f"only narrows {located[0].entry!r}" if located else "acts on nothing"
        return f"{words}; {lay}, or leave the law out, and the form {then}"


def _of_line(own: Stated, draw: Draw, *, nominal: str = "") -> PlainContributor:
    """The contributor of a tolerance of one feature."""
    return PlainContributor(
        own.name, own.spec.kind, draw, description=own.spec.description, line=own.entry, nominal=nominal
    )


def motion_name(own: Stated, word: str) -> str:
    """The name of a pattern's motion: "holes shift and turn", "holes shift of cover 2"."""
    return f"{own.entry} {word}" + (f" of {part_of(own.feature)}" if own.alike else "")


def effects_of(drawing: Drawing) -> Effects:
    """Contributors of a scene's tolerances, then those of its moves, and their effects.

    Raises:
        SceneError: a zone does not fit its feature, or the file of a law is invalid.
    """
    scene = drawing.scene
    stated = _Tolerances(drawing, _touching(scene), _fitting(scene)).drawn()
    own = (
        Drawn(contributor, of=name)
        for name, move in scene.of(AssemblyMoveSpec).items()
        if move.drawn_by
        for contributor in named(move.drawn_by)(move, name, scene)
    )
    return NO_EFFECTS.with_drawn((*stated, *own))


def _fitting(scene: Scene) -> frozenset[str]:
    return frozenset(own for move in scene.of(AssemblyMoveSpec).values() for own in move.fitted)


def _touching(scene: Scene) -> Mapping[str, Mapping[str, Sequence[Touch]]]:
    found: dict[str, dict[str, list[Touch]]] = {}
    for name, move in scene.of(AssemblyMoveSpec).items():
        for pair, (_, own) in move.pairs_by_name.items():
            for one, other in ((own.from_, own.to), (own.to, own.from_)):
                found.setdefault(one, {}).setdefault(other, []).append((name, pair))
    return found
