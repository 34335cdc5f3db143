# SPDX-License-Identifier: Apache-2.0
"""A mutant, and what became of it: what the modules of all languages share."""
import dataclasses
import hashlib
import os
import pathlib
import shlex
import subprocess
import sys
import time

TOP = pathlib.Path(__file__).resolve().parents[2]
WORK = TOP / "build" / "mutate"


@dataclasses.dataclass(frozen=True)
class Mutant:
    path: str        # from the top of the repository
    line: int
    begin: int       # bytes
    end: int
    kind: str        # condition, comparison, arithmetic, constant, sign, statement, arguments, error check
    replacement: str # what is evaluated instead
    form: str        # "expression", "statement" or "literal": how both are woven into the file

    def describe(self, text: bytes) -> str:
        return f"{self.path}:{self.line}: {self.kind}: {squeeze(text[self.begin:self.end].decode())} -> {squeeze(self.replacement)}"


def squeeze(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= 90 else text[:60] + " ... " + text[-24:]


def identify(mutants: list[Mutant], text: bytes) -> dict[str, Mutant]:
    """Names each mutant by what it changes, not by its line: a change elsewhere in the file leaves the name as it is."""
    named: dict[str, Mutant] = {}
    for mutant in mutants:
        old = b" ".join(text[mutant.begin:mutant.end].split()).decode()
        for occurrence in range(1000):
            key = f"{mutant.path}\0{old}\0{mutant.replacement}\0{mutant.form}\0{occurrence}"
            name = hashlib.sha256(key.encode()).hexdigest()[:15]
            if name not in named:
                named[name] = mutant
                break
    return named


@dataclasses.dataclass
class Outcome:
    name: str
    mutant: object
    noticed_by: str = ""   # a program
    by_own: bool = False   # its room's
    was_reached: bool = False


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def progress(what: str, done: int, of: int) -> None:
    if sys.stderr.isatty():
        print(f"\r\033[K{what} {done}/{of}", end="\n" if done == of else "", file=sys.stderr, flush=True)


def room_of(path: str) -> str:
    return path.split("/")[1]


def tracked(pattern: str) -> list[str]:
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", pattern], cwd=TOP, capture_output=True, text=True, check=True)
    return [path for path in listed.stdout.splitlines() if (TOP / path).is_file()]


def run_or_leave(command: list[str], folder: pathlib.Path) -> None:
    made = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if made.returncode != 0:
        sys.exit(f"{made.stdout[-3000:]}{made.stderr[-3000:]}\nscripts/mutate: {shlex.join(command)} failed")


class OutOfTime(Exception):
    pass


def run_until(command: list[str], folder: pathlib.Path, deadline: float) -> subprocess.CompletedProcess:
    """Runs it with its output kept. Ends it and raises OutOfTime at the deadline (time.monotonic)."""
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
    try:
        output, _ = process.communicate(timeout=max(0.0, deadline - time.monotonic()))
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        process.wait()
        raise OutOfTime from None
    return subprocess.CompletedProcess(command, process.returncode, output)
