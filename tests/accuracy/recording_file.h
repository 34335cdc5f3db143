// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "accuracy/measures.h"

namespace dts::accuracy {

/// A recorded centre of pressure, read independently of the simulator that plays it: what is published is compared with
/// the file itself. CSV with the header `t_s,x_mm,y_mm`, evenly sampled.
struct RecordingFile {
  double rate_hz = 0.0;
  Locus locus;  ///< Centred: the mean of the whole file is subtracted, as the simulator does.

  [[nodiscard]] double duration_s() const noexcept { return static_cast<double>(locus.ml_mm.size() - 1) / rate_hz; }
  /// Linear between the samples; `time_s` since the first one, limited to the recording.
  [[nodiscard]] double ml_mm_at(double time_s) const noexcept;
  [[nodiscard]] double ap_mm_at(double time_s) const noexcept;
};

/// Nothing when the file is absent or not of that form.
[[nodiscard]] std::optional<RecordingFile> read_recording(const std::string& path);

}  // namespace dts::accuracy
