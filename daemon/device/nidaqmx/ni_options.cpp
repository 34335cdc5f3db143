// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <utility>

#include "core/block.h"
#include "device/nidaqmx/ni_daqmx.h"
#include "device/uri_options.h"

namespace dts::device::nidaqmx {
namespace {

using core::ErrorCode;
using enum OptionKind;

constexpr std::array kTerminals = {std::pair{"rse", api::kTerminalRse}, std::pair{"nrse", api::kTerminalNrse},
                                   std::pair{"differential", api::kTerminalDifferential}, std::pair{"default", api::kTerminalDefault}};

constexpr std::array kOptions = {
    UriOption{"channels", Numbers, "", 0, 255, "", "Analogue inputs in scan order; default: 0,1,2,3."},
    UriOption{"terminal", Word, "rse", 0, 0, "rse|nrse|differential|default", "How the inputs are wired; default: NI-DAQmx chooses."},
    UriOption{"range_v", Number, "10", 0.001, 100, "", "Range to both sides of 0 V; the device uses the next larger range that it has."},
    UriOption{"trigger", Word, "none", 0, 0, "none|pfi0|pfi1|pfi2|pfi3|pfi4|pfi5|pfi6|pfi7",
              "The first scan after dtsd starts begins with a rising edge at this terminal; after a fault or a replug the scan continues "
              "without it."},
    UriOption{"library", File, "", 0, 0, "", "Path of the NI-DAQmx library; needed if the system does not find it."},
};

tl::unexpected<core::Error> refuse(const DeviceUri& uri, ErrorCode code, const std::string& why, std::string hint = {}) {
  return core::fail(code, "device \"" + uri.text + "\": " + why, std::move(hint));
}

core::Status set_channels(const DeviceUri& uri, const std::vector<double>& given, NiOptions& options) {
  if (given.size() > core::kMaxChannels) {
    return refuse(uri, ErrorCode::LimitExceeded, std::to_string(given.size()) + " channels, at most " + std::to_string(core::kMaxChannels));
  }
  for (const double number : given) {
    const auto channel = static_cast<std::size_t>(number);
    if (static_cast<double>(channel) != number) return refuse(uri, ErrorCode::InvalidArgument, "channels must be whole numbers");
    if (std::ranges::find(options.channels, channel) != options.channels.end()) {
      return refuse(uri, ErrorCode::InvalidArgument, "input " + std::to_string(channel) + " is listed twice in channels");
    }
    options.channels.push_back(channel);
  }
  return {};
}

}  // namespace

core::Result<NiOptions> read_ni_options(const DeviceUri& uri) {
  DTS_TRY_ASSIGN(const auto given, UriOptions::read(uri, kOptions));
  NiOptions options;
  options.uri = uri.text;
  options.name = uri.name;
  // These characters separate names in NI's lists of channels.
  if (options.name.empty() || options.name.find_first_of("/,: ") != std::string::npos) {
    return refuse(uri, ErrorCode::InvalidArgument, "\"" + uri.name + "\" is not a name of a device",
                  "write the name that NI's tools show: ni:Dev1");
  }
  const std::vector<double> channels = given.is_given("channels") ? given.numbers("channels") : std::vector<double>{0, 1, 2, 3};
  DTS_TRY(set_channels(uri, channels, options));
  const std::string& terminal = given.text("terminal");
  options.terminal = std::ranges::find_if(kTerminals, [&](const auto& known) { return known.first == terminal; })->second;
  options.range_v = given.number("range_v");
  if (const std::string& trigger = given.text("trigger"); trigger != "none") options.trigger = "PFI" + trigger.substr(3);
  if (given.is_given("library")) options.library = given.text("library");
  return options;
}

core::Result<std::unique_ptr<Device>> create_ni_daqmx(const DeviceUri& uri, const DeviceContext& context) {
  DTS_TRY_ASSIGN(auto options, read_ni_options(uri));
  return std::make_unique<NiDaqmx>(std::move(options), context.clock);
}

}  // namespace dts::device::nidaqmx
