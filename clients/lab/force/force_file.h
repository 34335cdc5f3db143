// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "c3d/c3d_file.h"
#include "c3d/force_platform.h"
#include "core/result.h"
#include "core/special_numbers.h"
#include "physics/force_plate/wrench.h"

namespace dts::lab::force {

using Vector = std::array<double, 3>;

/// One sample of a plate, with the sign of the file. NaN: absent in the file, not measured by this kind of plate, or undefined.
struct ForceSample {
  Vector force_n{core::kNaN, core::kNaN, core::kNaN};
  Vector moment_nm{core::kNaN, core::kNaN, core::kNaN};  ///< About the centre of the plate's surface.
  Vector cop_mm{core::kNaN, core::kNaN, core::kNaN};
  double free_moment_nm = core::kNaN;
};

enum class Axes : std::uint8_t { Plate, Laboratory };

/// What a file says about a plate. Lengths are in mm.
struct PlateFacts {
  std::optional<int> c3d_type;
  std::optional<Vector> origin_mm;
  std::optional<c3d::Corners> corners_mm;
  std::optional<physics::PointPolynomial> polynomial;  ///< In the file; `is_polynomial_applied` says whether it is in the values.
  bool is_polynomial_applied = false;
  bool is_zero_applied = false;
  bool has_force = true;  ///< False: the file has only a centre of pressure.
  bool is_usable = true;  ///< False: all samples are empty, and a warning says why.
  std::vector<std::string> warnings;
};

/// The force plates of one file. The samples are computed when they are asked for, so that a large file needs little memory.
struct ForceFile {
  std::string format;                   ///< "c3d", "bioware", "motive", "bertec", "columns", "opensim", "raw".
  double rate_hz = 0.0;                 ///< Of the samples.
  std::optional<double> point_rate_hz;  ///< Of the frames of a C3D file.
  std::size_t samples = 0;
  Axes axes = Axes::Plate;        ///< In which the samples are.
  std::size_t vertical = 2;       ///< Index of the vertical axis; 1 in OpenSim.
  std::optional<bool> is_z_down;  ///< Of plates without corners; absent: not known.
  std::optional<std::array<int, 2>> zero_frames;
  std::vector<PlateFacts> plates;
  std::vector<c3d::Event> events;
  std::vector<std::string> warnings;
  std::vector<double> t_s;  ///< Empty: sample / rate.
  std::function<ForceSample(std::size_t plate, std::size_t sample)> sample_at;

  [[nodiscard]] double time_s(std::size_t sample) const { return t_s.empty() ? static_cast<double>(sample) / rate_hz : t_s[sample]; }
};

/// How to read a file. Nothing is corrected unless it is asked for.
struct ReadOptions {
  bool is_zero_of_file = false;        ///< C3D: subtract the mean of the frames in ZERO.
  bool is_polynomial_of_file = false;  ///< C3D: correct the COP with FPCOPPOLY.
  std::string plate_file;              ///< For raw channels: the file with [force_plate].
};

inline constexpr double kDefaultLeastForceN = 20.0;

/// Returns the sample of a wrench about the surface, with its centre of pressure; `polynomial` corrects this, if there is one.
[[nodiscard]] ForceSample sample_of(const physics::Wrench& wrench, const std::optional<physics::PointPolynomial>& polynomial);

/// Returns whether `file` holds force plates: C3D, a text export, or OpenSim. Looks at its beginning only. A CSV file with x_mm,y_mm or
/// ml_mm,ap_mm in its first line does not, whatever its other columns are: `sway` and `compare` read the positions of such a file.
[[nodiscard]] bool is_force_file(const std::string& file);

/// Reads a file, in the format that its beginning has. Fails with Failed, and a text of one line that names the file, the place and what to
/// do; also if no plate is usable. `options.plate_file` makes the file one of raw channels.
[[nodiscard]] core::Result<ForceFile> read_force_file(const std::string& file, const ReadOptions& options);

/// Returns the error of a file that cannot be read: "FILE: what; hint".
[[nodiscard]] tl::unexpected<core::Error> unreadable(const std::string& file, const std::string& what, const std::string& hint = {});

}  // namespace dts::lab::force
