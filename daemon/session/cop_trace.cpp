// SPDX-License-Identifier: Apache-2.0
#include "session/cop_trace.h"

#include <algorithm>
#include <cmath>

namespace dts::session {
namespace {

/// Qualify a value and let it pass.
constexpr std::uint32_t kDoubts = core::quality::kUncalibrated | core::quality::kUntared | core::quality::kSubstituted;

}  // namespace

std::uint64_t cop_index(core::ScanIndex raw, core::Rate raw_rate, core::Rate cop_rate) noexcept {
  constexpr double kLast = 9e18;  // of what a file says
  if (raw_rate == cop_rate) return raw.value;
  return static_cast<std::uint64_t>(std::min(kLast, std::ceil(static_cast<double>(raw.value) * cop_rate.hz() / raw_rate.hz() - 1e-6)));
}

void CopTrace::take(const core::Block& cop) {
  if (cop.channel_count() < 3 || cop.count() == 0) return;
  const std::uint64_t next = first_ + samples_.size();
  if (cop.segment != segment_ || cop.first_scan.value != next) {
    samples_.clear();
    segment_ = cop.segment;
    first_ = cop.first_scan.value;
  }
  for (std::size_t i = 0; i < cop.count(); ++i) {
    samples_.push_back({.ml_mm = static_cast<float>(cop.column(0)[i]),
                        .ap_mm = static_cast<float>(cop.column(1)[i]),
                        .load_n = static_cast<float>(cop.column(2)[i]),
                        .quality = static_cast<std::uint32_t>(cop.quality(0)[i]) | cop.quality(1)[i]});
  }
  drop_old();
}

void CopTrace::drop_old() {
  const std::uint64_t next = first_ + samples_.size();
  std::uint64_t wanted = next - std::min<std::uint64_t>(next, static_cast<std::uint64_t>(kKeptS * cop_rate_.hz()) + 1);
  if (kept_from_) wanted = std::min(wanted, cop_index(*kept_from_, raw_rate_, cop_rate_));
  wanted = std::max<std::uint64_t>(wanted, next - std::min<std::uint64_t>(next, kMostSamples));
  if (wanted <= first_) return;
  samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(wanted - first_));
  first_ = wanted;
}

bool CopTrace::reaches(std::uint32_t segment, core::ScanIndex end_scan) const noexcept {
  if (segment != segment_) return segment < segment_;
  return first_ + samples_.size() >= cop_index(end_scan, raw_rate_, cop_rate_);
}

double CopTrace::duration_s(core::ScanIndex first_scan, core::ScanIndex end_scan) const noexcept {
  return end_scan.value > first_scan.value ? static_cast<double>(end_scan.value - first_scan.value) / raw_rate_.hz() : 0.0;
}

std::optional<posturography::CopSeries> CopTrace::cut(std::uint32_t segment, core::ScanIndex first_scan, core::ScanIndex end_scan) const {
  const std::uint64_t begin = cop_index(first_scan, raw_rate_, cop_rate_);
  const std::uint64_t end = cop_index(end_scan, raw_rate_, cop_rate_);
  if (segment != segment_ || begin < first_ || end <= begin || end > first_ + samples_.size()) return std::nullopt;
  posturography::CopSeries series{.rate_hz = cop_rate_.hz()};
  std::uint32_t doubts = 0;
  for (auto sample = samples_.begin() + static_cast<std::ptrdiff_t>(begin - first_);
       sample != samples_.begin() + static_cast<std::ptrdiff_t>(end - first_); ++sample) {
    series.ml_mm.push_back(sample->ml_mm);
    series.ap_mm.push_back(sample->ap_mm);
    series.load_n.push_back(sample->load_n);
    doubts |= sample->quality & kDoubts;
  }
  if (doubts != 0) series.flags |= posturography::sway_flag::kDoubtful;
  return series;
}

}  // namespace dts::session
