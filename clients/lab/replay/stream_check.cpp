// SPDX-License-Identifier: Apache-2.0
#include "lab/replay/stream_check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

namespace dts::lab::replay {
namespace {

// Limits for a file whose streams do not belong together. The streams of a correct recording differ by at most a quarter of a second.
constexpr std::size_t kMostWaitingRuns = 100'000;
constexpr std::size_t kMostWaitingValues = std::size_t{1} << 23U;  // 64 MB

template <class Number>
std::string shortest(Number value) {
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

}  // namespace

bool StreamCheck::is_same(double recorded, double computed) const noexcept {
  if (std::isnan(recorded) || std::isnan(computed)) return std::isnan(recorded) && std::isnan(computed);
  if (info_.value_type == record::ValueType::Float32) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(recorded)) == std::bit_cast<std::uint32_t>(static_cast<float>(computed));
  }
  return std::bit_cast<std::uint64_t>(recorded) == std::bit_cast<std::uint64_t>(computed);
}

std::string StreamCheck::text_of(double value) const {
  return info_.value_type == record::ValueType::Float32 ? shortest(static_cast<float>(value)) : shortest(value);
}

void StreamCheck::add_recorded(const record::RecordedScans& scans) {
  if (is_stopped_ || difference_ || scans.count == 0) return;
  recorded_.push_back({.next = {scans.segment, scans.first_scan.value}, .left = scans.count, .values = scans.values});
  waiting_values_ += scans.values.size();
  match();
}

void StreamCheck::add_computed(const core::Block& block) {
  if (is_stopped_ || difference_ || block.count() == 0) return;
  const std::size_t width = block.channel_count();
  Run run{.next = {block.segment, block.first_scan.value}, .left = block.count(), .values = std::vector<double>(width * block.count())};
  for (std::size_t c = 0; c < width; ++c) {
    const auto column = block.column(c);
    for (std::size_t i = 0; i < column.size(); ++i) run.values[i * width + c] = column[i];
  }
  waiting_values_ += run.values.size();
  computed_.push_back(std::move(run));
  match();
}

void StreamCheck::note(Place at, const std::string& channel, const std::string& recorded, const std::string& computed) {
  difference_ = {.segment = at.segment, .scan = at.scan, .channel = channel, .recorded = recorded, .computed = computed};
  recorded_.clear();
  computed_.clear();
  waiting_values_ = 0;
}

void StreamCheck::drop(std::deque<Run>& runs, std::size_t scans) {
  runs.front().next.scan += scans;
  runs.front().left -= scans;
  if (runs.front().left > 0) return;
  waiting_values_ -= runs.front().values.size();
  runs.pop_front();
}

void StreamCheck::match() {
  while (!difference_ && !recorded_.empty() && !computed_.empty()) {
    const Place recorded = recorded_.front().next;
    const Place computed = computed_.front().next;
    if (recorded == computed) {
      match_together(recorded_.front(), computed_.front());
    } else if (recorded < computed) {
      note(recorded, "", "there", "nothing");
    } else {
      note(computed, "", "nothing", "there");
    }
  }
  if (std::max(recorded_.size(), computed_.size()) <= kMostWaitingRuns && waiting_values_ <= kMostWaitingValues) return;
  if (recorded_.empty() && computed_.empty()) return;
  const bool is_recorded = !recorded_.empty();
  note((is_recorded ? recorded_ : computed_).front().next, "", is_recorded ? "there" : "nothing", is_recorded ? "nothing" : "there");
}

void StreamCheck::match_together(Run& recorded, Run& computed) {
  const std::size_t width = info_.channels.size();
  const std::size_t scans = std::min(recorded.left, computed.left);
  const double* one = recorded.values.data() + (recorded.values.size() - recorded.left * width);
  const double* other = computed.values.data() + (computed.values.size() - computed.left * width);
  for (std::size_t i = 0; i < scans * width; ++i) {
    if (is_same(one[i], other[i])) continue;
    compared_scans_ += i / width;
    const Place at{recorded.next.segment, recorded.next.scan + i / width};
    return note(at, info_.channels[i % width].label, text_of(one[i]), text_of(other[i]));
  }
  compared_scans_ += scans;
  drop(recorded_, scans);
  drop(computed_, scans);
}

void StreamCheck::finish(bool is_torn) {
  if (is_torn || is_stopped_ || difference_) return;
  if (!recorded_.empty()) return note(recorded_.front().next, "", "there", "nothing");
  if (!computed_.empty()) note(computed_.front().next, "", "nothing", "there");
}

}  // namespace dts::lab::replay
