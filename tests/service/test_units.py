#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The units of systemd/ are understood by systemd, keep their sandbox, and leave dtsd what it needs.

Exit status 77: no systemd-analyze here."""
import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

import units

HIGHEST_PRIORITY = 95 + 1  # [realtime] fifo_priority, and the USB events one above


class Verified(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def test_SystemdHasNothingToSay(self) -> None:
        for name in units.UNITS:
            self.assertEqual(units.complaints(self.folder, name, units.runnable_text(name)), "", name)

    def test_WrongTwins_AreNoticed(self) -> None:
        """What this test is worth: each of these is one word away from the real file."""
        for name in units.UNITS:
            text = units.runnable_text(name)
            twins = {
                "a key that does not exist": text.replace("ProtectHome=", "ProtectHomes="),
                "a value that does not exist": text.replace("ProtectSystem=strict", "ProtectSystem=strictly"),
                "a program that does not exist": text.replace(str(units.program_of(name)), "/nonexistent/program"),
                "an address that is none": text.replace("IPAddressDeny=any", "IPAddressDeny=anny"),
            }
            for what, twin in twins.items():
                self.assertNotEqual(twin, text, what)
                self.assertNotEqual(units.complaints(self.folder, name, twin), "", f"{name}: {what}")

    def test_SandboxKeepsItsScore(self) -> None:
        # requirement: SEC-8
        for name in units.UNITS:
            is_kept, report = units.exposure_report(self.folder, name, units.runnable_text(name))
            self.assertTrue(is_kept, report)

    def test_SandboxWithAHole_DoesNotKeepIt(self) -> None:
        for name in units.UNITS:
            for key in ("CapabilityBoundingSet", "SystemCallFilter"):
                twin = re.sub(rf"^{key}=.*\n", "", units.runnable_text(name), flags=re.MULTILINE)
                self.assertNotEqual(twin, units.runnable_text(name), key)
                is_kept, _ = units.exposure_report(self.folder, name, twin)
                self.assertFalse(is_kept, f"{name} without {key}")


class Daemon(unittest.TestCase):
    """What the daemon cannot do without, measured once on a real kernel: systemd/README.md."""

    def setUp(self) -> None:
        self.settings = units.settings(units.unit_text("dtsd"))

    def test_NothingHidesUsb(self) -> None:
        self.assertNotIn("PrivateDevices", self.settings)
        self.assertNotIn("PrivateNetwork", self.settings)  # uevents of the kernel do not arrive: a DAQ that comes is not seen
        self.assertEqual(self.settings["DeviceAllow"], ["char-usb_device rw", "char-ttyACM rw", "char-ttyUSB rw"])
        for module in ("usbcore", "cdc_acm", "usbserial"):
            for key in ("After", "Wants"):
                self.assertIn(f"modprobe@{module}.service", " ".join(self.settings[key]).split(), key)
        self.assertIn("AF_NETLINK", self.settings["RestrictAddressFamilies"][0].split())

    def test_SerialPortsAreReadable_ThoseOfThePcAreNot(self) -> None:
        self.assertEqual(self.settings["SupplementaryGroups"], ["dialout"])
        self.assertNotIn("char-ttyS", " ".join(self.settings["DeviceAllow"]))

    def test_ProgramOfADevice_EndsBeforeTheDaemon(self) -> None:
        """exec: of a rig. Without these, a program that uses up the memory or the processes would end the daemon."""
        self.assertEqual(self.settings["OOMPolicy"], ["continue"])
        self.assertLess(int(self.settings["OOMScoreAdjust"][0]), 0)
        self.assertIn("TasksMax", self.settings)
        self.assertEqual(self.settings["NoNewPrivileges"], ["yes"])

    def test_HasNoNetwork(self) -> None:
        # requirement: SEC-8
        """What comes from other machines ends in dts-relay or dts-gateway."""
        self.assertEqual(self.settings["RestrictAddressFamilies"], ["AF_UNIX AF_NETLINK"])
        self.assertEqual(self.settings["IPAddressDeny"], ["any"])
        self.assertNotIn("IPAddressAllow", self.settings)

    def test_NothingForbidsRealTime(self) -> None:
        self.assertNotIn("RestrictRealtime", self.settings)
        self.assertNotIn("CPUSchedulingPolicy", self.settings)
        self.assertGreaterEqual(int(self.settings["LimitRTPRIO"][0]), HIGHEST_PRIORITY)
        self.assertEqual(self.settings["LimitMEMLOCK"], ["infinity"])
        allowed = self.settings["SystemCallFilter"][-1].split()
        for call in ("sched_setscheduler", "sched_setparam", "sched_setattr", "sched_setaffinity", "setrlimit"):
            self.assertIn(call, allowed)

    def test_BootIdIsReadable(self) -> None:
        """It stands in /proc/sys. Without it a client cannot tell that it is on the same machine, and shows no age of data."""
        for name in ("dtsd", "dts-gateway"):
            self.assertNotIn("ProcSubset", units.settings(units.unit_text(name)), name)

    def test_SystemdWatchesOverIt(self) -> None:
        self.assertEqual(self.settings["Type"], ["notify"])
        self.assertIn("WatchdogSec", self.settings)
        self.assertEqual(self.settings["Restart"], ["on-failure"])
        self.assertEqual(self.settings["StartLimitIntervalSec"], ["0"])
        self.assertIn("MemoryMax", self.settings)


class Together(unittest.TestCase):
    def test_EveryUserAndGroupIsMade(self) -> None:
        # requirement: CFG-6
        made = "".join(file.read_text() for file in sorted((units.SOURCE / "systemd/sysusers.d").glob("*.conf")))
        users = set(re.findall(r"^u (\S+)", made, re.MULTILINE))
        groups = users | set(re.findall(r"^g (\S+)", made, re.MULTILINE))
        for name in units.UNITS:
            found = units.settings(units.unit_text(name))
            self.assertIn(found["User"][0], users)
            self.assertLessEqual({*found["Group"], *" ".join(found.get("SupplementaryGroups", [])).split()}, groups)

    def test_UdevRuleGivesTheDevicesToTheDaemonsGroup(self) -> None:
        rule = (units.SOURCE / "config/udev/70-dtsd.rules").read_text()
        self.assertEqual(set(re.findall(r'GROUP="([^"]+)"', rule)), set(units.settings(units.unit_text("dtsd"))["Group"]))

    def test_RelayReachesTheDaemonAndItsKeys_AndNothingElseOfIt(self) -> None:
        daemon, relay = (units.settings(units.unit_text(name)) for name in ("dtsd", "dts-relay"))
        state = f"/var/lib/{daemon['StateDirectory'][0]}"
        self.assertEqual(relay["User"], daemon["User"])
        self.assertEqual(relay["Environment"], [f"RUNTIME_DIRECTORY=/run/{daemon['RuntimeDirectory'][0]} STATE_DIRECTORY={state}"])
        self.assertEqual(relay["TemporaryFileSystem"], [f"{state}:ro"])
        self.assertEqual(relay["BindReadOnlyPaths"], [f"-{state}/keys"])
        self.assertLessEqual({"kill", "tgkill", "pidfd_send_signal"}, set(relay["SystemCallFilter"][1].split()))
        self.assertIn("dtsd.service", relay["After"][0].split())
        self.assertNotIn("Requires", relay)
        self.assertIn("MemoryMax", relay)

    @unittest.skipUnless("dts-worker" in units.UNITS, "the fleet is not built")
    def test_WorkerReachesNothingButPostgresAndTheStore(self) -> None:
        worker = units.settings(units.unit_text("dts-worker"))
        self.assertEqual(worker["PrivateNetwork"], ["yes"])
        self.assertEqual(worker["RestrictAddressFamilies"], ["AF_UNIX"])
        self.assertEqual(worker["SupplementaryGroups"], ["dts-hub"])
        self.assertNotIn("StateDirectory", worker)
        self.assertNotIn("ReadWritePaths", worker)
        self.assertLessEqual({"setrlimit", "prlimit64"}, set(worker["SystemCallFilter"][-1].split()))  # the limits of dtslab
        self.assertEqual(worker["OOMPolicy"], ["continue"])

    @unittest.skipUnless("dts-fleet-gateway" in units.UNITS, "the fleet is not built")
    def test_DashboardOfTheCentre_HasNoGroupAndNoFolderOfTheHub(self) -> None:
        """Its key and its role in PostgreSQL are its own: it cannot use those of the hub."""
        dashboard, hub = (units.settings(units.unit_text(name)) for name in ("dts-fleet-gateway", "dts-hub"))
        self.assertNotEqual(dashboard["User"], hub["User"])
        self.assertNotIn("SupplementaryGroups", dashboard)
        self.assertEqual(dashboard["StateDirectory"], ["dts-fleet-gateway"])
        self.assertEqual(dashboard["StateDirectoryMode"], ["0700"])
        self.assertIn("MemoryMax", dashboard)

    def test_LslReachesTheDaemonsSockets_AndNoFolderOfIt(self) -> None:
        lsl = units.settings(units.unit_text("dts-lsl"))
        self.assertEqual(lsl["SupplementaryGroups"], units.settings(units.unit_text("dtsd"))["Group"])
        self.assertEqual(lsl["InaccessiblePaths"], ["-/var/lib/dtsd"])
        self.assertEqual(lsl["IPAddressAllow"], ["localhost"])
        self.assertEqual(lsl["WorkingDirectory"], ["/etc/dtsd"])  # has lsl_api.cfg

    def test_GatewayReachesTheDaemon(self) -> None:
        daemon, gateway = (units.settings(units.unit_text(name)) for name in ("dtsd", "dts-gateway"))
        self.assertEqual(gateway["SupplementaryGroups"], daemon["Group"])
        self.assertEqual(gateway["Environment"], [f"DTSD_RUNTIME_DIR=/run/{daemon['RuntimeDirectory'][0]}"])
        self.assertIn("dtsd.service", gateway["After"][0].split())
        for folder in ("RuntimeDirectoryMode", "StateDirectoryMode"):
            self.assertEqual(daemon[folder], ["0750"])


if __name__ == "__main__":
    if shutil.which("systemd-analyze") is None:
        print("skipped: systemd-analyze is not installed (apt-get install systemd)")
        sys.exit(77)
    unittest.main()
