# SPDX-License-Identifier: Apache-2.0
"""Makes mutants of the sources, runs the tests that come by each, and says which mutants no test noticed. See scripts/mutate --help."""
import argparse
import collections
import hashlib
import json
import re
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator

import cpp
import python
import web
from mutant import TOP, WORK, Outcome, OutOfTime, identify, progress, room_of, say

LANGUAGES = [cpp, web, python]
ROOMS = [room for language in LANGUAGES for room in language.ROOMS]
FILES_OF_A_CHANGE = 8  # of each room


def choose(named: dict[str, dict], rooms: list[str], count: int, seed: int) -> dict[str, object]:
    """`count` mutants of each room. Which ones depends on the seed and on each mutant alone: a change elsewhere draws the same again."""
    chosen = {}
    for room in rooms:
        pool = [(hashlib.sha256(f"{seed}/{name}".encode()).digest(), name, mutant)
                for path, mutants in named.items() if room_of(path) == room for name, mutant in mutants.items()]
        per_line = collections.Counter()
        taken = 0
        for _, name, mutant in sorted(pool, key=lambda item: item[0]):
            if taken == count:
                break
            if per_line[mutant.path, mutant.line] >= 2:  # a line with many numbers is not asked about again and again
                continue
            per_line[mutant.path, mutant.line] += 1
            chosen[name] = mutant
            taken += 1
    return chosen


def changed_lines(base: str) -> dict[str, set[int]]:
    """Of each file, the lines that are not as in `base`."""
    text = subprocess.run(["git", "diff", "-U0", base, "--", "daemon", "clients"], cwd=TOP, capture_output=True, text=True, check=True).stdout
    lines, path = collections.defaultdict(set), ""
    for line in text.splitlines():
        if line.startswith("+++ "):
            path = line[6:]
        elif match := re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))?", line):
            first, number = int(match[1]), int(match[2] or 1)
            lines[path].update(range(first, first + number))
    return lines


def table(outcomes: list[Outcome]) -> str:
    lines = [f"{'ROOM':<16} {'MUTANTS':>8} {'NOTICED':>8} {'%':>6} {'BY ITS ROOM':>12} {'%':>6} {'NO TEST NEAR':>13}"]
    rooms = collections.defaultdict(list)
    for outcome in outcomes:
        rooms[room_of(outcome.mutant.path)].append(outcome)
    for room, of in [*sorted(rooms.items()), ("all", outcomes)]:
        noticed, own = sum(bool(o.noticed_by) for o in of), sum(o.by_own for o in of)
        count = max(1, len(of))
        lines.append(f"{room:<16} {len(of):>8} {noticed:>8} {100 * noticed / count:>6.1f} {own:>12} {100 * own / count:>6.1f} "
                     f"{sum(not o.was_reached for o in of):>13}")
    return "\n".join(lines)


def until(deadline: float, outcomes: Iterable[Outcome]) -> Iterator[Outcome]:
    try:
        for outcome in outcomes:
            yield outcome
            if time.monotonic() > deadline:
                return
    except OutOfTime:
        return


def mutate(language, rooms: list[str], lines: dict[str, set[int]] | None, draws: dict[str, dict], options) -> list[Outcome]:
    """Draws mutants of the rooms of one language, of `lines` alone if given, adds them to `draws`, and tries them."""
    paths = [path for path in language.sources() if room_of(path) in rooms]
    if lines is not None:  # reading a file takes seconds: of a wide change, the files that changed most
        paths = sorted((path for path in paths if path in lines), key=lambda path: -len(lines[path]))[:FILES_OF_A_CHANGE]
    named = {path: identify(mutants, (TOP / path).read_bytes()) for path, mutants in language.candidates(paths).items()}
    if lines is not None:
        named = {path: {name: mutant for name, mutant in mutants.items() if mutant.line in lines[path]} for path, mutants in named.items()}
    counts = [int(count) for count in options.count.split(",")]
    chosen = {}
    for i, (seed, draw) in enumerate(draws.items()):
        drawn = choose(named, rooms, counts[min(i, len(counts) - 1)], int(seed))
        draw.update(drawn)
        chosen.update(drawn)
    if not chosen:
        return []
    say(f"{', '.join(rooms)}: {len(chosen)} of {sum(map(len, named.values()))} possible mutants of {len(named)} files")
    outcomes = []
    with open(WORK / "outcomes.jsonl", "a", encoding="utf-8") as log:
        for outcome in until(options.deadline, language.judge(chosen, options)):
            outcomes.append(outcome)
            log.write(json.dumps({"name": outcome.name, "by": outcome.noticed_by, "reached": outcome.was_reached,
                                  "seeds": [seed for seed, draw in draws.items() if outcome.name in draw],
                                  "what": outcome.mutant.describe((TOP / outcome.mutant.path).read_bytes())}) + "\n")
            log.flush()
            progress("Trying mutants", len(outcomes), len(chosen))
    if len(outcomes) < len(chosen):
        say(f"{len(outcomes)} of {len(chosen)} were tried: the others did not compile, or the time was over")
    return outcomes


def main() -> int:
    parser = argparse.ArgumentParser(prog="scripts/mutate", formatter_class=argparse.RawDescriptionHelpFormatter, description=__doc__,
                                     epilog="Mutants are drawn by the seed and by themselves: the same seed draws the same ones after a change elsewhere.")
    parser.add_argument("--rooms", default=",".join(ROOMS), help="comma-separated folders of daemon/ and clients/ (default: all)")
    parser.add_argument("--count", default="20", help="mutants of each room (default 20)")
    parser.add_argument("--seed", default="1", help="default 1; 1,2 draws twice (--count 60,30: more for the first) and prints a table for each")
    parser.add_argument("--change", nargs="?", const="origin/main", metavar="BASE", help="only lines that differ from BASE (default origin/main)")
    parser.add_argument("--elsewhere", action="store_true", help="tests of other rooms, too, not only the room's own")
    parser.add_argument("--seconds", type=float, default=60.0, help="at most this much testing of one mutant by one program (default 60)")
    parser.add_argument("--minutes", type=float, default=1440.0, help="ends after this time, with what was tried until then (default: a day)")
    parser.add_argument("--out", default=str(WORK / "survivors.txt"), help="where survivors are listed")
    options = parser.parse_args()
    rooms = options.rooms.split(",")
    if unknown := set(rooms) - set(ROOMS):
        parser.error(f"no such room: {', '.join(sorted(unknown))}; rooms are {', '.join(ROOMS)}")

    begun = time.monotonic()
    options.deadline = begun + 60.0 * options.minutes
    WORK.mkdir(parents=True, exist_ok=True)
    (WORK / "outcomes.jsonl").unlink(missing_ok=True)
    outcomes, draws = [], {seed: {} for seed in options.seed.split(",")}
    lines = changed_lines(options.change) if options.change else None
    groups = [(language, [room for room in rooms if room in language.ROOMS]) for language in LANGUAGES]
    if lines is not None:  # room after room, those that changed most first: a time limit then leaves out whole rooms
        sources = {path for language in LANGUAGES for path in language.sources()}
        size = collections.Counter()
        for path in sources & lines.keys():
            size[room_of(path)] += len(lines[path])
        groups = sorted(((language, [room]) for language, of in groups for room in of if size[room] > 0), key=lambda group: -size[group[1][0]])
    for language, of in groups:
        if of and time.monotonic() < options.deadline:
            outcomes += mutate(language, of, lines, draws, options)
    with open(options.out, "w", encoding="utf-8") as file:
        for outcome in sorted(outcomes, key=lambda o: (o.mutant.path, o.mutant.begin)):
            if not outcome.noticed_by:
                text = (TOP / outcome.mutant.path).read_bytes()
                file.write(f"{outcome.name} {outcome.mutant.describe(text)}{'' if outcome.was_reached else '   (no test comes by)'}\n")
    for seed, draw in draws.items():
        print(f"Seed {seed}\n" + table([outcome for outcome in outcomes if outcome.name in draw]))
    say(f"Survivors: {options.out}; {time.monotonic() - begun:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
