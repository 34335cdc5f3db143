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
inline constexpr std::size_t kTruthChannels = 3;  ///< The position, two, and the load.

/// An option that would silently do nothing unless another one is set is refused: it is probably a mistake.
struct Dependency {
  std::string_view option;
  std::string_view needs;
  std::string_view values;  ///< Any of these, separated by '|'.
};

/// `value` is one of `values`, which are separated by '|'.
[[nodiscard]] bool is_one_of(std::string_view values, std::string_view value);

/// "device "URI": why".
[[nodiscard]] tl::unexpected<core::Error> refuse(const DeviceUri& uri, core::ErrorCode code, const std::string& why);

/// InvalidArgument naming the option that does nothing.
[[nodiscard]] core::Status check_dependencies(const DeviceUri& uri, const UriOptions& options, std::span<const Dependency> dependencies);

/// The fault that the options fault, fault_at_s, fault_for_s and fault_channel describe. Fails when a time is given without a fault, or
/// the channel is none of the converter's.
[[nodiscard]] core::Result<Fault> read_fault(const DeviceUri& uri, const UriOptions& options, std::size_t converted_channels);

}  // namespace dts::device::sim
