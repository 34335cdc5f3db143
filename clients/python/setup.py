# SPDX-License-Identifier: Apache-2.0
"""What pyproject.toml cannot say: where the protobuf modules come from."""
import shutil
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.sdist import sdist

sys.path.insert(0, str(Path(__file__).resolve().parent))
import generate


class SourcesWithProto(sdist):
    """A source distribution leaves the repository: it contains the .proto files."""

    def make_release_tree(self, base_dir: str, files: list[str]) -> None:
        super().make_release_tree(base_dir, files)
        shutil.copytree(generate.proto_folder() / "dts", Path(base_dir) / "proto" / "dts", dirs_exist_ok=True)


generate.generate()  # before every command: already the first of them looks for all packages
setup(cmdclass={"sdist": SourcesWithProto})
