// SPDX-License-Identifier: Apache-2.0
#include "device/board/board_options.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "core/number_text.h"
#include "core/utf8.h"

namespace dts::device::board {
namespace {

using core::ErrorCode;
using core::number_text;
using enum OptionKind;

constexpr double kLargestValue = 1e9;
constexpr double kRangeTolerance = 1e-6;  // of the range: a float against a decimal
constexpr double kResolutionTolerance = 0.01;

tl::unexpected<core::Error> refuse(const DeviceUri& uri, const std::string& why, std::string hint = {}) {
  return core::fail(ErrorCode::InvalidArgument, "device \"" + uri.text + "\": " + why, std::move(hint));
}

core::Status check_dependencies(const DeviceUri& uri, const UriOptions& given) {
  const bool speaks_lines = given.text("format") == "lines";
  if (given.number("channels") < 1.0) {
    return refuse(uri, "channels=N is missing", "write the number of channels of the board: dtsd describes the device before it sees it");
  }
  if (speaks_lines && given.number("rate_hz") <= 0.0) {
    return refuse(uri, "rate_hz=HZ is missing", "write how many lines the board sends per second; lines do not say it");
  }
  for (const std::string_view option : {"counter", "counter_bits", "time_us"}) {
    if (given.is_given(option) && !speaks_lines) return refuse(uri, std::string(option) + " has an effect only with format=lines");
  }
  if (given.is_given("marker") && speaks_lines) return refuse(uri, "marker has an effect only with format=frames");
  if (given.number("counter") > 0.0 && given.number("time_us") > 0.0) {
    return refuse(uri, "counter=1 and time_us=1 exclude each other", "the first column of a line is one of them");
  }
  if (given.is_given("counter_bits") && given.number("counter") <= 0.0)
    return refuse(uri, "counter_bits has an effect only with counter=1");
  if (given.number("marker") >= given.number("channels")) {
    return refuse(
        uri, "marker=" + number_text(given.number("marker")) + " is not one of the " + number_text(given.number("channels")) + " channels",
        "channels count from 0");
  }
  if (given.number("marker") == 0.0) return refuse(uri, "marker=0 is not possible: the first channel is a sensor");
  return {};
}

core::Status read_range(const DeviceUri& uri, const UriOptions& given, LineShape& shape) {
  shape.lowest = 0.0;
  shape.highest = 5.0;
  if (!given.is_given("range")) return {};
  const std::vector<double>& range = given.numbers("range");
  if (range.size() != 2 || !(range[0] < range[1])) {
    return refuse(uri, "range needs the lowest and the highest value", "write range=0,5");
  }
  shape.lowest = range[0];
  shape.highest = range[1];
  return {};
}

tl::unexpected<core::Error> differs(const BoardOptions& options, const std::string& board, const std::string& address, std::string hint) {
  return core::fail(ErrorCode::InvalidArgument,
                    "cannot open " + options.description.uri + ": the board has " + board + ", the address says " + address,
                    std::move(hint));
}

std::string text_of(const Channel& channel) {
  return " on channel " + std::to_string(channel.index) + " (" + core::printable(channel.name.view()) + ")";
}

core::Status check_channel(const BoardOptions& options, const Channel& channel) {
  const ChannelDescription& described = options.description.channels[channel.index];
  if (!channel.is_digital && channel.unit.view() != described.unit) {
    const std::string unit = core::printable(channel.unit.view());
    return differs(options, "the unit '" + unit + "'" + text_of(channel), "unit=" + described.unit, "write unit=" + unit);
  }
  const double one_end = channel.value(channel.lowest);
  const double other_end = channel.value(channel.highest);
  const double lowest = std::min(one_end, other_end);
  const double highest = std::max(one_end, other_end);
  const double tolerance = kRangeTolerance * (described.maximum - described.minimum);
  if (!(lowest >= described.minimum - tolerance && highest <= described.maximum + tolerance)) {
    const std::string range = number_text(lowest) + "," + number_text(highest);
    return differs(options, "the range " + range + text_of(channel),
                   "range=" + number_text(described.minimum) + "," + number_text(described.maximum), "write a range that contains both");
  }
  const double step = std::abs(static_cast<double>(channel.scale));
  const bool has_resolution = described.resolution > 0.0 && !channel.is_digital && !channel.is_constant;
  if (has_resolution && std::abs(step - described.resolution) > kResolutionTolerance * described.resolution) {
    return differs(options, "steps of " + number_text(step) + text_of(channel), "resolution=" + number_text(described.resolution),
                   "write resolution=" + number_text(step));
  }
  if (options.marker == channel.index && !channel.is_constant) {
    return differs(options, "no constant code" + text_of(channel), "marker=" + std::to_string(channel.index),
                   "remove marker, or let the board send a constant code there");
  }
  return {};
}

}  // namespace

std::vector<UriOption> board_options(bool is_serial_port) {
  std::vector<UriOption> options = {
      {"format", Word, "frames", 0, 0, "frames|lines", "What the board sends: frames with checksum and counter, or lines of numbers."},
      {"channels", Integer, "0", 0, 32, "", "Number of channels of the board; needed."},
      {"rate_hz", Number, "0", 0, kHighestRateHz, "", "Scans per second; needed for lines. 0: the rate that the rig asks for."},
      {"serial", Text, "", 0, 0, "", "Serial number of the board or of its USB adapter; any other board is rejected."},
      {"unit", Text, "V", 0, 0, "", "Unit of the values."},
      {"range", Numbers, "", -kLargestValue, kLargestValue, "", "Lowest and highest value of every channel; default: 0,5."},
      {"resolution", Number, "0", 0, kLargestValue, "", "Size of one code of the converter; 0: unknown."},
      {"marker", Integer, "-1", -1, 31, "", "Channel with a constant code, from 0: it shows at once when channels are rotated. -1: none."},
      {"counter", Integer, "0", 0, 1, "", "1: the first column of a line counts the scans, so every loss is exact."},
      {"counter_bits", Integer, "32", 16, 32, "", "Size of that counter: 16 or 32."},
      {"time_us", Integer, "0", 0, 1, "", "1: the first column of a line is the board's time in us (32 bits)."},
  };
  if (is_serial_port) options.push_back({"baud", Integer, "115200", 300, 12'000'000, "", "Speed of the serial line, bit/s."});
  return options;
}

core::Result<BoardOptions> read_board_options(const DeviceUri& uri, bool is_serial_port) {
  DTS_TRY_ASSIGN(const auto given, UriOptions::read(uri, board_options(is_serial_port)));
  DTS_TRY(check_dependencies(uri, given));
  BoardOptions options;
  options.speaks_lines = given.text("format") == "lines";
  options.serial = given.text("serial");
  if (is_serial_port) options.baud = static_cast<std::uint32_t>(given.number("baud"));
  if (given.number("marker") > 0.0) options.marker = static_cast<std::size_t>(given.number("marker"));
  LineShape& shape = options.lines;
  shape.channels = static_cast<std::size_t>(given.number("channels"));
  if (given.number("counter") > 0.0) shape.first_column = FirstColumn::Counter;
  if (given.number("time_us") > 0.0) shape.first_column = FirstColumn::TimeUs;
  shape.counter_bits = static_cast<unsigned>(given.number("counter_bits"));
  if (shape.counter_bits != 16 && shape.counter_bits != 32) return refuse(uri, "counter_bits must be 16 or 32");
  DTS_TRY(read_range(uri, given, shape));

  DeviceDescription& description = options.description;
  description.uri = uri.text;
  description.model = options.speaks_lines ? "Board that sends lines" : "Board that sends frames";
  description.serial = options.serial;
  const double rate_hz = given.number("rate_hz");
  if (rate_hz > 0.0 && rate_hz < kLowestRateHz) return refuse(uri, "rate_hz must be 1 to 20000");
  description.minimum_rate_hz = rate_hz > 0.0 ? rate_hz : kLowestRateHz;
  description.maximum_rate_hz = rate_hz > 0.0 ? rate_hz : kHighestRateHz;
  const std::string unit = given.is_given("unit") ? given.text("unit") : "V";
  for (std::size_t i = 0; i < shape.channels; ++i) {
    const ChannelRole role = options.marker == i ? ChannelRole::Marker : ChannelRole::Sensor;
    description.channels.push_back({"ch" + std::to_string(i), unit, role, shape.lowest, shape.highest, given.number("resolution")});
  }
  return options;
}

core::Status check_agreement(const BoardOptions& options, const BoardFacts& facts) {
  const std::size_t wanted = options.description.channels.size();
  if (facts.channels().size() != wanted) {
    const std::string found = std::to_string(facts.channels().size());
    return differs(options, found + " channels", "channels=" + std::to_string(wanted), "write channels=" + found);
  }
  for (const Channel& channel : facts.channels()) DTS_TRY(check_channel(options, channel));
  return {};
}

}  // namespace dts::device::board
