// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"

namespace dts::record {

/// Takes what a recording holds; what is not wanted is let go. Thread: what belongs to one stream comes in order and from one thread,
/// different streams come at the same time. Events count as one stream.
class ExportSink {
 public:
  virtual ~ExportSink() = default;
  /// A failure (the disk is full) ends the walk.
  [[nodiscard]] virtual core::Status take(const RecordedScans& scans) = 0;
  [[nodiscard]] virtual core::Status take(const RecordedChange& change) = 0;
  [[nodiscard]] virtual core::Status take(const TimedEvent& event) = 0;
};

/// The time stamp of the earliest first scan of all regular streams; of whatever comes first when there is no scan. Rewinds.
[[nodiscard]] core::Result<double> find_origin(Recording& recording);
/// Gives everything to `sink`, from the beginning; fails with Failed when `progress` stops it.
[[nodiscard]] core::Status walk(Recording& recording, ExportSink& sink, const Progress& progress);

/// The session's id with its part ("20261121T144525Z-floor-1.2"), made fit for file names; "recording" for files of other programs.
[[nodiscard]] std::string file_stem(const Recording& recording);
/// Letters, digits, '.', '_' and '-' only, at most 100 of them, and no '.' in front.
[[nodiscard]] std::string fit_for_file_name(const std::string& text);

}  // namespace dts::record
