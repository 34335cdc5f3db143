// SPDX-License-Identifier: Apache-2.0
#include "session/cop_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>

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

posturography::CopSeries CopCut::series() const {
  posturography::CopSeries series{.rate_hz = rate_hz_};
  for (auto* column : {&series.ml_mm, &series.ap_mm, &series.load_n}) column->reserve(count_);
  std::uint32_t doubts = 0;
  for (std::size_t place = first_; place < first_ + count_; ++place) {
    const CopSample& sample = (*chunks_[place / std::tuple_size_v<CopChunk>])[place % std::tuple_size_v<CopChunk>];
    series.ml_mm.push_back(sample.ml_mm);
    series.ap_mm.push_back(sample.ap_mm);
    series.load_n.push_back(sample.load_n);
    doubts |= sample.quality & kDoubts;
  }
  if (doubts != 0) series.flags |= posturography::sway_flag::kDoubtful;
  return series;
}

bool CopTrace::continues(const core::Block& cop) const noexcept {
  if (stretches_.empty() || cop.segment != stretches_.back().segment) return false;
  const Stretch& newest = stretches_.back();
  return cop.first_scan.value == newest.first_index + (end_number_ - newest.first_number);
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
      for (std::uint64_t i = 0; i < *missing; ++i) append({.ml_mm = kNothing, .ap_mm = kNothing, .load_n = kNothing, .quality = 0});
    } else {
      begin_number_ = chunk_number_ = end_number_;
      chunks_.clear();
      stretches_.clear();
    }
    stretches_.push_back({.segment = cop.segment, .first_index = cop.first_scan.value, .first_number = end_number_});
  }
  for (std::size_t i = 0; i < cop.count(); ++i) {
    append({.ml_mm = static_cast<float>(cop.column(0)[i]),
            .ap_mm = static_cast<float>(cop.column(1)[i]),
            .load_n = static_cast<float>(cop.column(2)[i]),
            .quality = static_cast<std::uint32_t>(cop.quality(0)[i]) | cop.quality(1)[i]});
  }
  end_host_ns_ = cop.host_time_ns + cop_rate_.time_ns({cop.count()});
  drop_old();
}

void CopTrace::append(const CopSample& sample) {
  constexpr std::size_t kSize = std::tuple_size_v<CopChunk>;
  const auto place = static_cast<std::size_t>(end_number_ - chunk_number_);
  if (place == chunks_.size() * kSize) chunks_.push_back(std::make_shared_for_overwrite<CopChunk>());
  (*chunks_[place / kSize])[place % kSize] = sample;
  ++end_number_;
}

std::optional<std::uint64_t> CopTrace::number_of(const TracePlace& place) const noexcept {
  const auto stretch = std::ranges::find(stretches_, place.segment, &Stretch::segment);
  if (stretch == stretches_.end()) return std::nullopt;
  const std::uint64_t index = cop_index(place.scan, raw_rate_, cop_rate_);
  if (index < stretch->first_index) return std::nullopt;
  return stretch->first_number + (index - stretch->first_index);
}

void CopTrace::drop_old() {
  const std::uint64_t next = end_number_;
  std::uint64_t wanted = next - std::min<std::uint64_t>(next, static_cast<std::uint64_t>(kKeptS * cop_rate_.hz()) + 1);
  if (kept_from_) wanted = std::min(wanted, number_of(*kept_from_).value_or(wanted));
  wanted = std::max<std::uint64_t>(wanted, next - std::min<std::uint64_t>(next, kMostSamples));
  if (wanted <= begin_number_) return;
  begin_number_ = wanted;
  for (constexpr std::size_t kSize = std::tuple_size_v<CopChunk>; begin_number_ - chunk_number_ >= kSize; chunk_number_ += kSize) {
    chunks_.pop_front();
  }
  while (stretches_.size() > 1 && stretches_[1].first_number <= begin_number_) stretches_.pop_front();
}

bool CopTrace::reaches(const TracePlace& end) const noexcept {
  if (stretches_.empty()) return false;
  if (end.segment != stretches_.back().segment) return end.segment < stretches_.back().segment;
  return end_number_ >= number_of(end).value_or(0);
}

std::uint64_t CopTrace::samples_since(const TracePlace& place) const noexcept {
  if (stretches_.empty() || place.segment > stretches_.back().segment) return 0;
  const auto number = number_of(place);
  if (!number) return std::numeric_limits<std::uint64_t>::max();
  return end_number_ - std::min(end_number_, *number);
}

std::optional<CopCut> CopTrace::cut(const TracePlace& first, const TracePlace& last) const {
  const auto begin = number_of(first);
  const auto end = number_of(last);
  if (!begin || !end || *begin < begin_number_ || *end <= *begin || *end > end_number_) return std::nullopt;
  constexpr std::size_t kSize = std::tuple_size_v<CopChunk>;
  const auto place = static_cast<std::size_t>(*begin - chunk_number_);
  const auto last_place = static_cast<std::size_t>(*end - 1 - chunk_number_);
  std::vector<std::shared_ptr<const CopChunk>> chunks(chunks_.begin() + static_cast<std::ptrdiff_t>(place / kSize),
                                                      chunks_.begin() + static_cast<std::ptrdiff_t>(last_place / kSize) + 1);
  return CopCut(std::move(chunks), place % kSize, static_cast<std::size_t>(*end - *begin), cop_rate_.hz());
}

}  // namespace dts::session
