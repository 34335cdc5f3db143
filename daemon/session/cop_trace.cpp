// SPDX-License-Identifier: Apache-2.0
#include "session/cop_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dts::session {
namespace {

/// Bits that qualify a value but do not make it invalid.
constexpr std::uint32_t kDoubts = core::quality::kUncalibrated | core::quality::kUntared | core::quality::kSubstituted;

}  // namespace

std::uint64_t cop_index(core::ScanIndex raw, core::Rate raw_rate, core::Rate cop_rate) noexcept {
  constexpr double kLast = 9e18;  // upper limit, because the index may come from a damaged file
  if (raw_rate == cop_rate) return raw.value;
  return static_cast<std::uint64_t>(std::min(kLast, std::ceil(static_cast<double>(raw.value) * cop_rate.hz() / raw_rate.hz() - 1e-6)));
}

bool CopTrace::continues(const core::Block& cop) const noexcept {
  if (stretches_.empty() || cop.segment != stretches_.back().segment) return false;
  const Stretch& newest = stretches_.back();
  return cop.first_scan.value == newest.first_index + (end_number() - newest.first_number);
}

/// Returns the number of samples missing between the newest sample and a block of the next segment; nothing if no trial needs it or it is
/// unknown.
std::optional<std::uint64_t> CopTrace::samples_missing(const core::Block& cop) const noexcept {
  if (!kept_from_ || stretches_.empty() || cop.segment != stretches_.back().segment + 1) return std::nullopt;
  const double missing = std::round(static_cast<double>(cop.host_time_ns - end_host_ns_) * 1e-9 * cop_rate_.hz());
  if (!(missing < static_cast<double>(kMostSamples))) return std::nullopt;
  return missing > 0.0 ? static_cast<std::uint64_t>(missing) : 0U;
}

void CopTrace::take(const core::Block& cop) {
  if (cop.channel_count() < 3 || cop.count() == 0) return;
  if (!continues(cop)) {
    if (const auto missing = samples_missing(cop)) {
      constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
      samples_.insert(samples_.end(), *missing, {.ml_mm = kNothing, .ap_mm = kNothing, .load_n = kNothing, .quality = 0});
    } else {
      begin_number_ = end_number();
      samples_.clear();
      stretches_.clear();
    }
    stretches_.push_back({.segment = cop.segment, .first_index = cop.first_scan.value, .first_number = end_number()});
  }
  for (std::size_t i = 0; i < cop.count(); ++i) {
    samples_.push_back({.ml_mm = static_cast<float>(cop.column(0)[i]),
                        .ap_mm = static_cast<float>(cop.column(1)[i]),
                        .load_n = static_cast<float>(cop.column(2)[i]),
                        .quality = static_cast<std::uint32_t>(cop.quality(0)[i]) | cop.quality(1)[i]});
  }
  end_host_ns_ = cop.host_time_ns + cop_rate_.time_ns({cop.count()});
  drop_old();
}

std::optional<std::uint64_t> CopTrace::number_of(const TracePlace& place) const noexcept {
  const auto stretch = std::ranges::find(stretches_, place.segment, &Stretch::segment);
  if (stretch == stretches_.end()) return std::nullopt;
  const std::uint64_t index = cop_index(place.scan, raw_rate_, cop_rate_);
  if (index < stretch->first_index) return std::nullopt;
  return stretch->first_number + (index - stretch->first_index);
}

void CopTrace::drop_old() {
  const std::uint64_t next = end_number();
  std::uint64_t wanted = next - std::min<std::uint64_t>(next, static_cast<std::uint64_t>(kKeptS * cop_rate_.hz()) + 1);
  if (kept_from_) wanted = std::min(wanted, number_of(*kept_from_).value_or(wanted));
  wanted = std::max<std::uint64_t>(wanted, next - std::min<std::uint64_t>(next, kMostSamples));
  if (wanted <= begin_number_) return;
  samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(wanted - begin_number_));
  begin_number_ = wanted;
  while (stretches_.size() > 1 && stretches_[1].first_number <= begin_number_) stretches_.pop_front();
}

bool CopTrace::reaches(const TracePlace& end) const noexcept {
  if (stretches_.empty()) return false;
  if (end.segment != stretches_.back().segment) return end.segment < stretches_.back().segment;
  return end_number() >= number_of(end).value_or(0);
}

std::optional<posturography::CopSeries> CopTrace::cut(const TracePlace& first, const TracePlace& last) const {
  const auto begin = number_of(first);
  const auto end = number_of(last);
  if (!begin || !end || *begin < begin_number_ || *end <= *begin || *end > end_number()) return std::nullopt;
  posturography::CopSeries series{.rate_hz = cop_rate_.hz()};
  std::uint32_t doubts = 0;
  for (auto sample = samples_.begin() + static_cast<std::ptrdiff_t>(*begin - begin_number_);
       sample != samples_.begin() + static_cast<std::ptrdiff_t>(*end - begin_number_); ++sample) {
    series.ml_mm.push_back(sample->ml_mm);
    series.ap_mm.push_back(sample->ap_mm);
    series.load_n.push_back(sample->load_n);
    doubts |= sample->quality & kDoubts;
  }
  if (doubts != 0) series.flags |= posturography::sway_flag::kDoubtful;
  return series;
}

}  // namespace dts::session
