// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>

#include "device/replay/replay_device.h"
#include "device/uri_options.h"

namespace dts::device::replay {
namespace {

constexpr double kSlowest = 0.1;
constexpr double kFastest = 100.0;

constexpr std::array<UriOption, 2> kOptions{{
    {.name = "speed",
     .kind = OptionKind::Text,
     .default_text = "1",
     .sentence = "0.1 to 100 times the recorded speed; max: as fast as dtsd can process it."},
    {.name = "loop", .kind = OptionKind::Word, .default_text = "0", .choices = "0|1", .sentence = "1: repeat forever; 0: play once."},
}};

core::Result<std::optional<double>> parse_speed(const DeviceUri& uri, const std::string& text) {
  if (text == "max") return std::optional<double>();
  double speed = 0.0;
  const auto [stopped_at, error] = std::from_chars(text.data(), text.data() + text.size(), speed);
  const bool is_number = error == std::errc{} && stopped_at == text.data() + text.size();
  if (is_number && speed >= kSlowest && speed <= kFastest) return std::optional(speed);
  return core::fail(core::ErrorCode::InvalidArgument,
                    "device \"" + uri.text + "\": speed = \"" + text + "\" is not allowed; allowed: 0.1..100 or max");
}

}  // namespace

core::Result<std::unique_ptr<Device>> create_replay(const DeviceUri& uri, const DeviceContext& context) {
  DTS_TRY_ASSIGN(const auto options, UriOptions::read(uri, kOptions));
  DTS_TRY_ASSIGN(const auto speed, parse_speed(uri, options.text("speed")));
  if (uri.name.empty()) {
    return core::fail(core::ErrorCode::InvalidArgument, "device \"" + uri.text + "\": the file is missing",
                      "write replay:/path/to/recording.xdf");
  }
  auto recording = record::Recording::open(uri.name);
  if (!recording) {
    return core::fail(recording.error().code, "device \"" + uri.text + "\": " + recording.error().what, recording.error().hint);
  }
  DTS_TRY_ASSIGN(auto recorded, find_device(**recording, uri.text));
  DTS_TRY(find_first_scan(**recording, recorded));
  return std::make_unique<ReplayDevice>(std::move(recorded), std::move(*recording),
                                        PlayOptions{.speed = speed, .loops = options.text("loop") == "1"}, context.clock);
}

}  // namespace dts::device::replay
