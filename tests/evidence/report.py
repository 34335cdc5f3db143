#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the verification report: one HTML file about one run of the suite on one machine.

    report.py ROOT BUILD TESTS.xml REPORT.html

Exit status 0: every test that ran passed, and all tests of every requirement passed. 1: not so. 2: wrong use.
"""

import hashlib
import html
import platform
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[1] / "unit/requirements")]
import device_papers
import requirements
import results

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 75rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
table { border-collapse: collapse; width: 100%; margin: 1rem 0; font-size: 0.9rem; }
th, td { border: 1px solid #bbb; padding: 0.3rem 0.5rem; text-align: left; vertical-align: top; }
th { background: #eee; }
code { overflow-wrap: anywhere; }
.failed, .not-run { background: #fbe3d8; }
.passed { background: #e2f3ec; }
.skipped { background: #f3f0dd; }
"""


def output(*command: str) -> str:
    """What a program prints; a dash if it is absent or fails."""
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "-"


def table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """The cells are HTML."""
    lines = ["<table>", "<tr>" + "".join(f"<th>{head}</th>" for head in heads) + "</tr>"]
    lines += ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows]
    return "\n".join([*lines, "</table>"])


def outcome(word: str) -> str:
    return f'<span class="{word.replace(" ", "-")}">{word}</span>'


def plain(markdown: str) -> str:
    """A cell of Markdown without its links, as HTML."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", markdown).replace("`", "").replace("**", "")
    return html.escape(text)


def version_of(package: str) -> str:
    return output("dpkg-query", "-W", "-f", "${Version}", package)


def run_facts(root: Path, run: results.Results, junit: Path) -> str:
    processor = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M)
    memory = re.search(r"^MemTotal:\s*(\d+) kB$", Path("/proc/meminfo").read_text(), re.M)
    system = platform.freedesktop_os_release()
    changed = output("git", "-C", str(root), "status", "--porcelain")
    counts = {word: list(run.tests.values()).count(word) for word in ("passed", "failed", "skipped")}
    rows = [
        ("commit", output("git", "-C", str(root), "rev-parse", "HEAD") + (" with changes that are not committed" if changed not in ("", "-") else "")),
        ("tests ended", datetime.fromtimestamp(junit.stat().st_mtime, UTC).strftime("%Y-%m-%d %H:%M UTC")),
        ("machine", f"{processor[1] if processor else platform.machine()}, {output('nproc')} cores, {int(memory[1]) // 1024 if memory else '-'} MB"),
        ("system", f"{system['PRETTY_NAME']}, kernel {platform.release()}, {platform.machine()}"),
        ("compiler", output("c++", "--version").splitlines()[0]),
        ("tests", ", ".join(f"{count} {word}" for word, count in counts.items())),
        ("cases that GoogleTest and node:test print", str(len(run.cases))),
        ("time of all tests together", f"{sum(run.seconds.values()):.0f} s"),
    ]
    return table(("", ""), ((name, html.escape(value)) for name, value in rows))


def program_hashes(build: Path) -> Iterator[tuple[str, str]]:
    for program in sorted((build / "bin").iterdir()):
        if program.is_file():
            yield program.name, f"<code>{hashlib.sha256(program.read_bytes()).hexdigest()}</code>"


def requirement_rows(root: Path, run: results.Results) -> tuple[list[tuple[str, ...]], list[str]]:
    """The rows of the matrix, and the IDs of requirements of which a test did not pass."""
    evidence = requirements.all_evidence(root)
    rows, open_ids = [], []
    for requirement in requirements.requirements(root):
        found = [(item, run.of(item.name, item.file)) for item in evidence if item.id == requirement.id]
        word = results.worst([word for _, word in found])
        if word != "passed":
            open_ids.append(requirement.id)
        tests = "<br>".join(
            f"<code>{html.escape(item.name)}</code> {outcome(word)}" + (f", {run.left_out[item.name]}" if item.name in run.left_out else "")
            for item, word in found
        )
        rows.append((requirement.id, plain(requirement.text), plain(requirement.source), outcome(word), tests))
    return rows, open_ids


def markdown_rows(file: Path, first: str) -> Iterator[list[str]]:
    """The rows of tables whose first cell matches."""
    for line in file.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        if line.startswith("|") and re.match(first, cells[0]):
            yield cells


def software_rows(root: Path) -> Iterator[tuple[str, ...]]:
    for cells in markdown_rows(root / device_papers.SOFTWARE, r"(?!package|---)"):
        names = [name.strip() for name in re.sub(r"\(.*\)", "", cells[0]).split(",")]
        versions = {name: version_of(name) for name in names}
        shown = ", ".join(f"{name} {version}" for name, version in versions.items() if version != "-") or "see package-lock.json, or not installed"
        yield (plain(cells[0]), html.escape(shown), *(plain(cell) for cell in cells[1:]))


def known_problems(root: Path) -> list[str]:
    """The points below each "Known problems" of the changelog."""
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    parts = re.findall(r"^### Known problems\n(.*?)(?=^##|\Z)", text, re.M | re.S)
    return [" ".join(point.split()) for part in parts for point in re.findall(r"^- (.*?)(?=^- |\Z)", part, re.M | re.S)]


def main(arguments: list[str]) -> int:
    if len(arguments) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    root, build, junit, report = map(Path, arguments)
    run = results.read(junit, build)
    rows, open_ids = requirement_rows(root, run)
    failed = sorted(name for name, word in run.tests.items() if word == "failed")
    architecture = output(sys.executable, "-B", str(root / "tests/unit/include_edges/include_edges.py"), "table", str(root))
    rooms = [[plain(cell) for cell in line.strip("|").split(" | ")] for line in architecture.splitlines() if line.startswith("|")]
    problems = known_problems(root)
    parts = [
        "<h1>dtsd: verification report</h1>",
        "<p>Written by <code>scripts/evidence</code>. It reports one run of the suite on one machine, with simulated people and emulated devices. "
        "dtsd is not a certified medical device, and this report claims no conformity with any standard.</p>",
        "<h2>The run</h2>",
        run_facts(root, run, junit),
        f"<p>Failed tests: {html.escape(', '.join(failed)) or 'none'}. "
        f"Requirements of which a test failed, was skipped or did not run: {', '.join(open_ids) or 'none'}.</p>",
        "<h2>Requirements</h2>",
        table(("ID", "requirement", "source", "result", "tests"), rows),
        "<h2>Hazards</h2>",
        table(
            ("ID", "hazard", "causes", "effect", "what prevents it", "requirements", "what remains"),
            ([plain(cell) for cell in cells] for cells in markdown_rows(root / requirements.HAZARDS, "HAZ-")),
        ),
        "<h2>Known problems</h2>",
        "<ul>" + "".join(f"<li>{plain(problem)}</li>" for problem in problems) + "</ul>" if problems else "<p>None is listed in CHANGELOG.md.</p>",
        "<h2>Software of others</h2>",
        table(("packages", "versions here", "purpose", "if it fails", "known problems"), software_rows(root)),
        "<h2>Architecture: what a room may include</h2>",
        table(("room", "may include"), ((row[0], row[-1]) for row in rooms)),
        "<h2>Programs (SHA-256)</h2>",
        table(("program", "SHA-256"), program_hashes(build)),
        "<h2>All tests</h2>",
        table(("test", "result", "seconds"), ((html.escape(name), outcome(word), f"{run.seconds[name]:.1f}") for name, word in sorted(run.tests.items()))),
    ]
    report.parent.mkdir(parents=True, exist_ok=True)
    head = f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>dtsd: verification report</title><style>{STYLE}</style></head><body>'
    report.write_text("\n".join([head, *parts, "</body></html>", ""]), encoding="utf-8")
    print(f"{report}: {len(run.tests)} tests, {len(failed)} failed; {len(rows)} requirements, {len(open_ids)} of which a test did not pass")
    for id in open_ids:
        print(f"  {id}: a test failed, was skipped or did not run")
    return 1 if failed or open_ids else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
