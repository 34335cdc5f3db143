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

/// Returns $XDG_STATE_HOME/dts, otherwise ~/.local/state/dts. Fails with Failed if there is no home either.
[[nodiscard]] client::Result<std::filesystem::path> state_folder(const client::Environment& environment = client::process_environment);

/// The points measured so far. Each is written to the disk at once: a crash loses at most the point in progress.
///
///     {"calibration": {...what is calibrated, how, at which points...}}        first line
///     {"index": 0, "mean": [...], "noise": [...], "scans": 300}               one line per point; a later one replaces an earlier
///     {"index": 0, "redo": true}                                              the point is to be measured again
///
/// Removes a last line that a crash has cut off. Locks the file while it is open.
class ProgressFile {
 public:
  /// Starts a new file. Fails with WrongState if another calibration has locked the file.
  [[nodiscard]] static client::Result<ProgressFile> create(const std::filesystem::path& file, const cli::Json& calibration);
  /// Returns the calibration in the file, as passed to `create`. Fails with WrongState if there is no file, with DataDamaged if it is
  /// damaged.
  [[nodiscard]] static client::Result<cli::Json> calibration_in(const std::filesystem::path& file);
  /// Continues an interrupted calibration. Fails with WrongState if there is no file, if it belongs to another calibration (naming the
  /// difference) or if another process has locked it; with DataDamaged, naming "file:line", if it is damaged.
  [[nodiscard]] static client::Result<ProgressFile> resume(const std::filesystem::path& file, const cli::Json& calibration,
                                                           std::size_t point_count, std::size_t channel_count);

  [[nodiscard]] const std::vector<std::optional<SteadyReading>>& points() const noexcept { return points_; }
  /// Returns the first point that is not measured; the number of points if all are.
  [[nodiscard]] std::size_t next() const noexcept;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Appends the point and synchronises the file.
  [[nodiscard]] client::Result<void> record(std::size_t index, const SteadyReading& reading);
  /// Marks the point to be measured again.
  [[nodiscard]] client::Result<void> forget(std::size_t index);
  /// Removes the file, because the calibration is complete.
  void finish() noexcept;

 private:
  struct Closer {
    void operator()(const int* descriptor) const noexcept;
  };
  using Descriptor = std::unique_ptr<const int, Closer>;

  [[nodiscard]] static client::Result<ProgressFile> open(const std::filesystem::path& file, int flags);
  [[nodiscard]] client::Result<void> append(const std::string& line);
  [[nodiscard]] client::Result<void> read(const cli::Json& calibration, std::size_t channel_count);
  [[nodiscard]] client::Result<void> add_line(const cli::Json& line, std::size_t number, std::size_t channel_count);

  std::filesystem::path path_;
  Descriptor descriptor_;
  std::vector<std::optional<SteadyReading>> points_;
};

}  // namespace dts::ctl
