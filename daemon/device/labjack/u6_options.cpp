// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "device/labjack/u6.h"
#include "device/labjack/u6_timing.h"
#include "device/usb/usb_daq.h"

namespace dts::device::labjack {
namespace {

using core::ErrorCode;

constexpr std::size_t kInputs = 16;  // 0 to 13, thermometer, ground
constexpr std::size_t kThermometer = 14;
constexpr const char* kAllInputs = "0,1,2,3,4,5,6,7,8,9,10,11,12,13";

std::vector<UriOption> known_options() {
  std::vector<UriOption> options = usb::common_daq_options();
  options.push_back({"digital", OptionKind::Integer, "0", 0, 1, "",
                     "1: FIO0..7 and EIO0..7 as one more channel, a word sampled with every scan: bit 0 is FIO0."});
  return options;
}

void add_digital_word(usb::DaqOptions& options) {
  const std::size_t at = options.marker ? options.marker->position : options.channels.size();
  options.channels.insert(options.channels.begin() + static_cast<std::ptrdiff_t>(at), kDigitalWord);
  options.ranges_v.insert(options.ranges_v.begin() + static_cast<std::ptrdiff_t>(at), kRangesV[0]);
  if (options.marker) ++options.marker->position;
}

}  // namespace

core::Result<usb::DaqOptions> read_u6_options(const DeviceUri& uri) {
  DeviceUri complete = uri;
  complete.options.try_emplace("channels", kAllInputs);  // not the thermometer and ground
  DTS_TRY_ASSIGN(const auto given, UriOptions::read(complete, known_options()));
  const usb::DaqLimits limits{.inputs = kInputs,
                              .max_scan_length = kMaximumSamplesPerPacket - 1,  // one place is for the digital word
                              .must_ascend = false,
                              .ranges_v = kRangesV};
  DTS_TRY_ASSIGN(auto options, usb::read_daq_options(complete, given, limits));
  if (std::ranges::find(options.channels, kThermometer) != options.channels.end()) {
    return core::fail(ErrorCode::InvalidArgument, "device \"" + uri.text + "\": input 14 is the thermometer inside the U6",
                      "choose inputs 0 to 13, or 15 for ground");
  }
  if (given.number("digital") > 0) add_digital_word(options);
  return options;
}

core::Result<std::unique_ptr<Device>> create_u6(const DeviceUri& uri, const DeviceContext& context) {
  DTS_TRY_ASSIGN(auto options, read_u6_options(uri));
  if (context.usb == nullptr) {
    return core::fail(ErrorCode::Unsupported, "device \"" + uri.text + "\" is on USB, and this program has no access to USB");
  }
  auto driver = std::make_unique<U6>(options);
  return std::make_unique<usb::UsbDaq>(std::move(driver), std::move(options), *context.usb, context.clock);
}

}  // namespace dts::device::labjack
