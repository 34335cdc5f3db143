// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "device/device.h"
#include "record/recording.h"

namespace dts::device::replay {

inline constexpr std::int64_t kFarthestNs = std::int64_t{1} << 61U;  ///< 73 years: counts of a file do not overflow.

/// A device as a recording shows it: what it was, and where in the file the columns of its scans are.
struct RecordedDevice {
  DeviceDescription description;  ///< With the recorded state of the pipeline; rates: the recorded one, give or take half a percent.
  core::Rate rate;                ///< Exact.
  std::size_t raw_stream = 0;     ///< Index into `Recording::streams()`.
  std::optional<std::size_t> aux_stream;
  std::optional<std::size_t> quality_stream;
  std::vector<std::size_t> raw_channels;  ///< Device channel of each column of the raw stream ...
  std::vector<std::size_t> aux_channels;  ///< ... and of the aux stream.
};

/// Finds the device in `recording`; `uri` is how it is called. Fails with InvalidArgument when the file does not say enough to put its
/// columns where the device had them: another program's file, a channel missing, two on one place.
[[nodiscard]] core::Result<RecordedDevice> find_device(const record::Recording& recording, const std::string& uri);

/// Looks for the recorded index of the first scan of `device` and writes it into its description; goes back to the recording's beginning.
/// DataDamaged when no clock can show it.
[[nodiscard]] core::Status find_first_scan(record::Recording& recording, RecordedDevice& device);

/// Numbers of a text, separated by spaces, as `Pipeline::save` gave them; DataDamaged when one is none or there are more than 16 million.
[[nodiscard]] core::Result<std::vector<double>> parse_state(const std::string& text);

}  // namespace dts::device::replay
