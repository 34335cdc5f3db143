// SPDX-License-Identifier: Apache-2.0
#include "pipeline/input_check.h"

#include <string>

namespace dts::pipeline {

core::Status check_input(std::string_view stage, const core::StreamFormat& input, std::size_t max_scans, std::string_view unit) {
  const std::string where = "stage " + std::string(stage) + ": ";
  if (input.channels.empty() || input.channels.size() > core::kMaxChannels) {
    return core::fail(core::ErrorCode::InvalidArgument, where + "the input has " + std::to_string(input.channels.size()) +
                                                            " channels; it needs 1 to " + std::to_string(core::kMaxChannels));
  }
  if (max_scans < 1 || max_scans > core::kMaxBlockScans) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      where + "blocks of " + std::to_string(max_scans) + " scans are outside 1 to " + std::to_string(core::kMaxBlockScans));
  }
  for (const core::ChannelFormat& channel : input.channels) {
    if (unit.empty() || channel.unit == unit) continue;
    return core::fail(core::ErrorCode::InvalidArgument,
                      where + "channel '" + channel.name + "' is in '" + channel.unit + "', not in '" + std::string(unit) + "'",
                      "check the order of the stages");
  }
  return {};
}

}  // namespace dts::pipeline
