# SPDX-License-Identifier: Apache-2.0
"""Mutants of the Python client: one at a time in a copy of the package, judged by the cases of tests/python that come by its lines."""
import ast
import collections
import concurrent.futures
import json
import os
import pathlib
import queue
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator

from mutant import TOP, WORK, Mutant, Outcome, run_or_leave, say, tracked

ROOMS = ["python"]
PACKAGE = TOP / "clients" / "python" / "src" / "dts"
TESTS = ["test_checks", "test_hostile", "test_xdf", "test_sessions", "test_keys", "test_live"]  # test_package builds the package, which takes long
SWAPS = {
    ast.Lt: ["<=", ">="], ast.LtE: ["<", ">"], ast.Gt: [">=", "<="], ast.GtE: [">", "<"], ast.Eq: ["!="], ast.NotEq: ["=="],
    ast.Is: ["is not"], ast.IsNot: ["is"], ast.In: ["not in"], ast.NotIn: ["in"], ast.And: ["or"], ast.Or: ["and"],
    ast.Add: ["-"], ast.Sub: ["+"], ast.Mult: ["/"], ast.Div: ["*"], ast.FloorDiv: ["*"], ast.Mod: ["*"], ast.Pow: ["*"],
    ast.BitAnd: ["|"], ast.BitOr: ["&"], ast.LShift: [">>"], ast.RShift: ["<<"],
}


def sources() -> list[str]:
    return tracked("clients/python/src/dts/*.py")


class Finder(ast.NodeVisitor):
    def __init__(self, path: str) -> None:
        self.path, self.text = path, (TOP / path).read_bytes()
        self.starts = [0] + [match.end() for match in re.finditer(b"\n", self.text)]
        self.found: list[Mutant] = []

    def span(self, node) -> tuple[int, int]:
        return self.starts[node.lineno - 1] + node.col_offset, self.starts[node.end_lineno - 1] + node.end_col_offset

    def source(self, begin, end) -> str:
        return self.text[begin:end].decode()

    def add(self, node, kind: str, replacement: str) -> None:
        self.found.append(Mutant(self.path, node.lineno, *self.span(node), kind, replacement, "text"))

    def swap(self, node, operator, left, right, kind: str) -> None:
        """Another operator between two operands of `node`, which may have more of them."""
        begin, end = self.span(node)
        left_end, right_begin = self.span(left)[1], self.span(right)[0]
        for other in SWAPS.get(type(operator), []):
            between = re.sub(r"[^\s()]+(\s+(in|not)\b)?", other, self.source(left_end, right_begin), count=1)
            self.add(node, kind, self.source(begin, left_end) + between + self.source(right_begin, end))

    def turn(self, node) -> None:
        if not isinstance(node, ast.Compare | ast.UnaryOp):
            self.add(node, "condition", f"(not ({self.source(*self.span(node))}))")

    def generic_visit(self, node) -> None:
        match node:
            case ast.JoinedStr() | ast.arguments() | ast.Import() | ast.ImportFrom():
                return
            case ast.ClassDef(bases=[ast.Attribute(attr="IntEnum")]):
                return
            case ast.ClassDef() | ast.FunctionDef():  # neither decorators nor types
                return self.visit_all(node.body)
            case ast.AnnAssign():
                return self.visit_all([node.value] if node.value else [])
            case ast.Assign(targets=[ast.Name(id=name)]) if name in ("__all__", "Times", "_TakeValues"):
                return
            case ast.If():
                self.turn(node.test)
                if isinstance(node.body[-1], ast.Return | ast.Raise | ast.Continue | ast.Break):
                    self.add(node.test, "error check", "False")
            case ast.IfExp():
                self.turn(node.test)
            case ast.Compare():
                for left, operator, right in zip([node.left, *node.comparators], node.ops, node.comparators):
                    self.swap(node, operator, left, right, "comparison")
            case ast.BoolOp():
                for left, right in zip(node.values, node.values[1:]):
                    self.swap(node, node.op, left, right, "condition")
            case ast.BinOp(left=left, right=right):
                self.swap(node, node.op, left, right, "arithmetic")
            case ast.AugAssign():
                self.add(node, "statement", "pass")
            case ast.Assign(targets=[ast.Attribute() | ast.Subscript()]) | ast.Expr(value=ast.Call()):
                self.add(node, "statement", "pass")
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                self.add(node, "condition", f"bool({self.source(*self.span(operand))})")
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                self.add(node, "sign", f"({self.source(*self.span(operand))})")
            case ast.Constant(value=bool(value)):
                self.add(node, "constant", str(not value))
            case ast.Constant(value=int(value)):
                for other in ["+ 1"] if value == 0 else ["+ 1", "- 1"]:
                    self.add(node, "constant", f"({self.source(*self.span(node))} {other})")
            case ast.Constant(value=float(value)):
                self.add(node, "constant", f"({self.source(*self.span(node))} * 1.25)" if value else "1.0")
        super().generic_visit(node)

    def visit_all(self, nodes) -> None:
        for node in nodes:
            self.visit(node)


def candidates(paths: list[str]) -> dict[str, list[Mutant]]:
    found = {}
    for path in paths:
        finder = Finder(path)
        finder.visit(ast.parse(finder.text))
        found[path] = finder.found
    return found


def lines_of(mutant: Mutant, text: str) -> set[int]:
    """The lines that run with a mutant: its own; of a constant or a field of a class, those that use its name."""
    lines = text.splitlines()
    functions = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]
    name = re.match(r"\s*(\w+)", lines[mutant.line - 1])
    if name is None or any(node.lineno <= mutant.line <= node.end_lineno for node in functions):
        return {mutant.line}
    return {number for number, line in enumerate(lines, 1) if re.search(rf"\b{name[1]}\b", line)}


def run(test: str, arguments: list[str], package: pathlib.Path, timeout_s: float) -> bool:
    """True if the cases pass."""
    programs = os.environ.get("DTS_BIN_DIR", str(TOP / "build" / "release" / "bin"))
    environment = {**os.environ, "PYTHONPATH": f"{package.parent}:{TOP / 'tests' / 'python'}", "PYTHONDONTWRITEBYTECODE": "1",
                   "DTS_BIN_DIR": programs}
    process = subprocess.Popen([sys.executable, TOP / "tests" / "mutation" / "python_cases.py", test, *arguments], env=environment,
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        return process.wait(timeout=timeout_s) == 0
    except subprocess.TimeoutExpired:
        return False
    finally:
        try:
            os.killpg(process.pid, 9)  # daemons, too
        except ProcessLookupError:
            pass
        process.wait()


def judge(chosen: dict[str, Mutant], options) -> Iterator[Outcome]:
    if "DTS_BIN_DIR" not in os.environ:
        run_or_leave(["cmake", "--preset", "release"], TOP)
        run_or_leave(["cmake", "--build", "--preset", "release", "--target", "dtsd", "dtsctl"], TOP)
    run_or_leave([sys.executable, "clients/python/generate.py"], TOP)
    packages: queue.Queue[pathlib.Path] = queue.Queue()
    for slot in range(os.cpu_count()):
        packages.put(WORK / "python" / str(slot) / "dts")
        shutil.copytree(PACKAGE, packages.queue[-1], dirs_exist_ok=True)
    cases = []
    for test in TESTS:
        trace = WORK / "python" / f"{test}.json"
        if not run(test, ["--trace", str(trace)], packages.queue[0], 600.0):
            sys.exit(f"scripts/mutate: {test} fails without a mutant")
        cases += [(test, name, seconds, lines) for name, (seconds, lines) in json.loads(trace.read_text()).items()]
    say(f"Watched {len(cases)} cases")

    def try_mutant(item) -> Outcome:
        name, mutant = item
        outcome = Outcome(name, mutant)
        file, text = pathlib.Path(mutant.path).name, (TOP / mutant.path).read_bytes()
        lines = lines_of(mutant, text.decode())
        reaching = collections.defaultdict(list)
        for test, case, seconds, reached in cases:
            if lines & set(reached.get(file, [])):
                reaching[test].append((seconds, case))
        package = packages.get()
        try:
            (package / file).write_bytes(text[:mutant.begin] + mutant.replacement.encode() + text[mutant.end:])
            for test in sorted(reaching, key=lambda key: sum(seconds for seconds, _ in reaching[key])):
                outcome.was_reached = True
                seconds = sum(seconds for seconds, _ in reaching[test])
                if not run(test, [case for _, case in sorted(reaching[test])], package, 20.0 + 4.0 * seconds):
                    outcome.noticed_by, outcome.by_own = test, True
                    break
        finally:
            (package / file).write_bytes(text)
            packages.put(package)
        return outcome

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(try_mutant, chosen.items())
