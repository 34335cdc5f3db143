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

inline constexpr std::int64_t kFarthestNs = std::int64_t{1} << 61U;  ///< 73 years; limits times from a file, so that they do not overflow.

/// The device of a recording: its description, and the places of its channels in the file.
struct RecordedDevice {
  DeviceDescription description;  ///< With the recorded state of the pipeline; rate limits: the recorded rate +- 0.5 %.
  core::Rate rate;                ///< Exact recorded rate.
  std::size_t raw_stream = 0;     ///< Index into `Recording::streams()`.
  std::optional<std::size_t> aux_stream;
  std::optional<std::size_t> quality_stream;
  std::vector<std::size_t> raw_channels;  ///< Device channel of each column of the raw stream.
  std::vector<std::size_t> aux_channels;  ///< Device channel of each column of the aux stream.
};

/// Returns the device of `recording`, with this `uri`. Fails with InvalidArgument if the device channels of the columns are not clear: a
/// file of another program, a missing channel, two columns for one channel.
[[nodiscard]] core::Result<RecordedDevice> find_device(const record::Recording& recording, const std::string& uri);

/// Stores the recorded index of the first scan in the description of `device`; rewinds the recording. Fails with DataDamaged if the index
/// is impossibly large.
[[nodiscard]] core::Status find_first_scan(record::Recording& recording, RecordedDevice& device);

/// Returns the numbers of a text of `Pipeline::save`, separated by spaces. Fails with DataDamaged if one is not a number or there are more
/// than 16 million.
[[nodiscard]] core::Result<std::vector<double>> parse_state(const std::string& text);

}  // namespace dts::device::replay
