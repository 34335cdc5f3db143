# SPDX-License-Identifier: Apache-2.0
"""What pyproject.toml cannot say: where the protobuf modules and the version come from."""
import re
import shutil
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.sdist import sdist

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import generate


def version() -> str:
    """Returns the version of the whole project. A source distribution has it in a file of its own."""
    copied = HERE / "VERSION"
    if copied.is_file():
        return copied.read_text().strip()
    project = re.search(r"^project\(dtsd VERSION ([0-9.]+) ", (HERE.parent.parent / "CMakeLists.txt").read_text(), re.MULTILINE)
    if project is None:
        raise SystemExit("CMakeLists.txt has no line 'project(dtsd VERSION ...'")
    return project.group(1)


class SourcesWithProto(sdist):
    """A source distribution leaves the repository: it contains the .proto files, the version and the licence."""

    def make_release_tree(self, base_dir: str, files: list[str]) -> None:
        super().make_release_tree(base_dir, files)
        shutil.copytree(generate.proto_folder() / "dts" / "v1", Path(base_dir) / "proto" / "dts" / "v1", dirs_exist_ok=True)
        (Path(base_dir) / "VERSION").write_text(version() + "\n")
        licence = HERE.parent.parent / "LICENSE"
        if licence.is_file():
            shutil.copy(licence, base_dir)


generate.generate()  # before every command: already the first of them looks for all packages
setup(version=version(), cmdclass={"sdist": SourcesWithProto})
