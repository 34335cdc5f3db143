// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/json.h"
#include "ctl/calibrate/steady.h"
#include "dts/endpoints.h"
#include "dts/error.h"

namespace dts::ctl {

/// $XDG_STATE_HOME/dts, else ~/.local/state/dts. Fails with Failed when there is no home either.
[[nodiscard]] client::Result<std::filesystem::path> state_folder(const client::Environment& environment = client::process_environment);

/// The points measured so far, on the disk as soon as they are measured: a crash costs the point under way at most.
///
///     {"calibration": {...what is calibrated, how, at which points...}}        first line
///     {"index": 0, "mean": [...], "noise": [...], "scans": 300}               one line per point; a later one replaces an earlier
///     {"index": 0, "redo": true}                                              the point is to be measured again
///
/// A last line that a crash has cut off is removed. Held exclusively while it is open.
class ProgressFile {
 public:
  /// Begins anew. Fails with WrongState when another calibration holds the file.
  [[nodiscard]] static client::Result<ProgressFile> create(const std::filesystem::path& file, const cli::Json& calibration);
  /// What the calibration in the file is, as it was given to `create`. Fails with WrongState when there is no file, with DataDamaged.
  [[nodiscard]] static client::Result<cli::Json> calibration_in(const std::filesystem::path& file);
  /// Goes on. Fails with WrongState when there is nothing, when the file is of another calibration (naming what differs) or held by another
  /// process, with DataDamaged naming "file:line".
  [[nodiscard]] static client::Result<ProgressFile> resume(const std::filesystem::path& file, const cli::Json& calibration,
                                                           std::size_t point_count, std::size_t channel_count);

  [[nodiscard]] const std::vector<std::optional<SteadyReading>>& points() const noexcept { return points_; }
  /// The first point that is not measured; the number of points when all are.
  [[nodiscard]] std::size_t next() const noexcept;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Appends and synchronises.
  [[nodiscard]] client::Result<void> record(std::size_t index, const SteadyReading& reading);
  /// The point is to be measured again.
  [[nodiscard]] client::Result<void> forget(std::size_t index);
  /// The calibration is complete: removes the file.
  void finish() noexcept;

 private:
  struct Closer {
    void operator()(const int* descriptor) const noexcept;
  };
  using Descriptor = std::unique_ptr<const int, Closer>;

  [[nodiscard]] static client::Result<ProgressFile> open(const std::filesystem::path& file, int flags);
  [[nodiscard]] client::Result<void> append(const std::string& line);
  [[nodiscard]] client::Result<void> read(const cli::Json& calibration, std::size_t channel_count);
  [[nodiscard]] client::Result<void> take(const cli::Json& line, std::size_t number, std::size_t channel_count);

  std::filesystem::path path_;
  Descriptor descriptor_;
  std::vector<std::optional<SteadyReading>> points_;
};

}  // namespace dts::ctl
