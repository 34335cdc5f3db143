# SPDX-License-Identifier: Apache-2.0
"""Mutants of the dashboard: one copy of its sources holds them all, and vitest runs the test files that come by each."""
import collections
import concurrent.futures
import json
import os
import queue
import re
import select
import shutil
import subprocess
import sys
from collections.abc import Iterator

from mutant import TOP, WORK, Mutant, Outcome, run_or_leave, say, tracked
from weave import weave

ROOMS = ["web"]
DASHBOARD = TOP / "clients" / "web"
TREE = WORK / "web"


def sources() -> list[str]:
    """What vitest can judge: no components and nothing that needs a document or a canvas; strings/ is text."""
    return [path for path in tracked("clients/web/src/**.ts") if not path.endswith((".test.ts", "/testing.ts")) and "/strings/" not in path
            and not re.search(r"\bdocument\.|HTML\w*Element|CanvasRenderingContext2D", (TOP / path).read_text())]


def candidates(paths: list[str]) -> dict[str, list[Mutant]]:
    if not (DASHBOARD / "node_modules" / "typescript").exists():
        run_or_leave(["npm", "ci", "--no-fund", "--no-audit", "--loglevel=error"], DASHBOARD)
    run_or_leave(["npm", "run", "generate", "--silent"], DASHBOARD)
    shutil.rmtree(TREE, ignore_errors=True)
    shutil.copytree(DASHBOARD, TREE, ignore=shutil.ignore_patterns("node_modules", "dist"))
    (TREE / "node_modules").symlink_to(DASHBOARD / "node_modules")
    for script in (TOP / "tests" / "mutation" / "vitest").glob("*.mjs"):
        shutil.copy(script, TREE)
    made = subprocess.run(["node", "find.mjs", TOP, *paths], cwd=TREE, capture_output=True, text=True, check=False)
    if made.returncode != 0:
        sys.exit(made.stderr)
    found: dict[str, list[Mutant]] = {path: [] for path in paths}
    for fields in json.loads(made.stdout):
        if "//" not in fields["replacement"]:
            found[fields["path"]].append(Mutant(**fields))
    return found


def switch(alternatives, inner: bytes) -> bytes:
    for name, mutant in reversed(alternatives):
        test, new = f'globalThis.mutant("{name}")'.encode(), mutant.replacement.encode()
        inner = b"{ if (!" + test + b") " + inner + b" }" if mutant.form == "statement" else b"(" + test + b" ? (" + new + b") : (" + inner + b"))"
    return inner


class Judge:
    """A vitest that waits for mutants."""

    def __init__(self) -> None:
        self.start()

    def start(self) -> None:
        self.process = subprocess.Popen(["node", "judge.mjs"], cwd=TREE, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                        bufsize=0)

    def ask(self, mutant: str, files: list[str]) -> dict:
        """A test that never ends takes the whole process along: it has noticed."""
        self.process.stdin.write(" ".join([mutant, *files]).encode() + b"\n")
        while select.select([self.process.stdout], [], [], 60.0)[0]:
            line = self.process.stdout.readline()
            if line.startswith(b"{"):
                return json.loads(line)
            if not line:
                break
        self.close()
        self.start()
        return {"ok": False, "failed": ["it did not end"]}

    def close(self) -> None:
        self.process.kill()
        self.process.wait()


def judge(chosen: dict[str, Mutant], options) -> Iterator[Outcome]:
    by_path = collections.defaultdict(dict)
    for name, mutant in chosen.items():
        by_path[mutant.path][name] = mutant
    for path, mutants in by_path.items():
        (TREE / path.removeprefix("clients/web/")).write_bytes(weave((TOP / path).read_bytes(), mutants, switch))
    judges: queue.Queue[Judge] = queue.Queue()
    judges.put(Judge())
    watched = judges.queue[0].ask("-", [])
    if not watched["ok"]:
        sys.exit(f"scripts/mutate: npm test fails without a mutant: {watched['failed']}")
    reaching = collections.defaultdict(list)
    for file in sorted((TREE / "reach").iterdir()):
        test = file.read_text()
        for name in json.loads(test)["reached"]:
            reaching[name].append(json.loads(test)["test"])
    say(f"Watched {watched['ran']} test files")

    def try_mutant(item) -> Outcome:
        name, mutant = item
        if not reaching[name]:
            return Outcome(name, mutant)
        judge = judges.get()
        try:
            is_noticed = not judge.ask(name, reaching[name])["ok"]
        finally:
            judges.put(judge)
        return Outcome(name, mutant, "vitest" if is_noticed else "", is_noticed, True)

    for _ in range(os.cpu_count() - 1):
        judges.put(Judge())
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(try_mutant, chosen.items())
    while not judges.empty():
        judges.get().close()
