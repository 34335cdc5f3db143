// SPDX-License-Identifier: Apache-2.0
#include "accuracy/recording_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace dts::accuracy {
namespace {

void centre(std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  for (double& value : values) value -= sum / static_cast<double>(values.size());
}

double interpolate(const std::vector<double>& values, double position) noexcept {
  const double limited = std::clamp(position, 0.0, static_cast<double>(values.size() - 1));
  const auto before = std::min(static_cast<std::size_t>(limited), values.size() - 2);
  const double part = limited - static_cast<double>(before);
  return values[before] + part * (values[before + 1] - values[before]);
}

}  // namespace

double RecordingFile::ml_mm_at(double time_s) const noexcept { return interpolate(locus.ml_mm, time_s * rate_hz); }

double RecordingFile::ap_mm_at(double time_s) const noexcept { return interpolate(locus.ap_mm, time_s * rate_hz); }

std::optional<RecordingFile> read_recording(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line) || !line.starts_with("t_s,x_mm,y_mm")) return std::nullopt;
  RecordingFile recording;
  double first_s = 0.0;
  double last_s = 0.0;
  while (std::getline(file, line)) {
    double time_s = 0.0;
    double ml_mm = 0.0;
    double ap_mm = 0.0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &time_s, &ml_mm, &ap_mm) != 3) return std::nullopt;
    if (recording.locus.ml_mm.empty()) first_s = time_s;
    last_s = time_s;
    recording.locus.ml_mm.push_back(ml_mm);
    recording.locus.ap_mm.push_back(ap_mm);
  }
  if (recording.locus.ml_mm.size() < 2 || !(last_s > first_s)) return std::nullopt;
  recording.rate_hz = static_cast<double>(recording.locus.ml_mm.size() - 1) / (last_s - first_s);
  centre(recording.locus.ml_mm);
  centre(recording.locus.ap_mm);
  return recording;
}

}  // namespace dts::accuracy
