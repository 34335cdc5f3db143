# SPDX-License-Identifier: Apache-2.0
"""The dashboard of a centre: dts-fleet-gateway."""
import os
import re

from centre import Centre
from child import PROGRAMS, Child, program

WEB_ROOT = os.environ.get("DTS_WEB_ROOT", str(PROGRAMS.parent / "share/dts-gateway/web"))


class Gateway(Child):
    """dts-fleet-gateway on a port of 127.0.0.1; 0: any. Start it while the centre runs."""

    def __init__(self, centre: Centre, port: int = 0) -> None:
        words = [program("dts-fleet-gateway"), "serve", "--config", centre.config, "--listen", f"127.0.0.1:{port}", "--web-root", WEB_ROOT]
        super().__init__("dts-fleet-gateway", words, centre.folder / "gateway.log")

    def address(self) -> str | None:
        """Returns "http://127.0.0.1:PORT", None while it does not listen yet."""
        self.expect_alive()
        found = re.search(r"listening on (http://\S+)/", self.text())
        return found.group(1) if found else None
