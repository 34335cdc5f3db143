# SPDX-License-Identifier: Apache-2.0
"""What npm has bundled into the dashboard: from the lock file, and licence texts from node_modules beside it."""
import base64
import dataclasses
import json
import re
from pathlib import Path

LEADING_COMMENT = re.compile(r"\A((?://[^\n]*\n)+|/\*.*?\*/)", re.DOTALL)


@dataclasses.dataclass(frozen=True, order=True)
class Package:
    name: str
    version: str
    licence: str
    checksum: str  # SHA-512 of the package as published, hexadecimal
    folder: Path

    supplier = "NOASSERTION"

    @property
    def purl(self) -> str:
        return f"pkg:npm/{self.name.replace('@', '%40')}@{self.version}"

    @property
    def notice(self) -> str:
        """Its licence file; a package without one says in its sources whose they are."""
        files = sorted(file for file in self.folder.iterdir() if file.name.upper().startswith(("LICENSE", "LICENCE", "COPYING", "NOTICE")))
        if files:
            return "\n".join(file.read_text() for file in files)
        comments = set()
        for source in self.folder.rglob("*.js"):
            comment = LEADING_COMMENT.match(source.read_text())
            if comment and "opyright" in comment.group():
                comments.add(comment.group().rstrip())
        if not comments:
            raise SystemExit(f"sbom: {self.name} {self.version} names no licence that could be passed on")
        return "\n\n".join(sorted(comments)) + "\n"


def bundled(lock: Path) -> list[Package]:
    packages = []
    for path, entry in json.loads(lock.read_text())["packages"].items():
        if not path or entry.get("dev") or entry.get("devOptional") or entry.get("peer"):
            continue
        algorithm, _, digest = entry["integrity"].partition("-")
        if algorithm != "sha512":
            raise SystemExit(f"sbom: {path} has no SHA-512 in {lock}")
        name = path.rpartition("node_modules/")[2]
        packages.append(Package(name, entry["version"], entry["license"], base64.b64decode(digest).hex(), lock.parent / path))
    return sorted(packages)
