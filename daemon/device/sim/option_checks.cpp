// SPDX-License-Identifier: Apache-2.0
#include "device/sim/option_checks.h"

namespace dts::device::sim {
namespace {

using core::ErrorCode;

FaultKind fault_kind(const std::string& word) {
  if (word == "unplug") return FaultKind::Unplug;
  if (word == "overrun") return FaultKind::Overrun;
  if (word == "stuck") return FaultKind::Stuck;
  return word == "silence" ? FaultKind::Silence : FaultKind::None;
}

}  // namespace

bool is_one_of(std::string_view values, std::string_view value) {
  return ("|" + std::string(values) + "|").find("|" + std::string(value) + "|") != std::string::npos;
}

tl::unexpected<core::Error> refuse(const DeviceUri& uri, ErrorCode code, const std::string& why) {
  return core::fail(code, "device \"" + uri.text + "\": " + why);
}

core::Status check_dependencies(const DeviceUri& uri, const UriOptions& options, std::span<const Dependency> dependencies) {
  for (const auto& [option, needs, values] : dependencies) {
    if (!options.is_given(option) || is_one_of(values, options.text(needs))) continue;
    return refuse(uri, ErrorCode::InvalidArgument,
                  std::string(option) + " has an effect only with " + std::string(needs) + "=" + std::string(values));
  }
  return {};
}

core::Result<Fault> read_fault(const DeviceUri& uri, const UriOptions& options, std::size_t converted_channels) {
  for (const std::string_view option : {"fault_at_s", "fault_for_s"}) {
    if (!options.is_given(option) || options.text("fault") != "none") continue;
    return refuse(uri, ErrorCode::InvalidArgument, std::string(option) + " has an effect only with fault=...");
  }
  const Fault fault{fault_kind(options.text("fault")), options.number("fault_at_s"), options.number("fault_for_s"),
                    static_cast<std::size_t>(options.number("fault_channel"))};
  if (fault.kind == FaultKind::Stuck && fault.channel >= converted_channels) {
    return refuse(uri, ErrorCode::InvalidArgument,
                  "fault_channel = " + std::to_string(fault.channel) + ", but there are " + std::to_string(converted_channels) +
                      " converted channels, counted from 0");
  }
  return fault;
}

}  // namespace dts::device::sim
