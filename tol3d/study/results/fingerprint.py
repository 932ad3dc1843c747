"""Identity of the blocks of an interrupted run: scene, files, study, versions and blocks."""

import json

from tol3d.files import FileContent
from tol3d.scene import Scene
from tol3d.study.execution.pools import Execution
from tol3d.study.results.task import block_trials
from tol3d.study.results.versions import installed_versions
from tol3d.study.runs.manifest import Fingerprint
from tol3d.study.system.outcome import METHODS, value_column
from tol3d.study.trials.simulation import Simulation


def fingerprint_of(scene: Scene, simulation: Simulation, execution: Execution) -> Fingerprint:
    """The fingerprint of a run, as it reads back from JSON."""
    fingerprint = {
        "scene": text_of(scene).sha256,
        "files": {name: file.sha256 for name, file in scene.files.items()},
        "study": simulation.study.stated,
        "versions": dict(installed_versions(simulation.requires)),
        "blocks": {"trials": block_trials(simulation), "kept": execution.keep_trials},
    }
    read_back: Fingerprint = json.loads(json.dumps(fingerprint))
    return read_back


def text_of(scene: Scene) -> FileContent:
    """The scene's file."""
    return FileContent(scene.source, scene.text.encode())


def column_units(simulation: Simulation) -> dict[str, str]:
    """Unit of each column of deviations and values, for the files' metadata."""
    system = simulation.system
    units: dict[str, str] = {name: c.unit for c in system.contributors for name in c.columns}
    for measure in system.measures:
        units |= {value_column(method, measure.name): measure.unit for method in METHODS}
    return units
