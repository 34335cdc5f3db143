# SPDX-License-Identifier: Apache-2.0
import unittest
from collections.abc import Callable

from support import WithDaemon, wait_for

import dts
from dts.v1 import control_pb2, sessions_pb2


class Waiting(unittest.TestCase):
    def test_SessionIsOverWhenItsRecordingIsClosed(self) -> None:
        class SlowDisk:
            """No rig has the session any more; its file is closed when it is asked for the third time."""

            asked = 0

            def status(self) -> control_pb2.StatusSnapshot:
                return control_pb2.StatusSnapshot()

            def session(self, session_id: str) -> sessions_pb2.SessionRecord:
                self.asked += 1
                return sessions_pb2.SessionRecord(session_id=session_id, state="running" if self.asked < 3 else "complete")

        session = dts.Session(SlowDisk(), control_pb2.SessionInfo(session_id="S", rig="floor"))  # type: ignore[arg-type]

        self.assertEqual(session.wait(timeout=60).state, "complete")


class Sessions(WithDaemon):
    def test_SessionIsRecordedWithItsMarks(self) -> None:
        with self.daemon.start_session("floor", "free", subject="P017", label="first") as session:
            mark = session.mark("hello")
            self.daemon.record("floor/cop", 0.5)
            self.assertTrue(session.is_running)

        record = self.daemon.session(session.id)
        recording = dts.load(record.parts[0].file)
        self.assertEqual((record.state, record.subject, record.label), ("complete", "P017", "first"))
        self.assertEqual([(event.fields["text"], event.scan) for event in recording.events_of("marker")], [("hello", mark.scan)])
        assert recording.session is not None
        self.assertEqual((recording.session.session_id, recording.session.subject), (session.id, "P017"))
        self.assertEqual([found.session_id for found in self.daemon.sessions(subject="P017")], [session.id])

    def test_SessionOverTwoRigsIsOne(self) -> None:
        with self.daemon.start_session("floor", "free", companions=["chair"]) as session:
            session.mark("hello")
            self.assertEqual(list(session.info().rigs), ["floor", "chair"])

        record = self.daemon.session(session.id)
        self.assertEqual([(part.rig, part.leading_part) for part in record.parts], [("floor", 0), ("chair", 1)])
        for part in record.parts:
            self.assertEqual(len(dts.load(part.file).events_of("marker")), 1)

    def test_SessionIsCorrectedDeletedAndErased(self) -> None:
        with self.daemon.start_session("floor", "free", subject="P071", label="first") as session:
            session.mark("hello")

        corrected = self.daemon.correct_session(session.id, "typing error", subject="P072", label="")
        self.assertEqual((corrected.subject, corrected.label), ("P072", ""))
        self.assertEqual([(one.field, one.new_value) for one in corrected.corrections], [("subject", "P072"), ("label", "")])
        with self.assertRaises(dts.InvalidArgument):
            self.daemon.correct_session(session.id, "typing error", subject="Anna Schmidt")
        self.assertTrue(self.daemon.delete_session(session.id, "a test").is_deleted)
        self.assertEqual(self.daemon.sessions(subject="P072"), [])
        self.assertEqual([found.session_id for found in self.daemon.sessions(subject="P072", deleted=True)], [session.id])
        self.assertFalse(self.daemon.restore_session(session.id).is_deleted)
        self.assertIn("P072", [subject.subject for subject in self.daemon.subjects()])
        self.assertEqual(self.daemon.subject("P072").about.sessions, 1)
        erased = self.daemon.erase_subject("P072")
        self.assertEqual((erased.sessions, erased.files), (1, 3))
        self.assertIn("backup", erased.backups)
        with self.assertRaises(dts.NotFound):
            self.daemon.session(session.id)
        with self.assertRaises(dts.NotFound):
            self.daemon.subject("P072")

    def test_ExceptionAbortsTheSession(self) -> None:
        with self.assertRaises(ZeroDivisionError), self.daemon.start_session("floor", "free") as session:
            1 / 0

        record = self.daemon.session(session.id)
        self.assertEqual(record.state, "aborted")
        self.assertIn("ZeroDivisionError", record.message)

    def test_SecondSessionOfARigIsWrongState(self) -> None:
        with self.daemon.start_session("floor", "free"):
            with self.assertRaises(dts.WrongState):
                self.daemon.start_session("floor", "free")

        with self.assertRaises(dts.WrongState):
            self.daemon.stop_session("floor")

    def test_SessionThatHasEndedLeavesTheNextOneAlone(self) -> None:
        wait_for(lambda: self.daemon.record("floor/cop", 0.1)["load_n"].mean() > 50, "somebody stands on the plate")
        ended = self.daemon.start_session("floor", "free")
        ended.stop()
        with self.daemon.start_session("floor", "quiet-standing") as session:
            commands: dict[str, Callable[[], object]] = {
                "mark": lambda: ended.mark("late"),
                "trial": lambda: ended.trial("next"),
                "stop": ended.stop,
                "abort": lambda: ended.abort("late"),
            }
            for name, command in commands.items():
                with self.subTest(name), self.assertRaisesRegex(dts.WrongState, ended.id):
                    command()
            trial = session.info().trial.trial

        record = self.daemon.session(session.id)
        self.assertEqual((record.state, trial), ("complete", 0))
        self.assertEqual(dts.load(record.parts[0].file).events_of("marker"), [])

    def test_SessionWithADurationEndsByItself(self) -> None:
        with self.daemon.start_session("floor", "free", duration_s=0.5) as session:
            record = session.wait(timeout=60)

        self.assertEqual(record.state, "complete")
        self.assertGreater(record.parts[0].duration_s, 0.45)
        self.assertLess(record.parts[0].duration_s, 10)  # a busy machine gives the daemon its turn late
        with self.assertRaises(dts.WrongState):
            session.info()

    def test_WaitingForASessionWithoutEndTimesOut(self) -> None:
        with self.daemon.start_session("floor", "free") as session:
            with self.assertRaises(dts.Timeout):
                session.wait(timeout=0.2)

    def test_TrialsAreSteppedThroughAndTold(self) -> None:
        wait_for(lambda: self.daemon.record("floor/cop", 0.1)["load_n"].mean() > 50, "somebody stands on the plate")
        events = self.daemon.events("floor/trial")
        with self.daemon.start_session("floor", "quiet-standing") as session:
            status = session.trial("next")
            told = next(events)
            session.trial("reject")
            rejected = next(event for event in events if event.fields["step"] == "rejected")
            undone = session.trial("undo")
            next(event for event in events if event.fields["step"] == "undone")

        self.assertEqual(status.of, 12)
        self.assertEqual((told.kind, told.fields["trial"]), ("trial", 1))
        self.assertEqual(rejected.fields["condition"], "eyes-open-two-feet")
        self.assertEqual((undone.trial, undone.last_trial), (1, 0))

    def test_AuditHasWhatWasDone(self) -> None:
        with self.daemon.start_session("floor", "free") as session:
            pass

        audit = self.daemon.audit()

        self.assertEqual(audit.problem, "")
        self.assertTrue(any(session.id in entry.target for entry in audit.entries))


if __name__ == "__main__":
    unittest.main()
