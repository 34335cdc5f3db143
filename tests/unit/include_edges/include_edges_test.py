#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Shows on small made-up trees that the walk finds what it must find, and nothing else."""

import contextlib
import io
import pathlib
import tempfile
import unittest
import unittest.mock

import include_edges

LICENCE = "// SPDX-License-Identifier: Apache-2.0\n"


class TreeTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "daemon").mkdir()

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def edges(self, path, *includes):
        """The findings for one file, which is gone afterwards."""
        self.write(path, LICENCE + "".join(f"#include {include}\n" for include in includes))
        findings = include_edges.forbidden_edges(self.root)
        (self.root / path).unlink()
        return findings


class EdgesTest(TreeTest):
    def assert_forbidden(self, path, include):
        findings = self.edges(path, include)
        self.assertEqual(len(findings), 1, findings)
        self.assertTrue(findings[0].startswith(f"{path}:2: "), findings)

    def assert_allowed(self, path, *includes):
        self.assertEqual(self.edges(path, *includes), [])

    def test_standard_and_posix_headers_are_allowed_everywhere(self):
        self.assert_allowed("daemon/core/a.cpp", "<vector>", "<cstdint>", "<poll.h>", "<sys/eventfd.h>")
        self.assert_allowed("clients/ctl/a.cpp", "<string_view>", "<unistd.h>")

    def test_own_room_is_allowed(self):
        self.assert_allowed("daemon/pipeline/stages/cop.cpp", '"pipeline/stage.h"', '"pipeline/stages/cop.h"')

    def test_header_beside_the_file_is_allowed(self):
        self.write("clients/ctl/command.h", LICENCE)
        self.assert_allowed("clients/ctl/main.cpp", '"command.h"')

    def test_edges_that_point_upwards_are_found(self):
        self.assert_forbidden("daemon/core/a.h", '"physics/plate/plate.h"')
        self.assert_forbidden("daemon/device/device.h", '"pipeline/stage.h"')
        self.assert_forbidden("daemon/pipeline/a.cpp", '"ipc/publisher.h"')
        self.assert_forbidden("daemon/session/a.cpp", '"app/config.h"')

    def test_angle_brackets_do_not_hide_an_edge(self):
        self.assert_forbidden("daemon/pipeline/a.cpp", "<ipc/publisher.h>")

    def test_spaces_do_not_hide_an_edge(self):
        self.write("daemon/core/a.h", LICENCE + '  #  include   "app/config.h"  // why not\n')
        self.assertEqual(len(include_edges.forbidden_edges(self.root)), 1)

    def test_each_finding_names_file_and_line(self):
        self.write("daemon/core/a.h", LICENCE + '\n#include <vector>\n#include "app/config.h"\n#include "ipc/x.h"\n')
        findings = include_edges.forbidden_edges(self.root)
        self.assertEqual([finding.split(" ")[0] for finding in findings], ["daemon/core/a.h:4:", "daemon/core/a.h:5:"])

    def test_third_party_is_bound_to_its_place(self):
        self.assert_allowed("daemon/core/log.cpp", "<spdlog/spdlog.h>")
        self.assert_forbidden("daemon/core/log.h", "<spdlog/spdlog.h>")
        self.assert_forbidden("daemon/core/log.h", "<fmt/format.h>")

    def test_third_party_of_another_room_is_found(self):
        self.assert_allowed("daemon/ipc/a.cpp", "<zmq.hpp>", '"dts/v1/stream.pb.h"')
        self.assert_forbidden("daemon/record/a.cpp", "<zmq.hpp>")

    def test_prefix_of_a_file_name_is_no_permission(self):
        self.assert_forbidden("daemon/ipc/a.cpp", "<zmq_addon.hpp>")
        self.assert_forbidden("daemon/core/result.hpp", "<tl/expected.hpp>")

    def test_subfolder_may_more_than_its_room(self):
        self.assert_allowed("daemon/record/xdf/a.cpp", "<pugixml.hpp>", "<nlohmann/json.hpp>")
        self.assert_forbidden("daemon/record/a.cpp", "<pugixml.hpp>")

    def test_room_within_a_divided_room_has_only_its_own_row(self):
        self.assert_allowed("daemon/device/sim/a.cpp", '"sim/daq.h"', '"device/device.h"', '"device/sim/scene.h"')
        self.assert_forbidden("daemon/device/a.cpp", '"physics/plate/plate.h"')
        self.assert_forbidden("daemon/device/sim/a.cpp", "<libusb-1.0/libusb.h>")

    def test_arrow_up_within_a_divided_room_is_found(self):
        self.assert_forbidden("daemon/device/device.h", '"device/usb/usb_bus.h"')
        self.assert_forbidden("daemon/device/sim/a.cpp", '"device/registry.h"')
        self.assert_forbidden("clients/lab/reach/a.cpp", '"lab/command_tree.h"')
        self.assert_forbidden("clients/lab/base/a.cpp", '"lab/reach/trial_set.h"')

    def test_arrow_between_rooms_side_by_side_is_found(self):
        self.assert_forbidden("daemon/device/mcc/a.cpp", '"device/labjack/u6.h"')
        self.assert_forbidden("clients/lab/cop/a.cpp", '"lab/plate/plate_case.h"')

    def test_unlisted_room_within_a_divided_room_is_found(self):
        self.assert_forbidden("clients/lab/new/a.cpp", '"lab/base/csv.h"')

    def test_row_of_a_name_covers_header_and_source(self):
        self.assert_allowed("daemon/device/registry.cpp", '"device/mcc/entries.h"')
        self.assert_allowed("daemon/device/registry.h", '"device/mcc/entries.h"')
        self.assert_forbidden("daemon/device/registry_other.h", '"device/mcc/entries.h"')

    def test_clients_see_the_library_but_not_the_daemon(self):
        self.assert_allowed("clients/ctl/a.cpp", "<dts/client.h>", "<CLI/CLI.hpp>", '"dts/v1/control.pb.h"')
        self.assert_forbidden("clients/ctl/a.cpp", '"core/rate.h"')
        self.assert_forbidden("clients/libdts/include/dts/client.h", '"core/result.h"')

    def test_c_header_with_a_cpp_name_is_found(self):
        self.assert_forbidden("daemon/core/a.h", "<stdint.h>")

    def test_ways_around_the_table_are_found(self):
        self.assert_forbidden("daemon/core/a.h", '"../app/config.h"')
        self.assert_forbidden("daemon/core/a.h", "HEADER_OF_THE_DAY")

    def test_unlisted_room_is_found(self):
        self.assert_forbidden("daemon/util/a.h", "<vector>")

    def test_code_outside_of_a_room_is_found(self):
        self.write("daemon/a.cpp", LICENCE)
        self.assertEqual(include_edges.forbidden_edges(self.root), ["daemon/a.cpp:1: code outside of a room"])

    def test_foreign_packages_are_skipped(self):
        self.assert_allowed("clients/web/node_modules/x/a.cpp", '"app/config.h"')


class RulesTest(TreeTest):
    def test_missing_licence_line_is_found(self):
        self.write("daemon/core/CMakeLists.txt", "dts_library(core)\n")
        self.write("proto/dts/v1/a.proto", 'syntax = "proto3";\n')
        self.assertEqual(len(include_edges.faults_of_files(self.root)), 2)

    def test_licence_line_may_follow_the_interpreter(self):
        self.write("scripts/demo.py", "#!/usr/bin/env python3\n# SPDX-License-Identifier: Apache-2.0\n")
        self.assertEqual(include_edges.faults_of_files(self.root), [])

    def test_room_with_code_needs_a_readme(self):
        self.write("daemon/core/sub/a.cpp", LICENCE)
        self.assertEqual(include_edges.faults_of_readmes(self.root), ["daemon/core:1: no README.md"])
        self.write("daemon/core/README.md", "\n" * 100)
        self.assertEqual(include_edges.faults_of_readmes(self.root), [])


class TableTest(TreeTest):
    def write_tables(self):
        for folder in ("daemon", "clients"):
            rooms = include_edges.rooms_of(folder)
            edges = include_edges.edges_of_rooms()
            rows = [f"| `{room}` | what it is for | {include_edges.edges_text(edges[room])} |" for room in rooms]
            self.write(f"{folder}/README.md", "\n".join(rows) + "\n")


class HouseTest(TableTest):
    def test_house_has_no_arrow_up(self):
        self.assertEqual(include_edges.arrows_up(self.root), [])

    def test_arrow_up_in_house_is_found(self):
        rows = [("daemon/core", ["physics"], []), ("daemon/physics", ["core"], [])]
        with unittest.mock.patch.object(include_edges, "HOUSE", rows):
            self.assertEqual(include_edges.arrows_up(self.root), ["HOUSE: daemon/core may not include physics, which is not below it"])

    def test_table_in_a_readme_says_what_house_says(self):
        self.write_tables()
        self.assertEqual(include_edges.faults_of_room_tables(self.root), [])
        text = (self.root / "daemon/README.md").read_text(encoding="utf-8")
        self.write("daemon/README.md", text.replace("| `core`, `physics` |", "| `core` |"))
        self.assertEqual(include_edges.faults_of_room_tables(self.root), ["daemon/README.md:1: `sim` may include `core`, `physics`, not `core`"])
        self.write("daemon/README.md", text + "| `util` | what it is for | nothing of ours |\n")
        self.assertEqual(include_edges.faults_of_room_tables(self.root), ["daemon/README.md:1: there is no room `util`"])
        self.write("daemon/README.md", "")
        self.assertIn("daemon/README.md:1: no row for the room `core`", include_edges.faults_of_room_tables(self.root))


class MainTest(TableTest):
    def run_main(self, *arguments):
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(io.StringIO()):
            return include_edges.main(list(arguments)), output.getvalue()

    def test_exit_status_tells_the_outcome(self):
        self.write_tables()
        self.write("daemon/core/a.h", LICENCE + "#include <vector>\n")
        self.assertEqual(self.run_main("edges", str(self.root)), (0, ""))
        self.write("daemon/core/a.h", LICENCE + '#include "app/config.h"\n')
        status, output = self.run_main("edges", str(self.root))
        self.assertEqual(status, 1)
        self.assertIn("daemon/core/a.h:2: app/config.h", output)

    def test_tree_without_code_is_not_success(self):
        self.assertEqual(self.run_main("edges", str(self.root)), (2, ""))

    def test_wrong_use_is_not_success(self):
        for arguments in ([], ["edges"], ["walls", str(self.root)], ["edges", str(self.root / "nowhere")]):
            self.assertEqual(self.run_main(*arguments)[0], 2)


if __name__ == "__main__":
    unittest.main()
