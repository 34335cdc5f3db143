#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How well the age group, falls, illness and disability are told from sway, with the limits that they must keep.

    pattern_figures.py DTSLAB TABLE.csv [OTHERS.csv]

TABLE.csv: the measures of dtslab sway --table with the columns subject, condition, group60, fell12m, ill, disability, age, height_cm, sex.
OTHERS.csv: the same of other people, whom the models of TABLE.csv have not seen. Without TABLE.csv on this machine: exit status 77 (skipped).
"""

import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile

LEFT_OUT = {"eo_firm": 0.78, "ec_firm": 0.79, "eo_firm,ec_firm": 0.82}  # AUC of people, group60
VERDICTS = {"fell12m": "not told", "disability": "not told", "ill": "told by age, not by sway"}
POSITIVE = "60plus"


class Checks:
    def __init__(self):
        self.failed = 0

    def within(self, what, value, low, high):
        is_good = low - 1e-9 <= value <= high + 1e-9
        self.failed += not is_good
        print(f"  {what:<34} {value:6.3f}   {low:g} to {high:g}   {'good' if is_good else 'NOT within'}")

    def equal(self, what, found, wanted):
        self.failed += found != wanted
        print(f"  {what:<34} {found}   {'good' if found == wanted else 'NOT ' + wanted}")


def train(dtslab, table, label, condition, out=None):
    """The figures; with `out` also the model."""
    command = [dtslab, "steadiness", "train", table, "--label", label, "--where", f"condition={condition}", "--json"]
    done = subprocess.run(command + (["--out", out] if out else []), capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1) or not done.stdout:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def auc(scores, is_positive):
    """Probability that a positive case has the higher score; None without a pair."""
    pairs = [(p > n) + 0.5 * (p == n) for p, is_p in zip(scores, is_positive) if is_p for n, is_n in zip(scores, is_positive) if not is_n]
    return sum(pairs) / len(pairs) if pairs else None


def slope_of(probabilities, is_positive):
    """Slope of the calibration, by Newton's method."""
    intercept, slope = 0.0, 1.0
    odds = [math.log(min(max(p, 1e-12), 1 - 1e-12) / (1 - min(max(p, 1e-12), 1 - 1e-12))) for p in probabilities]
    for _ in range(100):
        fitted = [1 / (1 + math.exp(-(intercept + slope * x))) for x in odds]
        error = [y - f for y, f in zip(is_positive, fitted)]
        weight = [f * (1 - f) for f in fitted]
        g0, g1 = sum(error), sum(e * x for e, x in zip(error, odds))
        h0, h1, h2 = sum(weight), sum(w * x for w, x in zip(weight, odds)), sum(w * x * x for w, x in zip(weight, odds))
        determinant = h0 * h2 - h1 * h1
        intercept += (h2 * g0 - h1 * g1) / determinant
        slope += (h0 * g1 - h1 * g0) / determinant
    return slope


def judge_others(checks, dtslab, model, others, condition, folder):
    """Classifies the trials of other people under one condition and checks the figures."""
    with open(others, newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["condition"] == condition]
    table, out = os.path.join(folder, "others.csv"), os.path.join(folder, "predictions.csv")
    with open(table, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    subprocess.run([dtslab, "steadiness", "classify", model, table, "--out", out], capture_output=True, check=True)
    with open(out, newline="") as file:
        predictions = list(csv.DictReader(file))
    answered = [row["p_" + POSITIVE] != "" for row in predictions]
    checks.within("share of rows answered", sum(answered) / len(rows), 1.0, 1.0)
    probability = [float(row["p_" + POSITIVE] or 0.5) for row in predictions]
    truth = [row["group60"] == POSITIVE for row in rows]
    people = sorted({row["subject"] for row in rows})
    pooled = {person: [p for p, row in zip(probability, rows) if row["subject"] == person] for person in people}
    score = {person: sum(values) / len(values) for person, values in pooled.items()}
    group = {row["subject"]: row["group60"] == POSITIVE for row in rows}
    generator = random.Random(29)
    drawn = []
    for _ in range(1000):
        sample = [generator.choice(people) for _ in people]
        value = auc([score[person] for person in sample], [group[person] for person in sample])
        if value is not None:
            drawn.append(value)
    drawn.sort()
    checks.within("AUC of people", auc([score[person] for person in people], [group[person] for person in people]), 0.72, 1.0)
    checks.within("its lower end (95 %)", drawn[round(0.025 * (len(drawn) - 1))], 0.5, 1.0)
    rights = [sum((p > 0.5) == t for p, t in zip(probability, truth) if t == side) / truth.count(side) for side in (True, False)]
    checks.within("balanced accuracy", sum(rights) / 2, 0.62, 1.0)
    checks.within("Brier", sum((p - t) ** 2 for p, t in zip(probability, truth)) / len(truth), 0.0, 0.225)
    checks.within("slope of the calibration", slope_of(probability, truth), 0.4, 1.7)
    print(f"  outside of the training            {sum(row['outside'] != '' for row in predictions)} of {len(rows)}")


def main(dtslab, table, others=None):
    if not os.path.exists(table):
        print(f"skipped: {table} is not on this machine")
        return 77
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        for condition, wanted in LEFT_OUT.items():
            model = os.path.join(folder, "model.json")
            result = train(dtslab, table, "group60", condition, model)
            test = result["tests"][0]["model"]
            low, high = test["auc_people_95"]
            print(f"group60, {condition}: AUC of people {test['auc_people']:.3f} ({low:.2f} to {high:.2f})")
            checks.within("AUC of people, leave one out", test["auc_people"], wanted - 0.02, wanted + 0.02)
            checks.within("slope of the calibration", test["slope"], 0.7, 1.3)
            checks.equal("verdict", result["verdict"], "told")
            if others and "," not in condition:
                judge_others(checks, dtslab, model, others, condition, folder)
    for label, verdict in VERDICTS.items():
        print(f"{label}, ec_firm")
        checks.equal("verdict", train(dtslab, table, label, "ec_firm")["verdict"], verdict)
    return 1 if checks.failed else 0


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
