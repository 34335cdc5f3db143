#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Generates dts.v1, the protobuf modules and their type stubs, from the project's .proto files.

    python3 clients/python/generate.py        # once, and after a change of proto/: then PYTHONPATH=clients/python/src does

The build of the package calls it too. Needs protoc (Debian: protobuf-compiler).
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PACKAGE = HERE / "src" / "dts" / "v1"
# A source distribution carries its own copy; in the repository the files of all clients are the same.
PROTO_FOLDERS = (HERE / "proto", HERE.parent.parent / "proto")
NAMES = ("options", "stream", "sessions", "control")  # gateway.proto is between browsers and dts-gateway


def proto_folder() -> Path:
    for folder in PROTO_FOLDERS:
        if (folder / "dts" / "v1" / "stream.proto").is_file():
            return folder
    raise SystemExit(f"no .proto files in {' or '.join(map(str, PROTO_FOLDERS))}")


def generate(package: Path = PACKAGE) -> Path:
    """Each file is complete from the moment that it exists: several builds may generate at the same time."""
    package.mkdir(parents=True, exist_ok=True)
    protos = proto_folder()
    with tempfile.TemporaryDirectory(dir=package.parent) as scratch:
        sources = [f"dts/v1/{name}.proto" for name in NAMES]
        subprocess.run(["protoc", f"--proto_path={protos}", f"--python_out={scratch}", f"--pyi_out={scratch}", *sources], check=True)
        made = Path(scratch) / "dts" / "v1"
        (made / "__init__.py").write_text("# SPDX-License-Identifier: Apache-2.0\n")
        for file in made.iterdir():
            os.replace(file, package / file.name)
    return package


if __name__ == "__main__":
    try:
        generate()
    except FileNotFoundError:
        sys.exit("protoc is not installed: apt-get install protobuf-compiler")
    except subprocess.CalledProcessError as failure:
        sys.exit(failure.returncode)
    print(PACKAGE.parent.parent)
