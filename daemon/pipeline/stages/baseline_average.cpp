// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/baseline_average.h"

#include <cmath>

#include "pipeline/fault.h"

namespace dts::pipeline {

void BaselineAverage::start(std::uint64_t scans) noexcept {
  scans_ = scans;
  remaining_ = scans;
  sums_ = {};
}

void BaselineAverage::add(const core::Block& block, std::size_t first, std::size_t scans) noexcept {
  for (std::size_t c = 0; c < block.channel_count(); ++c) {
    const auto values = block.column(c).subspan(first, scans);
    const auto bits = block.quality(c).subspan(first, scans);
    Sums& sums = sums_[c];
    if (remaining_ == scans_ && scans > 0) sums.origin = values[0];
    for (std::size_t i = 0; i < scans; ++i) {
      const double offset = values[i] - sums.origin;
      sums.sum += offset;
      sums.squares += offset * offset;
      sums.bits |= explained(values[i], bits[i]);
    }
  }
  remaining_ -= scans;
}

double BaselineAverage::mean(std::size_t channel) const noexcept {
  return sums_[channel].origin + sums_[channel].sum / static_cast<double>(scans_);
}

void BaselineAverage::save(StateWriter& writer, std::size_t channel_count) const noexcept {
  writer.put_count(remaining_);
  const bool has_sums = remaining_ > 0 && remaining_ < scans_;
  for (std::size_t c = 0; c < channel_count; ++c) {
    const Sums sums = has_sums ? sums_[c] : Sums{};
    writer.put(sums.origin);
    writer.put(sums.sum);
    writer.put(sums.squares);
    writer.put_count(sums.bits);
  }
}

void BaselineAverage::restore(StateReader& reader, std::size_t channel_count, std::uint64_t scans) noexcept {
  start(scans);
  remaining_ = reader.count(scans);
  for (std::size_t c = 0; c < channel_count; ++c) {
    Sums& sums = sums_[c];
    sums.origin = reader.any();
    sums.sum = reader.any();
    sums.squares = reader.any();
    sums.bits = reader.bits();
    for (const double value : {sums.origin, sums.sum, sums.squares}) reader.check_explained(value, sums.bits);
  }
}

TareOutcome BaselineAverage::outcome(std::size_t first, std::size_t end, double limit, double noise) const noexcept {
  for (std::size_t c = first; c < end; ++c) {
    if ((sums_[c].bits & kFaultBits) != 0) return TareOutcome::BadSensor;
  }
  for (std::size_t c = first; c < end; ++c) {
    if (std::abs(mean(c)) > limit) return TareOutcome::Loaded;
  }
  const auto scans = static_cast<double>(scans_);
  for (std::size_t c = first; c < end; ++c) {
    const double mean_offset = sums_[c].sum / scans;
    const double variance = sums_[c].squares / scans - mean_offset * mean_offset;
    if (variance > noise * noise) return TareOutcome::Unsteady;
  }
  return TareOutcome::Done;
}

}  // namespace dts::pipeline
