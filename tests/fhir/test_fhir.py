# SPDX-License-Identifier: Apache-2.0
"""Bundles of both rigs are valid FHIR R4, and a bundle with a fault is found."""
import base64
import copy
import json
import os
import shutil
import subprocess
import tempfile
import unittest
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from support import PATIENCE_S, SOURCE, DaemonProcess, wait_for

from dts.v1 import sessions_pb2

Json = dict[str, Any]
CODES = SOURCE / "docs" / "fhir-codes.json"
STANDING = """name = "brief-standing"
sentence = "Eyes open, eyes closed"
rig_kind = "floor"
[trials]
starts_by_itself = true
settle_s = 0.5
duration_s = 2
rest_s = 0.2
[[trials.condition]]
name = "eyes-open"
labels = { eyes = "open", feet = "two" }
[[trials.condition]]
name = "eyes-closed"
labels = { eyes = "closed", feet = "two" }
"""
REACHING = """name = "examination"
sentence = "Brisk reaches"
[[field]]
name = "weight_kg"
label = "Body weight"
minimum = 10
maximum = 250
[[field]]
name = "height_cm"
label = "Body height"
minimum = 60
maximum = 230
[[field]]
name = "arm_length_cm"
label = "Arm length"
minimum = 20
maximum = 120
[[field]]
name = "max_reach_cm"
label = "Maximum reach"
minimum = 10
maximum = 250
[trials]
starts_by_itself = true
cue_delay_min_s = 1.0
duration_s = 3.6
rest_s = 0.4
[[trials.condition]]
name = "max-1"
maximum_reach = true
[[trials.condition]]
name = "150"
target_percent = 150
[[trials.condition]]
name = "80"
target_percent = 80
"""
PERSON = {"weight_kg": "68", "height_cm": "175", "arm_length_cm": "67", "max_reach_cm": "124"}
CHAIR = "sim:chair?seed=11&reaches=cued&sit_down_s=1.5&pace_s=0.7&weight_kg=68&height_cm=175&arm_length_cm=67&max_reach_cm=124"


def findings_of(*bundles: Path) -> dict[str, dict[str, list[str]]]:
    """Returns the findings of each bundle, without the checks that found nothing."""
    command = [os.environ.get("DTS_NODE", "node"), Path(__file__).with_name("validate.cjs"), CODES, *bundles]
    done = subprocess.run(command, timeout=10 * PATIENCE_S, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found: dict[str, dict[str, list[str]]] = json.loads(done.stdout)
    return {name: {check: texts for check, texts in checks.items() if texts} for name, checks in found.items()}


def resources(bundle: Json, kind: str) -> list[Json]:
    return [entry["resource"] for entry in bundle["entry"] if entry["resource"]["resourceType"] == kind]


def code(concept: Json) -> str:
    return str(concept["coding"][0]["code"] if "coding" in concept else concept["text"])


def observations(bundle: Json, wanted: str) -> list[Json]:
    return [one for one in resources(bundle, "Observation") if code(one["code"]) == wanted]


def components(observation: Json) -> dict[str, Json]:
    return {code(one["code"]): one for one in observation["component"]}


class Bundles(unittest.TestCase):
    folder: Path
    process: DaemonProcess
    floor: str
    corrected: str
    chair: str

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        chair = next(line.split('"')[1] for line in (SOURCE / "config" / "dtsd.toml").read_text().splitlines() if "sim:chair" in line)
        cls.process = DaemonProcess(devices={f'"{chair}"': f'"{CHAIR}"'})
        cls.addClassCleanup(cls.process.close)
        protocols = cls.process.folder / "config" / "protocols"
        (protocols / "brief-standing.toml").write_text(STANDING)
        (protocols / "examination.toml").write_text(REACHING)
        cls.process.stop()  # a daemon reads its protocols when it starts
        cls.process.start()
        with ThreadPoolExecutor() as both:
            standing = both.submit(lambda: [cls.examine("floor", "brief-standing", {}) for _ in range(2)])
            cls.chair = cls.examine("chair", "examination", PERSON)
            cls.floor, cls.corrected = standing.result()

    @classmethod
    def examine(cls, rig: str, protocol: str, fields: dict[str, str]) -> str:
        with cls.process.connect() as daemon:
            topic = "floor/cop" if rig == "floor" else "chair/transient"
            daemon.record(topic, 3.0)  # the simulated person stands or sits by then
            session = daemon.start_session(rig, protocol, subject="P-017", label="first day", fields=fields)
            session.trial("next")

            def is_finished() -> bool:
                status = next(one for one in daemon.status().rigs if one.rig.name == rig)
                return bool(status.session.trial.phase == sessions_pb2.TRIAL_PHASE_FINISHED)

            wait_for(is_finished, f"all trials of {rig} are done")
            session.stop()
            return session.id

    def export(self, session: str, name: str) -> tuple[Path, Json]:
        done = json.loads(self.process.dtsctl("session", "export", session, "--format", "fhir", "--out", str(self.folder / name), "--json"))
        (file,) = done["files"]
        self.assertEqual(done["bytes"], Path(file).stat().st_size)
        return Path(file), json.loads(Path(file).read_text())

    def assert_valid(self, *files: Path) -> None:
        for name, found in findings_of(*files).items():
            self.assertEqual(found, {}, name)

    def test_BundlesOfBothRigsAreValid(self) -> None:
        # requirement: REP-10
        floor, standing = self.export(self.floor, "floor")
        chair, reaching = self.export(self.chair, "chair")

        self.assert_valid(floor, chair)
        trials = observations(standing, "standing-trial")
        self.assertEqual([components(one)["eyes"]["valueString"] for one in trials], ["open", "closed"])
        self.assertEqual(len(observations(reaching, "reaching-trial")), 3)
        self.assertTrue(all(one["meta"]["security"][0]["code"] == "HTEST" for one in resources(standing, "Observation")))

    def test_ValuesAreThoseOfTheSession(self) -> None:
        _, bundle = self.export(self.floor, "values")
        shown = json.loads(self.process.dtsctl("session", "show", self.floor, "--json"))

        exported = {code(one["code"]): one for one in observations(bundle, "condition-mean")[0]["component"]}
        condition = exported["condition"]["valueString"]
        results = {result["name"]: result for result in shown["results"]}
        compared = 0
        for name, one in exported.items():
            if "valueQuantity" not in one:
                continue
            compared += 1
            recorded = results[f"{condition}/{name}"]
            self.assertLess(abs(one["valueQuantity"]["value"] - recorded["value"]), 1e-5 * abs(recorded["value"]) + 1e-12, name)
        self.assertGreater(compared, 5)

    def test_TheReportIsAPdf(self) -> None:
        if shutil.which("rsvg-convert") is None:
            self.skipTest("rsvg-convert is not installed")
        _, bundle = self.export(self.floor, "pdf")

        (form,) = resources(bundle, "DiagnosticReport")[0]["presentedForm"]
        data = base64.b64decode(form["data"])
        self.assertEqual((data[:5], len(data)), (b"%PDF-", form["size"]))

    def test_TwoExportsAreTheSameBytes(self) -> None:
        first, _ = self.export(self.chair, "one")
        second, _ = self.export(self.chair, "two")

        self.assertEqual(first.read_bytes(), second.read_bytes())

    def test_WithoutThePdfProgramTheExportSaysSo(self) -> None:
        command = [DaemonProcess.program("dtsctl"), "session", "export", self.floor, "--format", "fhir", "--out", self.folder / "bare"]
        environment = {**self.process.environment, "PATH": str(self.folder)}
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=2 * PATIENCE_S)

        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the bundle has no PDF", done.stderr)
        (file,) = (self.folder / "bare").iterdir()
        self.assert_valid(file)
        self.assertNotIn("presentedForm", resources(json.loads(file.read_text()), "DiagnosticReport")[0])

    def test_ASessionWithoutTrialsIsValid(self) -> None:
        with self.process.connect() as daemon:
            session = daemon.start_session("floor", "free", subject="P-018")
            daemon.record("floor/cop", 1.0)
            running = subprocess.run(
                [DaemonProcess.program("dtsctl"), "session", "export", session.id, "--format", "fhir", "--out", self.folder / "running"],
                env=self.process.environment, capture_output=True, text=True, timeout=PATIENCE_S)
            session.stop()

        self.assertNotEqual(running.returncode, 0)
        self.assertIn("still being recorded", running.stderr)
        file, bundle = self.export(session.id, "free")
        self.assert_valid(file)
        self.assertEqual(resources(bundle, "Observation"), [])

    def test_ACorrectedSessionWithdrawsATrial(self) -> None:
        with self.process.connect() as daemon:
            daemon.correct_session(self.corrected, "subject talked", trial=2, outcome="rejected")
            daemon.correct_session(self.corrected, "wrong subject", subject="P-019")
            daemon.correct_session(self.corrected, "a note", notes="was dizzy")

        file, bundle = self.export(self.corrected, "corrected")

        self.assert_valid(file)
        self.assertEqual([one["status"] for one in observations(bundle, "standing-trial")], ["amended", "entered-in-error"])
        self.assertEqual(resources(bundle, "Patient")[0]["identifier"][0]["value"], "P-019")
        self.assertNotIn("P-017", file.read_text())
        if shutil.which("rsvg-convert") is None or shutil.which("pdftotext") is None:
            self.skipTest("rsvg-convert or pdftotext is not installed")
        (form,) = resources(bundle, "DiagnosticReport")[0]["presentedForm"]
        page = subprocess.run(["pdftotext", "-layout", "-", "-"], input=base64.b64decode(form["data"]), capture_output=True, check=True,
                              timeout=PATIENCE_S).stdout.decode()
        self.assertIn("P-019", page)
        for left_out in ("P-017", "first day", "wrong subject", "dizzy", "corrected; recorded: P"):
            self.assertNotIn(left_out, page)

    def test_EveryMutantIsFound(self) -> None:
        """Shows that each check can fail, with the faults that an exporter could have."""
        _, bundle = self.export(self.floor, "mutants")
        _, reaching = self.export(self.chair, "chair-mutants")
        files: dict[str, str] = {}
        for number, (check, origin, mutate) in enumerate(MUTANTS):
            mutant = copy.deepcopy(bundle if origin == "floor" else reaching)
            mutate(mutant)
            file = self.folder / f"mutant-{number}.json"
            file.write_text(json.dumps(mutant))
            files[str(file)] = check

        found = findings_of(*map(Path, files))

        for number, (name, check) in enumerate(files.items()):
            self.assertIn(check, found[name], f"mutant {number} ({check}) is not found: {found[name]}")


def trial(bundle: Json) -> Json:
    return (observations(bundle, "standing-trial") or observations(bundle, "reaching-trial"))[0]


def quantity(bundle: Json) -> Json:
    found: Json = next(one["valueQuantity"] for one in trial(bundle)["component"] if "valueQuantity" in one)
    return found


Mutate = Callable[[Json], object]
MUTANTS: list[tuple[str, str, Mutate]] = [
    ("schema", "floor", lambda bundle: bundle.update(type="collections")),
    ("schema", "floor", lambda bundle: trial(bundle).update(status="done")),
    ("schema", "floor", lambda bundle: trial(bundle).pop("code")),
    ("schema", "floor", lambda bundle: trial(bundle).update(conclusion="unsteady")),
    ("schema", "floor", lambda bundle: quantity(bundle).update(value="8.4")),
    ("schema", "floor", lambda bundle: trial(bundle)["effectivePeriod"].update(start="21.11.2026 14:45")),
    ("schema", "floor", lambda bundle: resources(bundle, "DiagnosticReport")[0].update(issued="2026-11-21")),
    ("schema", "chair", lambda bundle: trial(bundle).update(component={})),
    ("structure", "floor", lambda bundle: resources(bundle, "DiagnosticReport")[0].pop("status")),
    ("structure", "floor", lambda bundle: resources(bundle, "Device")[0]["deviceName"][0].update(type="nickname")),
    ("structure", "chair", lambda bundle: resources(bundle, "Patient")[0]["identifier"][0].update(use="third")),
    ("units", "floor", lambda bundle: quantity(bundle).update(code="mm^2")),
    ("units", "chair", lambda bundle: quantity(bundle).update(code="degrees")),
    ("rules", "floor", lambda bundle: trial(bundle)["subject"].update(reference="urn:uuid:00000000-0000-5000-8000-000000000000")),
    ("rules", "floor", lambda bundle: trial(bundle).update(interpretation=[{"text": "high"}])),
    ("rules", "floor", lambda bundle: trial(bundle)["component"].append({"code": trial(bundle)["component"][0]["code"]})),
    ("rules", "floor", lambda bundle: trial(bundle)["code"]["coding"][0].update(system="http://loinc.org", code="44963-7")),
    ("rules", "floor", lambda bundle: trial(bundle)["component"][-1]["code"]["coding"][0].update(code="MVELOCITY")),
    ("rules", "floor", lambda bundle: resources(bundle, "Patient")[0].update(name=[{"family": "Example"}])),
    ("rules", "floor", lambda bundle: trial(bundle).update(status="entered-in-error")),
    ("rules", "floor", lambda bundle: trial(bundle).pop("effectivePeriod")),
    ("rules", "chair", lambda bundle: bundle["entry"].append(bundle["entry"][0])),
    ("rules", "chair", lambda bundle: trial(bundle).update(valueInteger=1, dataAbsentReason={"text": "none"})),
]

if __name__ == "__main__":
    unittest.main()
