#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The bill of materials (packaging/): whole, the same for the same input, and nothing left out."""
import base64
import importlib.machinery
import importlib.util
import json
import os
import shutil
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent.parent
PACKAGING = SOURCE / "packaging"
sys.path.insert(0, str(PACKAGING))

import bill
import debian_packages
import npm_packages

loader = importlib.machinery.SourceFileLoader("sbom", str(PACKAGING / "sbom"))
specification = importlib.util.spec_from_loader("sbom", loader)
assert specification
sbom = importlib.util.module_from_spec(specification)
loader.exec_module(sbom)

LIBRARY = debian_packages.Package("libstdc++6", "12.2.0-14", "amd64", "gcc-12")
HEADERS = debian_packages.Package("libcli11-dev", "2.1.2+ds-1", "all", "cli11", "BSD-3-Clause")


def npm_package(folder: Path, name: str = "@scope/thing") -> npm_packages.Package:
    return npm_packages.Package(name, "1.2.3", "MIT", "ab" * 64, folder)


class Document(unittest.TestCase):
    def setUp(self) -> None:
        self.enterContext(unittest.mock.patch.dict(os.environ, {"SOURCE_DATE_EPOCH": "1700000000"}))
        parts = [(LIBRARY, "DYNAMIC_LINK"), (HEADERS, "STATIC_LINK"), (npm_package(Path("/")), "CONTAINS"), (LIBRARY, "BUILD_TOOL_OF")]
        self.parts = [bill.Part(component, relation) for component, relation in parts]
        self.document = json.loads(bill.document("dtsd", "0.1.0", self.parts))

    def test_EveryPartIsAPackageOnce_AndEveryRelationshipHasTwoEnds(self) -> None:
        ids = [package["SPDXID"] for package in self.document["packages"]]
        self.assertEqual(len(ids), len(set(ids)))
        self.assertEqual(len(ids), 4)
        for relation in self.document["relationships"]:
            self.assertLessEqual({relation["spdxElementId"], relation["relatedSpdxElement"]}, {*ids, "SPDXRef-DOCUMENT"})
        for name in ids:
            self.assertRegex(name, r"^SPDXRef-[A-Za-z0-9.-]+$")

    def test_ToolIsTheSubjectOfItsRelationship(self) -> None:
        (tool,) = [each for each in self.document["relationships"] if each["relationshipType"] == "BUILD_TOOL_OF"]
        self.assertEqual(tool["relatedSpdxElement"], "SPDXRef-dtsd")

    def test_PackagesAreNamedAsTheirRegistriesDo(self) -> None:
        locators = {package["name"]: package["externalRefs"][0]["referenceLocator"] for package in self.document["packages"][1:]}
        self.assertEqual(locators["libstdc++6"], "pkg:deb/debian/libstdc%2B%2B6@12.2.0-14?arch=amd64")
        self.assertEqual(locators["@scope/thing"], "pkg:npm/%40scope/thing@1.2.3")

    def test_SameInput_SameBytes_AndTheDateIsTheSources(self) -> None:
        self.assertEqual(bill.document("dtsd", "0.1.0", self.parts), bill.document("dtsd", "0.1.0", self.parts))
        self.assertEqual(self.document["creationInfo"]["created"], "2023-11-14T22:13:20Z")
        other = json.loads(bill.document("dtsd", "0.1.0", self.parts[:2]))
        self.assertNotEqual(other["documentNamespace"], self.document["documentNamespace"])


class Headers(unittest.TestCase):
    """With packages that building needs anyway: cppzmq-dev is headers only, libzmq3-dev belongs to a library."""

    def setUp(self) -> None:
        self.linked = debian_packages.look_up(["libzmq5"])

    def test_DeclaredAndRead_Passes(self) -> None:
        sbom.check_headers(["cppzmq-dev"], {"cppzmq-dev", "libzmq3-dev"}, self.linked, "dtsd")

    def test_ReadButNotDeclared_IsRefused(self) -> None:
        with self.assertRaisesRegex(SystemExit, "contains code of cppzmq-dev"):
            sbom.check_headers([], {"cppzmq-dev", "libzmq3-dev"}, self.linked, "dtsd")

    def test_DeclaredButNotRead_IsRefused(self) -> None:
        with self.assertRaisesRegex(SystemExit, "contains nothing of cppzmq-dev"):
            sbom.check_headers(["cppzmq-dev"], {"libzmq3-dev"}, self.linked, "dtsd")

    def test_LibraryOnAMergedUsr_HasItsOwner(self) -> None:
        self.assertEqual(debian_packages.owners([str(Path("/usr/bin/env").resolve()), "/usr/include/zmq.hpp"]), {"coreutils", "cppzmq-dev"})
        with self.assertRaisesRegex(SystemExit, "no package owns /usr/include/nobody.h"):
            debian_packages.owners(["/usr/include/nobody.h"])


class Npm(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def test_BundledIsWhatIsNotForDevelopment(self) -> None:
        integrity = "sha512-" + base64.b64encode(bytes(64)).decode()
        entry: dict[str, object] = {"version": "1.0.0", "license": "MIT", "integrity": integrity}
        for_development: dict[str, object] = {**entry, "dev": True}
        packages = {"": {}, "node_modules/@a/b": entry, "node_modules/c/node_modules/d": entry, "node_modules/vite": for_development}
        (self.folder / "package-lock.json").write_text(json.dumps({"packages": packages}))

        found = npm_packages.bundled(self.folder / "package-lock.json")

        self.assertEqual([package.name for package in found], ["@a/b", "d"])
        self.assertEqual(found[0].checksum, "00" * 64)

    def test_DashboardHasItsPackages(self) -> None:
        """Those that package.json asks for, at least."""
        wanted = json.loads((SOURCE / "clients/web/package.json").read_text())["dependencies"]
        found = npm_packages.bundled(SOURCE / "clients/web/package-lock.json")
        self.assertLessEqual(wanted.items(), {package.name: package.version for package in found}.items())

    def test_NoticeIsTheLicenceFile_ElseWhatSourcesSay_ElseRefused(self) -> None:
        package = npm_package(self.folder)
        (self.folder / "index.js").write_text("let x = 1;\n")
        with self.assertRaisesRegex(SystemExit, "names no licence"):
            package.notice
        (self.folder / "index.js").write_text("// Copyright 2020 Somebody\n// As is.\nlet x = 1;\n")
        self.assertEqual(package.notice, "// Copyright 2020 Somebody\n// As is.\n")
        (self.folder / "LICENSE").write_text("Copyright (c) Somebody\n")
        self.assertEqual(package.notice, "Copyright (c) Somebody\n")


if __name__ == "__main__":
    unittest.main()
