// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"

namespace dts::record {

/// Receives the items of a recording. Thread: items of one stream arrive in order and on one thread; items of different streams arrive at
/// the same time. Events count as one stream.
class ExportSink {
 public:
  virtual ~ExportSink() = default;
  /// If a `write` fails (the disk is full), the walk ends.
  [[nodiscard]] virtual core::Status write(const RecordedScans& scans) = 0;
  [[nodiscard]] virtual core::Status write(const RecordedChange& change) = 0;
  [[nodiscard]] virtual core::Status write(const TimedEvent& event) = 0;
};

/// Returns the time stamp of the earliest first scan of all regular streams; without scans, of the first item in the file. Rewinds.
[[nodiscard]] core::Result<double> find_origin(Recording& recording);
/// Passes all items to `sink`, from the beginning. Fails with Failed if `progress` stops it.
[[nodiscard]] core::Status walk(Recording& recording, ExportSink& sink, const Progress& progress);

/// Returns the session's ID with its part ("20261121T144525Z-floor-1.2"), valid in file names; "recording" for files of other programs.
[[nodiscard]] std::string file_stem(const Recording& recording);
/// Returns the text with only letters, digits, '.', '_' and '-', at most 100 of them, and without a '.' at the start.
[[nodiscard]] std::string fit_for_file_name(const std::string& text);

}  // namespace dts::record
