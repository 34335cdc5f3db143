// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "c3d/c3d_file.h"
#include "c3d/force_platform.h"
#include "core/result.h"

namespace dts::c3d {

/// Channels of one plate of type 1: Fx Fy Fz in N, Px Py in mm from the centre of the plate, Mz (the free moment) in N mm.
inline constexpr std::size_t kChannelsOfPlate = 6;
inline constexpr std::size_t kMostPlates = 42;   ///< A parameter has at most 255 rows.
inline constexpr std::size_t kMostEvents = 255;  ///< For the same reason.

/// A file of force plates and events, without points.
struct Outline {
  double rate_hz = 0.0;
  std::size_t samples = 0;
  std::vector<Corners> plates;  ///< Corners in mm.
  std::vector<Event> events;    ///< At most `kMostEvents`.
  std::string software;         ///< "dtsd 1.0.0"
};

/// Returns the beginning of a file of 32-bit real numbers (Intel, plates of type 1): header and parameters. The samples follow, each as
/// `append_sample` writes it. Fails with InvalidArgument if the rate is not above 0 in 32 bits, if there is no sample, or if there are too
/// many plates or events.
[[nodiscard]] core::Result<std::string> file_beginning(const Outline& outline);

/// Appends one sample: the values of all channels of all plates. An undefined value is NaN: C3D has no other way to say it.
void append_sample(std::string& bytes, std::span<const double> values);

}  // namespace dts::c3d
