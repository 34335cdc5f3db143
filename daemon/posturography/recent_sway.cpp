// SPDX-License-Identifier: Apache-2.0
#include "posturography/recent_sway.h"

#include <algorithm>
#include <cmath>

namespace dts::posturography {
namespace {

constexpr double kFarthestInStateMm = 1e9;
constexpr double kLargestIndexInState = 9007199254740992.0;  // 2^53, the largest that a state can hold

}  // namespace

RecentSwaySums::RecentSwaySums(double rate_hz, std::size_t most_chunks)
    : chunks_(std::max<std::size_t>(most_chunks, 1), Chunk{.sums = RunningSwaySums(rate_hz)}) {}

void RecentSwaySums::reset() noexcept {
  for (Chunk& chunk : chunks_) chunk.sums.reset();
  count_ = 0;
  is_complete_ = false;
}

void RecentSwaySums::add(double ml_mm, double ap_mm, std::uint64_t index) noexcept {
  if (count_ == 0 || is_complete_) {
    if (count_ == chunks_.size()) {
      std::ranges::move(chunks_.begin() + 1, chunks_.end(), chunks_.begin());
      --count_;
    }
    chunks_[count_].sums.reset();
    chunks_[count_].first_index = index;
    chunks_[count_].first_ml_mm = ml_mm;
    chunks_[count_].first_ap_mm = ap_mm;
    ++count_;
    is_complete_ = false;
  }
  chunks_[count_ - 1].sums.add(ml_mm, ap_mm);
}

void RecentSwaySums::end_chunk() noexcept { is_complete_ = count_ > 0; }

core::RunningSway RecentSwaySums::values() const noexcept {
  if (count_ == 0) return chunks_.front().sums.values();
  RunningSwaySums all = chunks_.front().sums;
  for (std::size_t k = 1; k < count_; ++k) all.append(chunks_[k].sums, chunks_[k].first_ml_mm, chunks_[k].first_ap_mm);
  return all.values();
}

std::uint64_t RecentSwaySums::first_index() const noexcept { return count_ == 0 ? 0 : chunks_.front().first_index; }

void RecentSwaySums::save(std::span<double> state) const noexcept {
  if (state.size() != state_size()) return;
  std::ranges::fill(state, 0.0);
  state[0] = static_cast<double>(2 * count_ + (is_complete_ ? 1 : 0));
  auto next = state.begin() + 1;
  for (std::size_t k = 0; k < count_; ++k) {
    *next++ = static_cast<double>(chunks_[k].first_index);
    *next++ = chunks_[k].first_ml_mm;
    *next++ = chunks_[k].first_ap_mm;
    next = std::ranges::copy(chunks_[k].sums.state(), next).out;
  }
}

bool RecentSwaySums::restore(std::span<const double> state) noexcept {
  reset();
  if (state.size() != state_size()) return false;
  const double counts = state[0];
  if (!(counts >= 0.0 && counts <= static_cast<double>(2 * chunks_.size() + 1) && counts == std::floor(counts))) return false;
  const auto whole = static_cast<std::size_t>(counts);
  bool is_possible = whole != 1 && whole / 2 <= chunks_.size();
  for (std::size_t k = 0; is_possible && k < whole / 2; ++k) {
    const auto of_chunk = state.subspan(1 + k * kChunkSize, kChunkSize);
    const double first = of_chunk[0];
    is_possible = first >= 0.0 && first <= kLargestIndexInState && first == std::floor(first) &&
                  std::abs(of_chunk[1]) <= kFarthestInStateMm && std::abs(of_chunk[2]) <= kFarthestInStateMm &&
                  chunks_[k].sums.set_state(of_chunk.subspan<3, RunningSwaySums::kStateSize>()) && !chunks_[k].sums.empty();
    if (!is_possible) break;
    chunks_[k].first_ml_mm = of_chunk[1];
    chunks_[k].first_ap_mm = of_chunk[2];
    chunks_[k].first_index = static_cast<std::uint64_t>(first);
    is_possible = k == 0 || chunks_[k].first_index > chunks_[k - 1].first_index;
  }
  if (!is_possible) {
    reset();
    return false;
  }
  count_ = whole / 2;
  is_complete_ = whole % 2 == 1;
  return true;
}

}  // namespace dts::posturography
