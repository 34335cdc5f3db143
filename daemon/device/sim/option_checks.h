// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/result.h"
#include "device/sim/fault.h"
#include "device/uri_options.h"

namespace dts::device::sim {

inline constexpr double kMillivolt = 1e-3;
inline constexpr std::size_t kTruthChannels = 3;  ///< Two for the position, one for the load.

/// An option that has no effect without another option. If only this option is set, it is rejected: it is probably a mistake.
struct Dependency {
  std::string_view option;
  std::string_view needs;
  std::string_view values;  ///< Values of `needs` with which `option` has an effect, separated by '|'.
};

/// Returns true if `value` is one of `values`, which are separated by '|'.
[[nodiscard]] bool is_one_of(std::string_view values, std::string_view value);

/// Returns an error with the text: device "URI": why.
[[nodiscard]] tl::unexpected<core::Error> refuse(const DeviceUri& uri, core::ErrorCode code, const std::string& why);

/// Fails with InvalidArgument, naming the option without effect.
[[nodiscard]] core::Status check_dependencies(const DeviceUri& uri, const UriOptions& options, std::span<const Dependency> dependencies);

/// Returns the fault that the options fault, fault_at_s, fault_for_s and fault_channel describe. Fails if a time is set without a fault,
/// or if the converter has no such channel.
[[nodiscard]] core::Result<Fault> read_fault(const DeviceUri& uri, const UriOptions& options, std::size_t converted_channels);

}  // namespace dts::device::sim
