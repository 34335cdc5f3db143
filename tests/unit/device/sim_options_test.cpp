// SPDX-License-Identifier: Apache-2.0
// The tables of options of the simulated devices. What the options do is in sim_outputs/, what is refused in addresses/.
#include <gtest/gtest.h>

#include <fstream>
#include <span>
#include <sstream>
#include <string>

#include "device/sim/chair/chair_options.h"
#include "device/sim/floor_options.h"
#include "device/sim/stack/stack_options.h"
#include "unit/device/sim_rig.h"

namespace dts::device::sim {
namespace {

struct Table {
  const char* uri;
  const char* readme;
  std::span<const UriOption> options;
  std::string (*refusal)(const DeviceUri&);  ///< Empty when it takes the options.
};

template <class Options>
std::string words(const core::Result<Options>& read) {
  return read ? "" : core::to_string(read.error());
}

const std::vector<Table> kTables = {{"sim:floor?", "daemon/device/sim/README.md", floor_option_table(),
                                     [](const DeviceUri& uri) { return words(read_floor_options(uri, 4)); }},
                                    {"sim:chair?", "daemon/device/sim/chair/README.md", chair_option_table(),
                                     [](const DeviceUri& uri) { return words(read_chair_options(uri, 16)); }},
                                    {"sim:stack?", "daemon/device/sim/stack/README.md", stack_option_table(),
                                     [](const DeviceUri& uri) { return words(read_stack_options(uri, test::stack_rig())); }}};

TEST(SimOptions, EveryNumber_RefusedJustOutsideItsRange) {
  for (const Table& table : kTables) {
    for (const UriOption& option : table.options) {
      if (option.kind == OptionKind::Word || option.kind == OptionKind::File || option.kind == OptionKind::Text) continue;
      for (const double outside : {option.minimum - 1.0, option.maximum + 1.0}) {
        if (outside == kNever) continue;
        const std::string uri = table.uri + std::string(option.name) + "=" + std::to_string(outside);
        EXPECT_NE(table.refusal(*DeviceUri::parse(uri)).find(allowed(option)), std::string::npos) << uri;
      }
    }
  }
}

TEST(SimOptions, Readme_ListsEveryOptionWithDefaultAndRange) {
  for (const Table& table : kTables) {
    std::stringstream readme;
    readme << std::ifstream(std::string(DTS_SOURCE_DIR) + "/" + table.readme).rdbuf();
    for (const UriOption& option : table.options) {
      std::string range = allowed(option);
      for (std::size_t bar = range.find('|'); bar != std::string::npos; bar = range.find('|', bar + 2)) range.replace(bar, 1, "\\|");
      const std::string row = "| `" + std::string(option.name) + "` | " + range + " | " + std::string(option.default_text) + " |";
      EXPECT_NE(readme.str().find(row), std::string::npos) << table.readme << " lacks: " << row;
    }
  }
}

}  // namespace
}  // namespace dts::device::sim
