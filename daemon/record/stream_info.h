// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/rate.h"

namespace dts::record {

/// Type of a stream's values in the file; XDF's `channel_format`.
enum class ValueType : std::uint8_t { Float32, Double64, Int8, Int16, Int32, Int64, Text };

/// One column of a recorded stream.
struct ChannelInfo {
  std::string label;        ///< "w1_v", "ml_mm"
  std::string unit;         ///< "V"; empty for texts.
  std::string type;         ///< XDF wiki: "Voltage", "Position", "Force", ...
  int device_channel = -1;  ///< Channel of the DAQ; -1: computed. Replay uses it to put each column back on its device channel.
  double minimum = 0.0;     ///< Range and step of the converter, in `unit`; 0, 0, 0: unknown.
  double maximum = 0.0;
  double resolution = 0.0;
  bool is_sensor = false;  ///< A displacement sensor of the plate; false: an auxiliary or computed channel.
  bool is_marker = false;  ///< The marker channel of the device.

  friend bool operator==(const ChannelInfo&, const ChannelInfo&) = default;
};

/// Content of a stream's header. `facts` are named texts under <desc> that replay, or the reader of a paper, needs.
struct StreamInfo {
  std::string name;     ///< "floor/cop": also the topic on the data bus.
  std::string content;  ///< XDF's `type`: "DTS", "Markers", "Quality".
  ValueType value_type = ValueType::Double64;
  std::optional<core::Rate> rate;  ///< Exact rate; absent: irregular stream.
  std::vector<ChannelInfo> channels;
  std::int64_t delay_ns = 0;  ///< Group delay of the filters; time stamps are not corrected for it.
  std::vector<std::pair<std::string, std::string>> facts{};

  friend bool operator==(const StreamInfo&, const StreamInfo&) = default;
};

/// Returns the value of a fact, or an empty text.
[[nodiscard]] std::string fact(const std::vector<std::pair<std::string, std::string>>& facts, const std::string& name);

/// Returns the name without the rig: "cop" of "floor/cop".
[[nodiscard]] std::string short_name(const std::string& stream);

}  // namespace dts::record
