"""Kinds from outside: a mechanism that tol3d has never heard of, in scenes beside the shipped ones."""

import json
import pickle
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest
from places import ROOT, SPUR_PAIR
from ruamel.yaml import YAML
from schemas import validate
from springs import SPRINGS, LonelyPressSpec, SpringSpec

import tol3d
from tol3d import kinds
from tol3d.errors import InputError, SceneError
from tol3d.scene import Grammar, read_scene
from tol3d.scene.bases import PartSpec
from tol3d.scene.bundled import scene_path
from tol3d.scene.entry import kind_of
from tol3d.scene.schema import SECTIONS
from tol3d.study.system.mechanism import Mechanism, mechanism_of

TEXT = """\
scene: springs
parts:
  spring: {kind: spring, length: 12 mm, characteristic: force.csv}
  gear: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 10 mm}
tolerances:
  twist: {kind: coil_angle, of: spring, distribution: {kind: uniform, lower: 0 deg, upper: 1 deg}}
  thickness: {kind: tooth_thickness, of: gear, distribution: {kind: constant, value: 1 um}}
moves:
  press: {kind: press, spring: spring, against: gear}
measures:
  travel: {kind: travel, of: press, upper_limit: 3 mm}
published:
  theirs:
    travel: {mean: 1 mm, contributors: {twist: 100.0}}
"""


@pytest.fixture
def grammar() -> Grammar:
    return Grammar((*kinds.all_kinds().vocabularies, SPRINGS))


@pytest.fixture
def registered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kinds, "_registered", {})
    tol3d.register(SPRINGS)


def written(folder: Path, text: str = TEXT) -> Path:
    (folder / "force.csv").write_text("mm,N\n0,1\n", encoding="utf-8")
    path = folder / "springs.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def said_of(folder: Path, grammar: Grammar, *change: str) -> str:
    """Message on the scene with one thing changed."""
    assert TEXT.count(change[0]) == 1
    with pytest.raises(SceneError) as caught:
        read_scene(written(folder, TEXT.replace(change[0], change[1])), grammar)
    (problem,) = caught.value.problems
    return problem.removeprefix(f"{folder / 'springs.yaml'}:")


# what is right ------------------------------------------------------------------------------------


def test_a_scene_of_a_kind_from_outside_is_read_with_its_files_beside_shipped_kinds(
    tmp_path: Path, grammar: Grammar
) -> None:
    scene = read_scene(written(tmp_path), grammar)
    assert [type(part).__name__ for part in scene.parts.values()] == ["SpringSpec", "SpurGearSpec"]
    assert scene.of(SpringSpec)["spring"].length.internal == 12.0
    assert list(scene.files) == ["force.csv"]
    assert scene.files["force.csv"].content == b"mm,N\n0,1\n"


def test_its_mechanism_is_the_one_that_includes_all_kinds_and_makes_the_system(
    tmp_path: Path, grammar: Grammar
) -> None:
    scene = read_scene(written(tmp_path), grammar)
    assert mechanism_of(scene) == SPRINGS
    system: object = mechanism_of(scene).system_of(scene)
    assert system == {"spring": 12.0}
    assert mechanism_of(read_scene(SPUR_PAIR, grammar)).name == "gearing"


def test_mechanisms_that_do_not_know_each_other_do_not_share_a_scene(tmp_path: Path) -> None:
    strangers = Grammar((*kinds.all_kinds().vocabularies, replace(SPRINGS, includes=())))
    with pytest.raises(SceneError, match=r"springs.yaml:\d+: .*gearing.*; take out gearing, or make two scenes"):
        mechanism_of(read_scene(written(tmp_path), strangers))
    spring = next(row for row in TEXT.splitlines() if row.startswith("  spring: "))
    train = (SPUR_PAIR.parent / "reducer_3k_train.yaml").read_text("utf-8").replace("parts:\n", f"parts:\n{spring}\n")
    with pytest.raises(SceneError, match=r"of springs and 'motor' of gearing .*; take out springs, or make two scenes"):
        mechanism_of(read_scene(written(tmp_path, train), strangers))


def test_a_grammar_of_one_kind_a_section_reads_too(tmp_path: Path) -> None:
    text = TEXT.replace("against: gear", "against: spring")
    text = "".join(line for line in text.splitlines(keepends=True) if "gear" not in line)
    alone = Grammar((replace(SPRINGS, moves=(LonelyPressSpec,)),))
    assert set(read_scene(written(tmp_path, text), alone).parts) == {"spring"}
    with pytest.raises(SceneError, match=r"5: tolerances.twist.distribution.upper: expected an angle with its unit"):
        read_scene(written(tmp_path, text.replace("1 deg", "1")), alone)
    with pytest.raises(SceneError, match=r"3: parts.spring.kind: expected spring, got 'sprig'; did you mean"):
        read_scene(written(tmp_path, text.replace("kind: spring,", "kind: sprig,")), alone)


def test_a_scene_of_kinds_from_outside_is_pickled_with_its_class(tmp_path: Path, grammar: Grammar) -> None:
    scene = read_scene(written(tmp_path), grammar)
    again = pickle.loads(pickle.dumps(scene))
    assert (again, again.places, again.grammar) == (scene, scene.places, grammar)


# what is wrong ------------------------------------------------------------------------------------

CHANGES = {
    "unknown kind": (
        ("kind: spring,", "kind: sprig,"),
        "3: parts.spring.kind: expected a kind of part, got 'sprig'; did you mean \"spring\"?",
    ),
    "unknown key": (
        ("length: 12 mm", "lenght: 12 mm"),
        '3: parts.spring.lenght: unknown key "lenght"; did you mean "length"?',
    ),
    "wrong dimension of a law": (
        ("lower: 0 deg, upper: 1 deg", "lower: 0 um, upper: 1 um"),
        "6: tolerances.twist.distribution.lower: expected an angle with its unit, such as "
        "\"20 deg\", got '0 um', which is a length",
    ),
    "bare number in a law": (
        ("upper: 1 deg", "upper: 1"),
        '6: tolerances.twist.distribution.upper: expected an angle with its unit, such as "20 deg", '
        "got 1, a bare number without its unit",
    ),
    "name of another kind": (
        ("kind: press, spring: spring", "kind: press, spring: gear"),
        "9: moves.press.spring: expected the name of a spring, got 'gear', which is a spur gear; known here: spring",
    ),
    "name of what has no word": (
        ("against: gear", "against: twist"),
        "9: moves.press.against: expected the name of a gear, got 'twist', which stands in tolerances; "
        "known here: gear",
    ),
    "missing file": (
        ("force.csv", "forces.csv"),
        "3: parts.spring.characteristic: expected a file, got 'forces.csv', which is not there; did you mean "
        '"force.csv"?',
    ),
    "other dimension published": (
        ("mean: 1 mm", "mean: 1 deg"),
        "14: published.theirs.travel.mean: expected a length with its unit, such as "
        "\"4.5 um\" ('travel' is of kind travel), got '1 deg'",
    ),
    "a check of the mechanism": (
        ("against: gear}\n", "against: gear}\n  other: {kind: press, spring: spring, against: gear}\n"),
        "10: moves.other: expected one press, got another",
    ),
}


@pytest.mark.parametrize(("change", "said"), CHANGES.values(), ids=CHANGES.keys())
def test_what_is_wrong_with_a_kind_from_outside_is_said_as_of_any(
    change: tuple[str, str], said: str, tmp_path: Path, grammar: Grammar
) -> None:
    assert said_of(tmp_path, grammar, *change) == said


def test_without_the_mechanism_its_kinds_are_unknown(tmp_path: Path) -> None:
    with pytest.raises(SceneError) as caught:
        tol3d.load_scene(written(tmp_path))
    assert len(caught.value.problems) == 4


# JSON Schema --------------------------------------------------------------------------------------


def test_the_json_schema_knows_registered_kinds_and_no_others(tmp_path: Path, grammar: Grammar) -> None:
    data = YAML(typ="safe", pure=True).load(TEXT)
    validate(data, grammar.scene.model_json_schema())
    with pytest.raises(jsonschema.ValidationError):
        validate(data, tol3d.Scene.model_json_schema())
    wrong = YAML(typ="safe", pure=True).load(TEXT.replace("length: 12 mm", "length: 12 deg"))
    with pytest.raises(jsonschema.ValidationError):
        validate(wrong, grammar.scene.model_json_schema())


# registration -------------------------------------------------------------------------------------


@pytest.mark.usefixtures("registered")
def test_a_registered_mechanism_is_known_to_all_that_load_scenes(tmp_path: Path) -> None:
    scene = tol3d.load_scene(written(tmp_path))
    assert isinstance(scene, tol3d.Scene)
    assert "SpringSpec" in tol3d.Scene.model_json_schema()["$defs"]
    tol3d.register(replace(SPRINGS, parts=()))
    with pytest.raises(SceneError, match="spring"):
        tol3d.load_scene(written(tmp_path))


@pytest.mark.usefixtures("registered")
def test_a_kind_that_another_mechanism_has_is_refused_and_nothing_is_registered() -> None:
    before = kinds.all_kinds()
    with pytest.raises(InputError, match="others: expected a kind of its own in parts, got 'spring', which springs"):
        tol3d.register(Mechanism(name="others", parts=(SpringSpec,)))
    assert kinds.all_kinds() == before


def test_a_class_in_the_wrong_section_and_one_without_a_kind_are_refused() -> None:
    with pytest.raises(InputError, match=r"springs.moves: expected subclasses of MoveSpec .* got SpringSpec"):
        replace(SPRINGS, moves=(SpringSpec,))  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"springs.parts: expected .* whose kind is a literal, got PartSpec"):
        replace(SPRINGS, parts=(PartSpec,))


def installed(folder: Path, target: str) -> Path:
    """A folder for PYTHONPATH in which a package offers a mechanism."""
    info = folder / "springs-1.2.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: springs\nVersion: 1.2\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(f"[tol3d.mechanisms]\nsprings = {target}\n", encoding="utf-8")
    shutil.copy(ROOT / "tests" / "springs.py", folder)
    return folder


def in_a_process(folder: Path, code: str) -> subprocess.CompletedProcess[str]:
    paths = [str(folder), str(ROOT / "tests"), str(ROOT)]
    code = f"import sys; sys.path[:0] = {paths!r}\n{code}"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=folder, timeout=120)


@pytest.mark.slow
def test_the_command_line_knows_a_mechanism_that_a_package_offers(tmp_path: Path) -> None:
    installed(tmp_path, "springs:SPRINGS")
    done = in_a_process(tmp_path, "sys.argv = ['tol3d', 'schema']\nfrom tol3d import cli\ncli.main()")
    schema = json.loads(done.stdout)
    validate(YAML(typ="safe", pure=True).load(TEXT), schema)


@pytest.mark.parametrize(
    ("target", "why"),
    [
        ("no_such_module:SPRINGS", "No module named 'no_such_module'"),
        pytest.param("springs:lengths", "expected a Mechanism, got function", marks=pytest.mark.slow),
    ],
)
def test_a_broken_mechanism_is_told_of_and_shipped_scenes_open(target: str, why: str, tmp_path: Path) -> None:
    installed(tmp_path, target)
    done = in_a_process(tmp_path, "import tol3d\nprint(tol3d.load_scene('spur_pair').scene)")
    assert "springs 1.2: its mechanism springs" in done.stderr
    assert why in done.stderr
    assert done.stdout.strip() == tol3d.load_scene("spur_pair").scene


# what a scene loads -------------------------------------------------------------------------------


def test_the_sources_of_shipped_mechanisms_declare_all_their_kinds_but_shared_ones() -> None:
    for path, mechanism in zip(kinds.SHIPPED, kinds.all_kinds().vocabularies, strict=False):
        specs = [spec for section in SECTIONS for spec in mechanism.specs(section) if not spec.shared]
        assert {kind_of(spec) for spec in specs} <= kinds._declared(path)
        assert kinds._room(path) == mechanism.name


@pytest.mark.parametrize(
    ("scene", "loaded"),
    [
        ("spur_pair", {"gearing"}),
        ("every_field", {"gearing"}),
        ("two_plates", {"assembly"}),
        ("gearbox_in_housing", {"gearing", "assembly", "machine"}),
        ("every_planetary_field", {"gearing", "planetary"}),
        ("every_cycloid_field", {"gearing", "cycloid"}),
    ],
)
def test_a_scene_has_the_kinds_of_its_own_mechanisms_and_means_the_same(scene: str, loaded: set[str]) -> None:
    known, whole = kinds.NEEDED_KINDS, kinds.all_kinds()
    found, same = (read_scene(scene_path(scene), each, settle=False) for each in (known, whole))
    assert {each.name for each in found.grammar.vocabularies} == loaded
    assert same.grammar == whole
    assert found.model_dump(exclude_unset=True) == same.model_dump(exclude_unset=True)
    assert found.grammar.vocabulary_of(found) == whole.vocabulary_of(same)


def test_a_scene_of_gears_imports_no_other_mechanism(tmp_path: Path) -> None:
    code = "import sys\nfrom tol3d.simulate import load\nload('spur_pair')\n"
    code += "print(*{name.split('.')[1] for name in sys.modules if name.startswith('tol3d.')})"
    rooms = set(in_a_process(tmp_path, code).stdout.split())
    assert "gearing" in rooms
    assert not {"assembly", "machine", "planetary", "cycloid"} & rooms


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ("kind: mesh", "kind: planetari", 'did you mean "planetary"'),
        ("tolerances:", "tolerances:\n  flat: {kind: flatnes, of: pinion.face}", 'did you mean "flatness"'),
        ("seed: 1,", "seed: 1, profile_step: 9,", 'did you mean "profile_steps"'),
        ("published:", "published:\n  ours: {cycloid_stages: {x: {}}}", "published.ours.cycloid_stages"),
    ],
)
def test_what_is_wrong_in_a_scene_is_said_by_all_kinds(right: str, wrong: str, message: str, tmp_path: Path) -> None:
    text = scene_path("spur_pair").read_text(encoding="utf-8")
    assert right in text
    path = tmp_path / "scene.yaml"
    path.write_text(text.replace(right, wrong, 1), encoding="utf-8")
    said = []
    for known in (kinds.NEEDED_KINDS, kinds.all_kinds()):
        with pytest.raises(SceneError, match=message) as refused:
            read_scene(path, known)
        said.append(str(refused.value))
    assert said[0] == said[1]


@pytest.mark.usefixtures("registered")
def test_what_a_program_registered_is_known_to_scenes_beside_shipped_kinds(tmp_path: Path) -> None:
    assert read_scene(written(tmp_path), kinds.NEEDED_KINDS).grammar == kinds.all_kinds()
    assert read_scene(scene_path("spur_pair"), kinds.NEEDED_KINDS).grammar == kinds.all_kinds()


def test_a_summary_is_read_by_the_kinds_of_its_measures() -> None:
    own = kinds.summary_kinds({"mechanism": {"name": "gearing"}, "measures": {"play": {"kind": "normal_backlash"}}})
    assert own.words == {kind_of(spec) for spec in kinds.all_kinds().vocabularies[0].measures}
    assert kinds.summary_kinds({"mechanism": None, "measures": {"play": {"kind": []}}}) == kinds.summary_kinds()


def test_a_summary_is_read_by_the_kinds_that_its_mechanism_includes() -> None:
    plain = {"tip": {"kind": "position_error"}}
    assert "trains" in kinds.summary_kinds({"mechanism": {"name": "machine"}, "measures": plain}).run.model_fields
    assert "trains" not in kinds.summary_kinds({"mechanism": {"name": "assembly"}, "measures": plain}).run.model_fields


# new kinds of gears -------------------------------------------------------------------------------

NEW_FILES = {
    "tol3d/gearing/grammar/pulley.py": (
        '"""A pulley."""\n\nfrom typing import ClassVar, Literal\n\nfrom tol3d.scene.bases import PartSpec\n\n\n'
        'class PulleySpec(PartSpec):\n    """A pulley."""\n\n    words: ClassVar[str] = "a pulley"\n\n'
        '    kind: Literal["pulley"]\n'
    ),
    "tol3d/gearing/grammar/tolerances/groove.py": (
        '"""A groove."""\n\nfrom typing import Literal\n\n'
        "from tol3d.gearing.grammar.tolerances.gears import ToothThicknessSpec\n\n\n"
        'class GrooveSpec(ToothThicknessSpec):\n    """A groove."""\n\n    kind: Literal["groove"]\n'
    ),
    "tol3d/gearing/grammar/belt.py": (
        '"""A belt."""\n\nfrom typing import ClassVar, Literal\n\nfrom tol3d.scene.bases import MoveSpec\n'
        "from tol3d.scene.entry import Reference\n\n\n"
        'class BeltSpec(MoveSpec):\n    """A belt."""\n\n    words: ClassVar[str] = "a belt"\n\n'
        '    kind: Literal["belt"]\n\n    def references(self) -> tuple[Reference, ...]:\n        return ()\n'
    ),
    "tol3d/gearing/grammar/slip.py": (
        '"""Slip."""\n\nfrom typing import Literal\n\n'
        "from tol3d.gearing.grammar.measures import NormalBacklashSpec\n\n\n"
        'class SlipSpec(NormalBacklashSpec):\n    """Slip."""\n\n    kind: Literal["slip"]\n'
    ),
}


def test_a_new_kind_of_each_section_is_a_new_file_and_no_existing_line(tmp_path: Path) -> None:
    ignored = shutil.ignore_patterns("__pycache__")
    for folder in ("tol3d", "parts", "scenes"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=ignored)
    for name, text in NEW_FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    code = "from tol3d.kinds import all_kinds\n"
    code += "print(*(kind for s in ('parts', 'tolerances', 'moves', 'measures') for kind in all_kinds().kinds(s)))"
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{code}"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=True,
        timeout=120,
    )
    assert {"pulley", "groove", "belt", "slip"} <= set(done.stdout.split())
