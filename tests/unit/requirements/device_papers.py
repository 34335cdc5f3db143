#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that docs/device/software.md names every library that the programs are built with.

    device_papers.py ROOT

Libraries are the development packages of debian/control, the Python packages that it needs at run time, and the dependencies of the
dashboard. Exit status 0: nothing found, 1: findings, 2: wrong use.
"""

import json
import re
import sys
from pathlib import Path

SOFTWARE = Path("docs/device/software.md")


def listed(root: Path) -> set[str]:
    """The packages of the first column: "a, b" or "a (remark)"."""
    rows = re.findall(r"^\| ([^|]+) \|", (root / SOFTWARE).read_text(encoding="utf-8"), re.M)
    return {re.sub(r" \(.*\)$", "", name.strip()) for row in rows for name in row.split(",")}


def used(root: Path) -> dict[str, str]:
    """Package: the file that names it."""
    control = (root / "debian/control").read_text(encoding="utf-8")
    needed = re.findall(r"^ ([a-z0-9.+-]+-dev|python3-(?:numpy|protobuf|zmq))(?: \(.*\))?,$", control.split("\n\n")[0], re.M)
    result = {name: "debian/control" for name in needed}
    package = json.loads((root / "clients/web/package.json").read_text(encoding="utf-8"))
    result |= {name: "clients/web/package.json" for name in package["dependencies"]}
    return result


def findings(root: Path) -> list[str]:
    names = listed(root)
    return [f"{SOFTWARE}: {name} of {file} is missing" for name, file in sorted(used(root).items()) if name not in names]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    found = findings(Path(sys.argv[1]))
    print("\n".join(found) or f"{len(used(Path(sys.argv[1])))} libraries, each with its purpose")
    sys.exit(1 if found else 0)
