# SPDX-License-Identifier: Apache-2.0
"""What each test of this folder does at its beginning and at its end."""
import signal
import sys
from collections.abc import Callable

from child import Failure, what_is_missing

SKIPPED = 77


class Checks:
    """Prints every check as a line."""

    def __init__(self) -> None:
        self.failed = 0

    def expect(self, what: str, is_so: object, otherwise: object = "") -> None:
        """`otherwise` is printed if the check fails."""
        print(f"{'ok    ' if is_so else 'FAILED'}  {what}{'' if is_so or not otherwise else f': {otherwise}'}", flush=True)
        self.failed += not is_so


def run_test(test: Callable[[Checks], None]) -> None:
    """Runs a test and ends the process: 0 all checks passed, 1 not, 77 there is no centre on this machine."""
    missing = what_is_missing()
    if missing:
        print(f"skipped: {missing}")
        sys.exit(SKIPPED)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that everything is stopped
    checks = Checks()
    try:
        test(checks)
    except Failure as failure:
        checks.expect("the test came to its end", False, failure)
    sys.exit(1 if checks.failed else 0)
