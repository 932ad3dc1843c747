"""The tests that take longest, from the reports of one or more runs of pytest.

pytest -o junit_family=xunit1 --junitxml=default.xml
pytest -o junit_family=xunit1 --junitxml=slow.xml -m slow
python3 .ci/dearest.py default.xml slow.xml            # the 30 dearest tests, rooms and their seconds
python3 .ci/dearest.py --write default.xml slow.xml    # tests/seconds.toml anew, by which tests are handed out
"""

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

SHOWN = 30
LISTED = 1.0  # s; a file that takes less is not listed
TARGET = Path("tests/seconds.toml")


def tests_of(reports: list[Path]) -> Iterator[tuple[str, str, float]]:
    """File, name and seconds of each test, fixtures included."""
    for report in reports:
        for case in ElementTree.parse(report).iter("testcase"):
            yield case.get("file", ""), case.get("name", ""), float(case.get("time", 0))


def main(arguments: list[str]) -> None:
    """Print what took longest, or write down what each file takes."""
    tests = list(tests_of([Path(name) for name in arguments if name != "--write"]))
    files: Counter[str] = Counter()
    rooms: Counter[str] = Counter()
    for file, _, seconds in tests:
        files[file] += seconds
        rooms["/".join(file.split("/")[:2])] += seconds
    if "--write" in arguments:
        lines = [f'"{file}" = {seconds:.0f}' for file, seconds in files.most_common() if seconds >= LISTED]
        TARGET.write_text("\n".join(("# seconds by file; .ci/dearest.py --write", *lines, "")), "utf-8")
        return
    for file, name, seconds in sorted(tests, key=lambda test: -test[2])[:SHOWN]:
        print(f"{seconds:7.1f} s  {file}::{name}")
    print(f"{len(tests)} tests, {sum(files.values()):.0f} s; by room:")
    print(", ".join(f"{room.removeprefix('tests/')} {seconds:.0f}" for room, seconds in rooms.most_common()))


if __name__ == "__main__":
    main(sys.argv[1:])
