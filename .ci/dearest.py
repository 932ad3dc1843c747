"""The tests that take longest, from the reports of one or more runs of pytest.

pytest -o junit_family=xunit1 --junitxml=default.xml
pytest -o junit_family=xunit1 --junitxml=slow.xml -m slow
python3 .ci/dearest.py default.xml slow.xml            # the 30 dearest tests, rooms and their seconds
python3 .ci/dearest.py --write default.xml slow.xml    # tests/sets.toml anew: what takes too long leaves its set
"""

import math
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

SHOWN = 30
LIMITS = {"default": 2.0, "ci": 5.0}  # s; of all cases of a test together, in the first report and in the second
LISTED = 10.0  # s; a file that takes less may come late
TARGET = Path("tests/sets.toml")
HEAD = """# Written by .ci/dearest.py --write; read by sets.py.
#
# [default]: tests of which cases leave the default for the time that they take: 0 all of them, n all but the first and
# each nth after it. They are slow.
# [ci]: tests of whose slow cases some leave CI, likewise. They are nightly.
# [seconds]: of the files that take longest, slow tests included."""


def tests_of(reports: list[Path]) -> Iterator[tuple[str, str, float]]:
    """File, name and seconds of each test, fixtures included."""
    for report in reports:
        for case in ElementTree.parse(report).iter("testcase"):
            yield case.get("file", ""), case.get("name", ""), float(case.get("time", 0))


def thinned(before: Mapping[str, int], report: Path, chosen: str) -> dict[str, int]:
    """Each how manieth case of a test its set keeps: fewer than before where they took too long.

    A test of one case leaves the default, but never CI.
    """
    taken = defaultdict(list)
    for file, name, seconds in tests_of([report]):
        taken[f"{file}::{name.partition('[')[0]}"].append(seconds)
    after = dict(before)
    for test, seconds in taken.items():
        if sum(seconds) > LIMITS[chosen] and (len(seconds) > 1 or chosen == "default"):
            after[test] = before.get(test, 1) * math.ceil(sum(seconds) / LIMITS[chosen]) if len(seconds) > 1 else 0
    return dict(sorted(after.items()))


def main(arguments: list[str]) -> None:
    """Print what took longest, or write down what leaves the sets and what each file takes."""
    reports = [Path(name) for name in arguments if name != "--write"]
    tests = list(tests_of(reports))
    files: Counter[str] = Counter()
    rooms: Counter[str] = Counter()
    for file, _, seconds in tests:
        files[file] += seconds
        rooms["/".join(file.split("/")[:2])] += seconds
    if "--write" in arguments:
        before = tomllib.loads(TARGET.read_text("utf-8"))
        after = {own: thinned(before[own], report, own) for own, report in zip(LIMITS, reports, strict=True)}
        after["seconds"] = {file: round(seconds) for file, seconds in files.most_common() if seconds >= LISTED}
        tables = (
            "\n".join([f"\n[{own}]", *(f'"{k}" = {n}' for k, n in table.items())]) for own, table in after.items()
        )
        TARGET.write_text("\n".join([HEAD, *tables, ""]), "utf-8")
        return
    for file, name, seconds in sorted(tests, key=lambda test: -test[2])[:SHOWN]:
        print(f"{seconds:7.1f} s  {file}::{name}")
    print(f"{len(tests)} tests, {sum(files.values()):.0f} s; by room:")
    print(", ".join(f"{room.removeprefix('tests/')} {seconds:.0f}" for room, seconds in rooms.most_common()))


if __name__ == "__main__":
    main(sys.argv[1:])
