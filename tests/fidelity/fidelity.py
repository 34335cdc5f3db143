#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Compares our figures with those that were printed: the thesis's tables, and values that authors published for their recordings.

    fidelity.py DTSLAB SHARED OUT

Writes OUT/report.html and OUT/paper. Exit status 0: every figure with a limit is within it, 1: one is not, 2: wrong use.
"""

import csv
import html
import json
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "dtsd"  # the same bytes in each run
from matplotlib import pyplot

import limits

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Line:
    """One comparison. `verdict` is "within", "OUTSIDE", "not from the theory" or "reported"."""

    table: str
    label: str
    figure: str
    printed: str
    ours: str
    limit: str
    verdict: str


def run_json(*command: str) -> object:
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def shown(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def row_lines(table: dict) -> list[Line]:
    """A line for each deviation of each row."""
    lines = []
    for row in table["rows"]:
        printed = ", ".join(f"{name} {shown(value)}" for name, value in row["printed"].items())
        ours = ", ".join(f"{name} {shown(value)}" for name, value in row["ours"].items())
        for figure, deviation in row["deviation"].items():
            key = (table["table"], figure)
            limit, verdict = "", "reported"
            if key in limits.WITHIN:
                most = next(most for place, most in limits.WITHIN[key].items() if row["label"].endswith(place))
                limit = f"{most} %"
                verdict = "within" if abs(deviation) <= most else "OUTSIDE"
            elif key in limits.NOT_FROM_THE_THEORY:
                verdict = "not from the theory"
            lines.append(Line(table["table"], row["label"], f"{figure} {shown(deviation)}", printed, ours, limit, verdict))
    return lines


def summary_lines(table: dict) -> list[Line]:
    lines = []
    for figure, value in table["summary"].items():
        key = (table["table"], figure)
        limit, verdict = "", "reported"
        if key in limits.AT_MOST:
            bound, of = limits.AT_MOST[key]
            limit, verdict = f"at most {bound} ({of})", "within" if value <= bound else "OUTSIDE"
        elif key in limits.AT_LEAST:
            bound, of = limits.AT_LEAST[key]
            limit, verdict = f"at least {bound} ({of})", "within" if value >= bound else "OUTSIDE"
        lines.append(Line(table["table"], "summary", figure, "", shown(value), limit, verdict))
    if table["table"] == "3.6":
        means = [table["summary"][name] for name in limits.ORDER_OF_MEANS]
        verdict = "within" if means == sorted(means, reverse=True) else "OUTSIDE"
        lines.append(Line("3.6", "summary", "order of the means", "", ", ".join(map(shown, means)), "the largest first, as printed", verdict))
    return lines


def check_limits(tables: list[dict]) -> None:
    """Ends with an error if a limit is of a figure that dtslab does not print: it would never be OUTSIDE."""
    figures = {(table["table"], figure) for table in tables for row in table["rows"] for figure in row["deviation"]}
    figures |= {(table["table"], figure) for table in tables for figure in table["summary"]}
    for key in [*limits.WITHIN, *limits.AT_MOST, *limits.AT_LEAST, *limits.NOT_FROM_THE_THEORY]:
        if key not in figures:
            raise SystemExit(f"fidelity: limits.py has {key}, which dtslab does not print: correct the name")


def published_lines(dtslab: Path, shared: Path) -> list[Line]:
    lines = []
    for name, values in limits.PUBLISHED.items():
        file = shared / "data/cop" / name
        if not file.exists():
            print(f"fidelity: {file} is not there: its lines are missing", file=sys.stderr)
            continue
        found = run_json(str(dtslab), "sway", str(file), "--profile", "asis", "--json")
        measures = {name: measure["value"] for name, measure in found["measures"].items()}
        for measure, published in values.items():
            ours = measures[measure]
            verdict = "within" if abs(ours - published) <= limits.PUBLISHED_RELATIVE * abs(published) else "OUTSIDE"
            lines.append(Line("published", name, measure, repr(published), repr(ours), f"{limits.PUBLISHED_RELATIVE} relative", verdict))
    return lines


def draw(table: dict, out: Path) -> None:
    """Printed values against ours: one point for each pair of columns of the same unit and name."""
    figure, axes = pyplot.subplots(figsize=(4.5, 4.5))
    highest = 0.0
    for name in table["rows"][0]["printed"]:
        pairs = [(row["printed"][name], row["ours"][name]) for row in table["rows"] if name in row["ours"] and name in row["printed"]]
        if pairs:
            axes.plot(*zip(*pairs), "o", markersize=4, alpha=0.7, label=name)
            highest = max(highest, *(max(pair) for pair in pairs))
    if highest == 0.0:
        pyplot.close(figure)
        return
    axes.plot([0, highest], [0, highest], color="grey", linewidth=0.8)
    axes.set(xlabel="printed", ylabel="ours", title=f"Table {table['table']}")
    axes.legend()
    figure.savefig(out / f"table_{table['table']}.svg", metadata={"Date": None})
    pyplot.close(figure)


def write_csv(table: dict, out: Path) -> None:
    columns = [(part, name) for part in ("printed", "ours", "deviation") for name in table["rows"][0][part]]
    with open(out / f"table_{table['table']}.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["row", *(f"{part}_{name}" for part, name in columns)])
        writer.writerows([row["label"], *(row[part].get(name, "") for part, name in columns)] for row in table["rows"])


METHODS = """# Methods

The figures were computed with dtslab {version} (`scripts/fidelity`). Plates: finite elements and finite differences of a
thin plate. People are simulated, and sensors have noise and quantisation; nothing is fitted to the printed results
except what the notes of a table name. Tables: CSV files beside this text, with the printed value, ours and the
deviation. Pictures: SVG files, printed values against ours.

Published values of recordings: Santos & Duarte 2016, "A public data set of human balance evaluations" (PeerJ 4:e2648),
CC BY 4.0.

"""


def write_paper(tables: list[dict], version: str, out: Path) -> None:
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    text = METHODS.format(version=version)
    for table in tables:
        write_csv(table, out)
        draw(table, out)
        text += f"## Table {table['table']}: {table['title']}\n\n" + "".join(f"- {note}\n" for note in table["notes"]) + "\n"
    (out / "methods.md").write_text(text, encoding="utf-8")
    shutil.copy(ROOT / "CITATION.cff", out)


STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 80rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-size: 0.85rem; } th, td { border: 1px solid #bbb; padding: 0.2rem 0.5rem; text-align: left; }
.OUTSIDE { background: #fbe3d8; font-weight: bold; } .within { background: #e2f3ec; } img { max-width: 24rem; }
"""


def write_report(tables: list[dict], lines: list[Line], version: str, out: Path) -> None:
    counts = {verdict: sum(line.verdict == verdict for line in lines) for verdict in ("within", "OUTSIDE", "not from the theory", "reported")}
    parts = [
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>dtsd: fidelity</title><style>{STYLE}</style></head><body>',
        "<h1>Fidelity: printed figures beside ours</h1>",
        f"<p>dtslab {html.escape(version)}. " + ", ".join(f"{count} {verdict}" for verdict, count in counts.items()) + ".</p>",
        "<p>Within: the figure is within its limit: that of the plate-model sheet, which was set before the figure was computed, or the one that the "
        "line names. Not from the theory: the printed figure does not "
        "follow from what the thesis states, so there is no limit; the notes say why. Reported: no limit was set.</p>",
    ]
    titles = [(table["table"], f"Table {table['table']}: {table['title']}", table["notes"]) for table in tables]
    for name, title, notes in [*titles, ("published", "Values that authors published for their recordings", [])]:
        parts.append(f"<h2>{html.escape(title)}</h2>")
        if (out / "paper" / f"table_{name}.svg").exists():
            parts.append(f'<img src="paper/table_{name}.svg" alt="printed values against ours">')
        parts.append("<ul>" + "".join(f"<li>{html.escape(note)}</li>" for note in notes) + "</ul>")
        parts.append("<table><tr>" + "".join(f"<th>{head}</th>" for head in ("row", "figure", "printed", "ours", "limit", "verdict")) + "</tr>")
        for line in lines:
            if line.table == name:
                cells = (line.label, line.figure, line.printed, line.ours, line.limit)
                parts.append("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + f'<td class="{line.verdict.split()[0]}">{line.verdict}</td></tr>')
        parts.append("</table>")
    (out / "report.html").write_text("\n".join([*parts, "</body></html>", ""]), encoding="utf-8")


def main(arguments: list[str]) -> int:
    if len(arguments) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    dtslab, shared, out = map(Path, arguments)
    version = subprocess.run([dtslab, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    print("Computing the tables of the thesis, about 2 min", file=sys.stderr)
    found = run_json(str(dtslab), "thesis", "all", "--json")
    tables = found if isinstance(found, list) else found["tables"]
    check_limits(tables)
    lines = [line for table in tables for line in (*summary_lines(table), *row_lines(table))] + published_lines(dtslab, shared)
    write_paper(tables, version, out / "paper")
    write_report(tables, lines, version, out)
    outside = [line for line in lines if line.verdict == "OUTSIDE"]
    for line in outside:
        print(f"outside: Table {line.table}, {line.label}, {line.figure}; limit {line.limit}")
    print(f"{out / 'report.html'}: {len(lines)} figures, {sum(line.verdict == 'within' for line in lines)} within their limits, {len(outside)} outside")
    return 1 if outside else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
