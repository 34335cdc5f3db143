// SPDX-License-Identifier: Apache-2.0
#include "board/fake_board_device.h"

#include <stdexcept>
#include <utility>

#include "device/board/board_options.h"

namespace dts::test {

std::unique_ptr<device::Device> make_fake_board_device(std::string_view uri, core::Clock& clock) {
  const auto parsed = device::DeviceUri::parse(uri);
  if (!parsed) throw std::invalid_argument(core::to_string(parsed.error()));
  auto options = device::board::read_board_options(*parsed, parsed->scheme == "serial");
  if (!options) throw std::invalid_argument(core::to_string(options.error()));
  FakeBoardSetup setup;
  setup.speaks_lines = options->speaks_lines;
  setup.channels = options->description.channels.size();
  setup.has_counter = options->lines.first_column == device::board::FirstColumn::Counter;
  setup.has_time = options->lines.first_column == device::board::FirstColumn::TimeUs;
  setup.counter_bits = options->lines.counter_bits;
  setup.clock_ppm = 40.0;
  if (options->marker) setup.constant_channel = static_cast<int>(*options->marker);
  if (parsed->name.find("gapping") != std::string::npos) setup.loses_at_s = 0.5;
  auto link = std::make_unique<OwnedFakeLink>(std::move(setup), clock);
  if (parsed->name.find("unplugging") != std::string::npos) link->link().unplug_at_s = 0.5;
  return std::make_unique<device::board::BoardDevice>(std::move(*options), std::move(link), clock);
}

}  // namespace dts::test
