// SPDX-License-Identifier: Apache-2.0
// What an address becomes. addresses/ has the addresses, and behind each what the device says of itself, or why there is none.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "sim/chair_rig.h"
#include "support/committed_text.h"
#include "unit/device/description_text.h"
#include "unit/device/sim_rig.h"
#include "usb/fake/fake_bus.h"

namespace dts::device {
namespace {

class Address : public testing::TestWithParam<const char*> {};

std::string indented(std::string text) {
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', end + 1)) text.insert(end + 1, "    ");
  return text;
}

TEST_P(Address, EachOfTheFile_IsDescribedOrRefusedAsItSays) {
  const std::string file = std::string("unit/device/addresses/") + GetParam() + ".txt";
  std::string found;
  bool has_usb = true;
  for (const std::string& line : dts::test::lines_of(dts::test::content_of(dts::test::committed_file(file)))) {
    if (line.starts_with("    ")) continue;
    found += line + "\n";
    if (line.starts_with("#")) has_usb = line.find("without USB") == std::string::npos;
    if (line.empty() || line.starts_with("#")) continue;
    core::VirtualClock clock;
    emulator::FakeBus bus(clock);
    const physics::RigModel rig = line.starts_with("sim:chair")   ? dts::sim::chair_rig()
                                  : line.starts_with("sim:stack") ? test::stack_rig()
                                                                  : test::floor_rig();
    const auto created = create_device(line, {clock, rig, has_usb ? &bus : nullptr});
    found += created ? test::text_of((*created)->describe(), "    ")
                     : "    " + std::string(core::name(created.error().code)) + ": " + indented(core::to_string(created.error())) + "\n";
  }
  dts::test::expect_committed(file, found, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Files, Address,
                         testing::Values("no_device", "without_usb", "mcc", "pair", "labjack", "ni", "board", "replay", "floor", "chair",
                                         "stack"),
                         [](const auto& file) { return std::string(file.param); });

}  // namespace
}  // namespace dts::device
