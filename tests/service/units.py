# SPDX-License-Identifier: Apache-2.0
"""A unit file as the tests see it: its settings, what systemd-analyze says of it, and twins of it with something wrong."""
import os
import re
import subprocess
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent.parent
# Another installation: DTS_UNIT_DIR holds the units, DTS_BIN_DIR their programs, as folders with ":" between them.
UNIT_DIR = Path(os.environ.get("DTS_UNIT_DIR", SOURCE / "systemd"))
PROGRAM_DIRS = [Path(folder) for folder in os.environ.get("DTS_BIN_DIR", str(SOURCE / "build/release/bin")).split(":")]
# The programs of a fleet are built only if their libraries are installed.
OPTIONAL = tuple(name for name in ("dts-forward", "dts-hub", "dts-worker", "dts-fleet-gateway") if any((folder / name).is_file() for folder in PROGRAM_DIRS))
UNITS = ("dtsd", "dts-gateway", "dts-relay", "dts-lsl", *OPTIONAL)
PROGRAM = re.compile(r"^(ExecStart=)(\S+)", re.MULTILINE)
EXPOSURE_LIMIT = 13  # tenths; chrony has 37, gpsd 96


def unit_text(name: str) -> str:
    return (UNIT_DIR / f"{name}.service").read_text()


def program_of(name: str) -> Path:
    """The program of the unit, where this build or installation has it."""
    started = PROGRAM.search(unit_text(name))
    assert started, f"{name}.service starts nothing"
    for folder in PROGRAM_DIRS:
        if (folder / Path(started.group(2)).name).is_file():
            return folder / Path(started.group(2)).name
    raise AssertionError(f"{name}.service starts {started.group(2)}, and there is no such program in {PROGRAM_DIRS}")


def runnable_text(name: str) -> str:
    return PROGRAM.sub(rf"\g<1>{program_of(name)}", unit_text(name))


def settings(text: str) -> dict[str, list[str]]:
    """Every value that a key is given, in their order."""
    found: dict[str, list[str]] = {}
    for line in text.splitlines():
        key, equals, value = line.partition("=")
        if equals and not line.startswith(("#", ";")):
            found.setdefault(key, []).append(value)
    return found


def analyze(folder: Path, name: str, text: str, *words: str) -> subprocess.CompletedProcess[str]:
    file = folder / f"{name}.service"
    file.write_text(text)
    environment = {"PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8", "SYSTEMD_COLORS": "0", "SYSTEMD_EMOJI": "0"}
    return subprocess.run(
        ["systemd-analyze", *words, str(file)], capture_output=True, text=True, timeout=60, check=False, env=environment
    )


def complaints(folder: Path, name: str, text: str) -> str:
    """systemd 252 exits with 0 over unknown keys and bad values: whatever it says is a fault."""
    done = analyze(folder, name, text, "verify", "--man=no")
    return done.stdout + done.stderr + ("" if done.returncode == 0 else f"exit status {done.returncode}")


def exposure_report(folder: Path, name: str, text: str) -> tuple[bool, str]:
    """Whether the sandbox keeps the limit, and what is open."""
    done = analyze(folder, name, text, "security", "--offline=true", "--no-pager", f"--threshold={EXPOSURE_LIMIT}")
    return done.returncode == 0, done.stdout + done.stderr
