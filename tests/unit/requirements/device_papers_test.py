# SPDX-License-Identifier: Apache-2.0
"""Tests of device_papers.py."""

import tempfile
import unittest
from pathlib import Path

import device_papers

CONTROL = "Source: dtsd\nBuild-Depends:\n cmake,\n libusb-1.0-0-dev,\n python3-numpy,\n\nPackage: dtsd\n libother-dev,\n"
SOFTWARE = "| package | purpose |\n|---|---|\n| libusb-1.0-0-dev, python3-numpy | USB |\n| uplot (browser) | plots |\n"


class DevicePapers(unittest.TestCase):
    def findings(self, software: str) -> list[str]:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        root = Path(folder.name)
        for name, text in (
            ("debian/control", CONTROL),
            ("clients/web/package.json", '{"dependencies": {"uplot": "1"}, "devDependencies": {"vite": "1"}}'),
            ("docs/device/software.md", software),
        ):
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        return device_papers.findings(root)

    def test_CompletePasses(self) -> None:
        self.assertEqual(self.findings(SOFTWARE), [])

    def test_MissingLibrariesAreNamedWithTheirFile(self) -> None:
        self.assertEqual(
            self.findings(SOFTWARE.replace("uplot", "vplot").replace(", python3-numpy", "")),
            [
                "docs/device/software.md: python3-numpy of debian/control is missing",
                "docs/device/software.md: uplot of clients/web/package.json is missing",
            ],
        )


if __name__ == "__main__":
    unittest.main()
