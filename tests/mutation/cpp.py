# SPDX-License-Identifier: Apache-2.0
"""Mutants of the C++ sources: one build holds them all, and the unit programs judge them."""
import collections
import concurrent.futures
import dataclasses
import hashlib
import json
import mmap
import os
import pathlib
import re
import shlex
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator

import find
from mutant import TOP, WORK, Mutant, Outcome, progress, room_of, run_or_leave, run_until, say, tracked
from weave import weave

BUILD = TOP / "build" / "mutated"
WOVEN = WORK / "woven"
REACH_BYTES = 8 << 16  # mutation.h: kPlaces
ROOMS = ["core", "pipeline", "record", "session", "ipc", "device", "classifier", "posturography", "physics", "sim", "events", "files", "access", "app",
         "c3d", "pattern", "settings", "libdts", "gateway", "relay", "ctl", "cli", "report", "fhir", "visits", "lab", "lsl", "fleet"]
# The unit programs of a room that has not one, unit_ROOM, but several.
OWN = {"fleet": [f"unit_fleet_{part}" for part in ("database", "desk", "forward", "hub", "link", "s3", "wire", "worker")]}
# Programs that judge a room beside its unit program: what they test lives in that room.
SUBJECT = {"device": ["contract_device", "usb_umockdev"], "pipeline": ["contract_stage", "golden_cases"], "session": ["golden_cases"],
           "ipc": ["golden_cases"]}


def own_programs(room: str) -> list[str]:
    return OWN.get(room, [f"unit_{room}"])


def sources() -> list[str]:
    return tracked("daemon/**.cpp") + tracked("clients/**.cpp")


def configure() -> None:
    """A build beside build/release, at the same depth: the compiler cache then has what a mutant does not change."""
    run_or_leave(["cmake", "--preset", "release", "-B", str(BUILD), "-DBUILD_TESTING=ON", "-DDTS_TESTS=suite", "-DDTS_FLEET=ON",
                  f"-DCMAKE_COMPILE_WARNING_AS_ERROR={'ON' if os.environ.get('CI') == 'true' else 'OFF'}",
                  f"-DCMAKE_PROJECT_dtsd_INCLUDE={TOP / 'tests' / 'mutation' / 'woven.cmake'}", f"-DDTS_WOVEN={WOVEN}"], TOP)


def compile_arguments() -> dict[str, list[str]]:
    """Of every folder with targets, what libclang has to know: include folders, definitions, standard. A folder's library has more of them
    than its program."""
    arguments = {}
    for entry in json.loads((BUILD / "compile_commands.json").read_text()):
        kept, words = [], iter(shlex.split(entry["command"]))
        for word in words:
            if word == "-isystem":
                kept += [word, next(words)]
            elif word.startswith(("-I", "-D", "-std")):
                kept.append(word)
        match = re.search(r"-o (\S+?)/CMakeFiles/", entry["command"])
        arguments[match[1]] = max(kept, arguments.get(match[1], []), key=len)
    return arguments


def _find(job):
    path, absolute, arguments = job
    try:
        return path, [dataclasses.asdict(mutant) for mutant in find.find(path, absolute, arguments)], None
    except RuntimeError as error:
        return path, [], str(error)


def candidates(paths: list[str]) -> dict[str, list]:
    """All mutants that can be made of each file. What was found before is kept beside the build, by the contents of the file."""
    if not paths:
        return {}
    configure()
    run_or_leave(["cmake", "--build", str(BUILD), "--target", "dts_proto"], TOP)
    finder = hashlib.sha256(pathlib.Path(__file__).with_name("find.py").read_bytes()).hexdigest()[:8]
    kept = WORK / "candidates"
    kept.mkdir(parents=True, exist_ok=True)
    arguments = compile_arguments()
    found, jobs, places = {}, [], {}
    for path in paths:
        digest = hashlib.sha256((TOP / path).read_bytes()).hexdigest()[:16]
        places[path] = kept / f"{finder}-{digest}-{path.replace('/', '_')}.json"
        if places[path].exists():
            found[path] = [Mutant(**fields) for fields in json.loads(places[path].read_text())]
        elif folder := next((str(parent) for parent in pathlib.PurePath(path).parents if str(parent) in arguments), None):
            jobs.append((path, str(TOP / path), arguments[folder]))
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        for done, (path, mutants, error) in enumerate(pool.map(_find, jobs), 1):
            progress("Reading sources", done, len(jobs))
            if error:
                say(f"left out: {error}")
                continue
            places[path].write_text(json.dumps(mutants))
            found[path] = [Mutant(**fields) for fields in mutants]
    return found


# A build of all of them -------------------------------------------------------------------------------------------------------------------


def lay_woven(chosen: dict[str, object]) -> None:
    """Files with mutants, which woven.cmake compiles in the place of the sources. Those that stay as they are keep their times."""
    by_path = collections.defaultdict(dict)
    for name, mutant in chosen.items():
        by_path[mutant.path][name] = mutant
    for path in [*WOVEN.rglob("*.cpp")]:
        if str(path.relative_to(WOVEN)) not in by_path:
            path.unlink()
    for path, mutants in by_path.items():
        folder = (TOP / path).parent

        def absolute(match) -> bytes:
            near = folder / match[1].decode()
            return f'#include "{near}"'.encode() if near.exists() else match[0]

        text = re.sub(rb'(?m)^#include "([^"]+)"', absolute, weave((TOP / path).read_bytes(), mutants))
        content = f'#include "{TOP}/tests/mutation/mutation.h"\n#line 1\n'.encode() + text
        to = WOVEN / path
        if not to.exists() or to.read_bytes() != content:
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_bytes(content)


def build(chosen: dict[str, object], targets: list[str], deadline: float) -> dict[str, object]:
    """Builds the targets with the mutants; those that do not compile are left out. Returns those that do."""
    chosen = dict(chosen)
    for _ in range(12):
        lay_woven(chosen)
        configure()
        say(f"Building {len(chosen)} mutants")
        made = run_until(["cmake", "--build", str(BUILD), "-j", str(os.cpu_count()), "--target", *targets, "--", "-k", "0"], TOP, deadline)
        if made.returncode == 0:
            return chosen
        wrong = {(match[1], int(match[2])) for match in
                 re.finditer(re.escape(f"{WOVEN}/") + r"(\S+?):(\d+):\d+: (?:error|  required from here|note: [^\n]* was not initialized with a constant)", made.stdout)}
        out = {name for name, mutant in chosen.items()
               if any(path == mutant.path and mutant.line - 1 <= line <= mutant.line + 12 for path, line in wrong)}
        if not out:
            sys.exit(made.stdout[-6000:] + "\nscripts/mutate: the build failed, and not by a mutant")
        say(f"{len(out)} mutants do not compile and are left out")
        for name in out:
            del chosen[name]
    sys.exit("scripts/mutate: the build still fails after twelve attempts")


# Which test comes by which mutant -----------------------------------------------------------------------------------------------------------


@dataclasses.dataclass
class Case:
    program: str
    name: str
    seconds: float
    reached: set


def environment(**more: str) -> dict[str, str]:
    return {**os.environ, "TSAN_OPTIONS": "", **more}


def cases_of(program: str) -> list[str]:
    listed = subprocess.run([BUILD / "tests" / program, "--gtest_list_tests"], capture_output=True, text=True, check=True).stdout
    names, suite = [], ""
    for line in listed.splitlines():
        word = line.split("#")[0].rstrip()
        if not line.startswith(" "):
            suite = word if word.endswith(".") else suite
        elif not word.strip().startswith("DISABLED_") and not suite.startswith("DISABLED_"):
            names.append(suite + word.strip())
    return names


def observe(program: str, name: str) -> Case | None:
    """Runs one case without a mutant. None if it fails."""
    with tempfile.NamedTemporaryFile(dir="/dev/shm") as file:
        file.truncate(REACH_BYTES)
        begun = time.monotonic()
        try:
            ended = subprocess.run([BUILD / "tests" / program, f"--gtest_filter={name}"], env=environment(DTS_MUTATION_REACH=file.name),
                                   cwd=BUILD / "tests", capture_output=True, timeout=300, check=False)
        except subprocess.TimeoutExpired:
            return None
        seconds = time.monotonic() - begun
        with mmap.mmap(file.fileno(), REACH_BYTES) as mapped:
            reached = {f"{value:015x}" for (value,) in struct.iter_unpack("=Q", mapped) if value}
    return Case(program, name, seconds, reached) if ended.returncode == 0 else None


def map_tests(programs: list[str]) -> list[Case]:
    jobs = [(program, name) for program in programs for name in cases_of(program)]
    cases, failed = [], []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() + 1) as pool:
        for done, ((program, name), case) in enumerate(zip(jobs, pool.map(lambda job: observe(*job), jobs)), 1):
            progress("Watching tests", done, len(jobs))
            (cases if case else failed).append(case or f"{program} {name}")
    for name in failed:
        say(f"fails without a mutant, left out: {name}")
    return cases


# Who notices --------------------------------------------------------------------------------------------------------------------------------


def try_mutant(name: str, mutant, cases: list[Case], budget_s: float) -> Outcome:
    own = own_programs(room_of(mutant.path))
    outcome = Outcome(name, mutant)
    reaching = collections.defaultdict(list)
    for case in cases:
        if name in case.reached:
            reaching[case.program].append(case)
    outcome.was_reached = bool(reaching)
    for program in sorted(reaching, key=lambda key: (key not in own, sum(case.seconds for case in reaching[key]))):
        # Those that come by little else are nearest; those that take long are last.
        near = sorted(reaching[program], key=lambda case: (case.seconds > 2.0, len(case.reached) * (0.1 + case.seconds)))
        spent, names = 0.0, []
        for case in near:
            if names and spent + case.seconds > budget_s:
                break
            names.append(case.name)
            spent += case.seconds
        if notices(program, name, names, spent):
            outcome.noticed_by, outcome.by_own = program, program in own
            return outcome
    return outcome


def notices(program: str, mutant: str, names: list[str], seconds: float) -> bool:
    for begin in range(0, len(names), 40):
        chosen = names[begin:begin + 40]
        process = subprocess.Popen([BUILD / "tests" / program, "--gtest_filter=" + ":".join(chosen), "--gtest_fail_fast"],
                                   env=environment(DTS_MUTANT=mutant), cwd=BUILD / "tests", stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, start_new_session=True)
        try:
            if process.wait(timeout=10.0 + 4.0 * seconds) != 0:
                return True
        except subprocess.TimeoutExpired:  # it hangs or takes far longer: noticed
            return True
        finally:
            try:
                os.killpg(process.pid, 9)
            except ProcessLookupError:
                pass
            process.wait()
    return False


def judge(chosen: dict[str, Mutant], options) -> Iterator[Outcome]:
    used = sorted({room_of(mutant.path) for mutant in chosen.values()}, key=ROOMS.index)
    programs = [program for room in (ROOMS if options.elsewhere else used) for program in own_programs(room)]
    programs += sorted({program for room in used for program in SUBJECT.get(room, [])})
    chosen = build(chosen, programs, options.deadline)
    cases = map_tests(programs)
    say(f"Watched {len(cases)} cases")
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(lambda item: try_mutant(*item, cases, options.seconds), chosen.items())
