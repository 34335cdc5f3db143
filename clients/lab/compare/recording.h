// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "files/toml_reader.h"
#include "lab/force/standing_cop.h"

namespace dts::lab::compare {

/// A recorded centre of pressure. All columns are as long as `t_s`; NaN where a value is missing. Times rise strictly.
struct Recording {
  std::vector<double> t_s;  ///< Relative to `began_s`.
  std::vector<double> x_mm;
  std::vector<double> y_mm;
  std::vector<double> edges_s{};      ///< Rising edges of the trigger.
  double edge_step_s = 0.0;           ///< See `RisingEdges`.
  std::vector<std::string> marker{};  ///< Text at its scan; empty without this column.
  std::vector<double> restarts_s{};   ///< First scans after gaps at which the clock may have jumped. Rise strictly.
  bool is_simulated = false;          ///< No person was measured.
  double delay_s = 0.0;               ///< Filter delay that `t_s` is corrected for; 0: none, or unknown.
  std::string host_clock{};           ///< Recordings with the same text have times of one computer's clock; empty: unknown.

  /// On the recording's clock. Separate from `t_s`, because a double with a Unix time resolves only 0.2 us: too coarse for the alignment.
  double began_s = 0.0;

  /// Returns the median time between scans.
  [[nodiscard]] double step_s() const;
};

/// Rising edges of a level.
struct RisingEdges {
  std::vector<double> at_s{};
  double step_s = 0.0;  ///< An edge may be off by half of this time.
};
/// The level of a trigger and the width of the band around it: an edge is complete when the signal leaves the band at its upper end.
struct TriggerLevel {
  double level = 0.0;
  double band = 0.0;
};
/// Returns where the values rise through the level, interpolated between two scans. A signal that rises within one scan is known to one
/// scan only; if most edges last longer, they are known to a tenth of it. Ignores rows without a value and rises within a gap.
/// Without a given level, takes the middle between the low and the high level of the recording; after an edge, the values must fall below
/// a quarter of their distance before the next one counts. A few spikes do not set these levels. Returns no edges if the values are noise:
/// no two levels, or levels closer than 0.05.
[[nodiscard]] RisingEdges rising_edges(std::span<const double> t_s, std::span<const double> values,
                                       std::optional<TriggerLevel> trigger = std::nullopt);

/// Reads a recording: an XDF file if its name ends in .xdf or .xdf.part, a file of force plates (ML as x, AP as y), else a CSV file with
/// the columns `t_s,x_mm,y_mm` (or ml_mm,ap_mm) and optionally `trigger` and `marker`. Times become relative to the first. Adds every error
/// to `problems`; times must rise, and there must be 20 scans over two seconds.
[[nodiscard]] Recording read_recording(const std::string& file, const force::CopChoice& choice, files::Problems& problems);

/// Reads the stream "cop" of an XDF recording: ml_mm as x, ap_mm as y, at the times that the values describe. Rising triggers and markers
/// are from its events, restarts of the clock from its segments.
[[nodiscard]] Recording read_xdf_recording(const std::string& file, files::Problems& problems);

/// A smooth curve through samples at any times (cubic Hermite with the slopes of the neighbours), with gaps where samples are missing.
/// Ignores samples whose time is not later than that of the sample before.
class SmoothSeries {
 public:
  SmoothSeries(std::span<const double> t_s, std::span<const double> values);

  struct Value {
    double value;
    double slope_per_s;
  };
  /// Returns NaN outside the samples and in gaps longer than three steps.
  [[nodiscard]] Value at(double t_s) const;

 private:
  std::vector<double> t_s_;
  std::vector<double> values_;
  std::vector<double> slopes_;
  double longest_step_s_ = 0.0;
};

}  // namespace dts::lab::compare
