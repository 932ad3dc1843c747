"""The oldest versions that pyproject.toml promises, as constraints for pip; and the tests that are run with them.

python3 .ci/oldest.py pyproject.toml >oldest.txt && pip install -c oldest.txt -e ".[test]"
pytest $(python3 .ci/oldest.py --tests)
"""

import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

BOUND = re.compile(r"([\w.-]+)>=([\d.]+)")
TESTS = (
    *("project/test_readme", "project/test_python", "scene/test_scene", "cli/test_cli"),
    *("distributions/test_distributions", "samplers/test_samplers", "solids/test_solids", "gearing/test_exact"),
    *("report/test_printed_tables", "report/test_report", "report/test_train_export", "runs/test_kept_runs"),
    *("assembly/test_door", "assembly/test_zone_laws", "assembly/test_hole_pattern"),
)
"""What meets every dependency: scenes, laws, assemblies, samplers, kernels, solids, FCL, tables, pictures, views."""


def oldest_versions(project: Path) -> Iterator[str]:
    """`name==version` of every dependency, those of the tests too.

    Raises:
        ValueError: a dependency has no lower bound.
    """
    declared = tomllib.loads(project.read_text("utf-8"))["project"]
    for requirement in [*declared["dependencies"], *declared["optional-dependencies"]["test"]]:
        bound = BOUND.match(requirement)
        if bound is None:
            raise ValueError(f"{project}: expected a lower bound (name>=version), got {requirement!r}")
        yield f"{bound[1]}=={bound[2]}"


def main(arguments: list[str]) -> None:
    """Print the one or the other."""
    if arguments == ["--tests"]:
        print(*(f"tests/{name}.py" for name in TESTS))
    else:
        print(*oldest_versions(Path(arguments[0])), sep="\n")


if __name__ == "__main__":
    main(sys.argv[1:])
