# SPDX-License-Identifier: Apache-2.0
"""Builds the examples of libdts outside of this tree, in each of the three ways that its README names, and runs them with a real dtsd."""
import os
import re
import shlex
import shutil
import subprocess
import threading
import unittest
from pathlib import Path

from support import PATIENCE_S, SOURCE, DaemonProcess

BUILD = Path(os.environ["DTS_BUILD_DIR"])
COMPILER = os.environ["DTS_COMPILER"]
LIBDTS = SOURCE / "clients" / "libdts"
EXAMPLES = LIBDTS / "examples"
WORK = BUILD / "tests" / "library"  # always the same path: the compiler cache finds what an earlier run compiled
PREFIX = WORK / "a prefix"  # a space in the name, which dts.pc and the CMake package must stand
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
USERS_PROJECT = f"""cmake_minimum_required(VERSION 3.24)
project(users_project LANGUAGES CXX)
add_subdirectory("{SOURCE}" dts)
add_executable(print_cop "{EXAMPLES}/print_cop.cpp")
target_link_libraries(print_cop PRIVATE dts::dts)
get_directory_property(tests DIRECTORY "{SOURCE}" TESTS)
if(TARGET dtsd OR tests)
  message(FATAL_ERROR "the programs or the tests of dtsd are in the user's project")
endif()
"""


def run(*command: str | Path, environment: dict[str, str] | None = None, folder: Path | None = None) -> str:
    done = subprocess.run(command, cwd=folder, env={**os.environ, **(environment or {})}, timeout=15 * PATIENCE_S, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout}\n{done.stderr}")
    return done.stdout


def emptied(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def built_by_cmake(project: Path, folder: Path, *options: str) -> Path:
    cached = [f"-DCMAKE_CXX_COMPILER_LAUNCHER={os.environ['DTS_CCACHE']}"] if os.environ["DTS_CCACHE"] not in ("", "CCACHE-NOTFOUND") else []
    run("cmake", "-G", "Ninja", "-S", project, "-B", emptied(folder), f"-DCMAKE_CXX_COMPILER={COMPILER}", *cached, *options)
    run("cmake", "--build", folder, "-j", "2")
    return folder


def installed_library() -> Path:
    (library,) = PREFIX.glob("lib*/**/libdts.so")
    return library


def setUpModule() -> None:
    emptied(PREFIX)
    run("cmake", "--install", BUILD, "--prefix", PREFIX.name, "--component", "libdts", folder=WORK)  # a relative prefix


class Uses(unittest.TestCase):
    """Each program is a client of one daemon, on whose plate a simulated person stands."""

    daemon: DaemonProcess

    @classmethod
    def setUpClass(cls) -> None:
        cls.daemon = DaemonProcess()
        cls.addClassCleanup(cls.daemon.close)

    def check_prints_cop(self, program: Path, environment: dict[str, str] | None = None) -> None:
        running = subprocess.Popen([program], env={**self.daemon.environment, **(environment or {})}, stdout=subprocess.PIPE, text=True)
        deadline = threading.Timer(2 * PATIENCE_S, running.kill)
        deadline.start()
        try:
            assert running.stdout is not None
            for line in running.stdout:
                if re.fullmatch(r"scan \d+: right -?[\d.]+ mm\n", line):
                    return
            self.fail(f"{program} ended before it printed a COP")
        finally:
            deadline.cancel()
            running.kill()
            running.communicate()

    def test_FindPackage(self) -> None:
        # requirement: LIB-2
        folder = built_by_cmake(EXAMPLES, WORK / "find_package", f"-DCMAKE_PREFIX_PATH={PREFIX}")

        self.check_prints_cop(folder / "print_cop")
        file = run(folder / "record_session", "floor", "0.5", environment=self.daemon.environment).strip()

        self.assertEqual(Path(file).read_bytes()[:4], b"XDF:")

    def test_PkgConfigAndTheCompilerAlone(self) -> None:
        # requirement: LIB-2
        folder = emptied(WORK / "pkg_config")
        paths = {"PKG_CONFIG_PATH": str(installed_library().parent / "pkgconfig")}
        flags = shlex.split(run("pkg-config", "--cflags", "--libs", "dts", environment=paths))

        run(COMPILER, "-std=c++20", EXAMPLES / "print_cop.cpp", "-o", folder / "print_cop", *flags)

        self.check_prints_cop(folder / "print_cop", {"LD_LIBRARY_PATH": str(installed_library().parent)})
        self.assertEqual(run("pkg-config", "--modversion", "dts", environment=paths).strip(), os.environ["DTS_VERSION"])

    def test_AddSubdirectoryBuildsTheLibraryOnly(self) -> None:
        # requirement: LIB-2
        project = emptied(WORK / "users_project")
        (project / "CMakeLists.txt").write_text(USERS_PROJECT)

        folder = built_by_cmake(project, WORK / "add_subdirectory", "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=24")

        self.check_prints_cop(folder / "print_cop")
        run("cmake", "--install", folder, "--prefix", emptied(WORK / "nothing"))
        self.assertEqual(list((WORK / "nothing").iterdir()), [])


class Installed(unittest.TestCase):
    def test_OnlyTheInterfaceIsExported(self) -> None:
        lines = run("nm", "--dynamic", "--defined-only", "--demangle", installed_library()).splitlines()
        exported = [line.split(maxsplit=2)[2] for line in lines]

        ours = re.compile(r"(?:(?:typeinfo|typeinfo name|vtable) for )?dts::(?:client|v1)::|(?:descriptor_table|TableStruct)_dts_|DTS_0$")
        self.assertEqual([name for name in exported if not ours.match(name)], [])
        self.assertEqual([name for name in exported if "Implementation::" in name or "Inbox" in name], [])
        self.assertIn("dts::client::find_endpoints", "\n".join(exported))
        self.assertIn("dts::v1::StatusSnapshot::ByteSizeLong", "\n".join(exported))

    def test_NameHasTheNumberOfTheAbi(self) -> None:
        soname = re.search(r"SONAME.*\[(.*)\]", run("readelf", "-d", installed_library()))

        assert soname
        self.assertEqual(soname.group(1), "libdts.so.0")
        self.assertEqual((installed_library().parent / soname.group(1)).readlink(), Path("libdts.so.0." + os.environ["DTS_VERSION"].split(".")[1]))

    def test_EachHeaderCompilesAloneWithoutWarnings(self) -> None:
        headers = sorted((PREFIX / "include" / "dts").glob("*.h"))
        self.assertEqual({header.name for header in headers}, {header.name for header in (LIBDTS / "include" / "dts").glob("*.h")})

        flags = run("pkg-config", "--cflags", "protobuf").split()
        for header in headers:  # -isystem: the generated messages have warnings of their own
            source = emptied(WORK / "header") / "header.cpp"
            source.write_text(f'#include "dts/{header.name}"\n')
            run(COMPILER, "-std=c++20", "-fsyntax-only", *WARNINGS, "-I", LIBDTS / "include", "-isystem", PREFIX / "include", *flags, source)

    def test_ReadmeShowsTheExample(self) -> None:
        (program,) = re.findall(r"```cpp\n(.*?)```", (LIBDTS / "README.md").read_text(), re.DOTALL)
        licence, example = (EXAMPLES / "print_cop.cpp").read_text().split("\n", maxsplit=1)

        self.assertIn("Apache-2.0", licence)
        self.assertEqual(program, example)


if __name__ == "__main__":
    unittest.main()
