// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "record/session_facts.h"
#include "record/xdf/xdf_writer.h"

namespace dts::fleet::forward {

/// Writes a closed recording with a label and `seconds` of 10 channels at 1000 Hz (80 kB each).
inline record::XdfWriter::Closed write_recording(const std::string& file, const std::string& session, int seconds = 1) {
  record::SessionFacts facts{.session_id = session, .rig = "floor"};
  facts.label = "Frau Weber";
  auto writer = record::XdfWriter::create(file, record::to_facts(facts)).value();
  std::vector<record::ChannelInfo> channels;
  for (int channel = 0; channel < 10; ++channel) channels.push_back({.label = "w" + std::to_string(channel), .unit = "V"});
  const auto raw =
      writer->add_stream({.name = "floor/raw", .content = "DTS", .rate = core::Rate::create(1000, 1).value(), .channels = channels});
  for (int block = 0; block < 5 * seconds; ++block) {
    std::vector<double> values(2000);
    for (std::size_t value = 0; value < values.size(); ++value) values[value] = block + static_cast<double>(value) / 4096.0;
    EXPECT_TRUE(writer->write_samples(raw, 1.0 + 0.2 * block, values, {}));
  }
  return writer->close().value();
}

}  // namespace dts::fleet::forward
