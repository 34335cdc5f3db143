#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A second implementation of S3: puts, in parts too, looks, reads, lists and removes with s3rver. Skipped without it (npm install s3rver).

s3rver is looked for in the path; unit_fleet_s3 does what is tried with it."""
import os
import shutil
import sys
import tempfile
from pathlib import Path

from checks import SKIPPED, Checks
from child import PROGRAMS, Child, Failure, free_port, run, wait_until

UNIT_TEST = PROGRAMS.parent / "tests/unit_fleet_s3"


def s3rver(checks: Checks, found: str, folder: Path) -> None:
    port = free_port()
    keys = folder / "s3.keys"
    keys.touch(0o600)
    keys.write_text("S3RVER\nS3RVER\n")
    server = Child("s3rver", [found, "--directory", folder / "objects", "--address", "127.0.0.1", "--port", str(port), "--configure-bucket",
                              "recordings"], folder / "s3rver.log")
    try:
        server.start()
        wait_until("s3rver listens", lambda: server.expect_alive() and "listening" in server.text())
        done = run(UNIT_TEST, "--gtest_filter=OtherServerTest.*",
                   env=os.environ | {"DTS_S3": f"http://127.0.0.1:{port} recordings us-east-1 {keys}"})
    except Failure as failure:
        done = str(failure)
    finally:
        server.stop()
    checks.expect("s3rver: put, in parts too, look, read, list, remove", "[  PASSED  ] 1 test" in done and "SKIPPED" not in done, done)


def main() -> int:
    found = shutil.which("s3rver")
    if found is None or not UNIT_TEST.exists():
        print("skipped: s3rver is not installed: npm install s3rver" if found is None else f"skipped: {UNIT_TEST} is not built")
        return SKIPPED
    checks = Checks()
    with tempfile.TemporaryDirectory(prefix="dts-s3rver.") as folder:
        s3rver(checks, found, Path(folder))
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
