// SPDX-License-Identifier: Apache-2.0
#include "core/losses.h"

#include <limits>

namespace dts::core {
namespace {

std::uint64_t bounded_sum(std::uint64_t a, std::uint64_t b) noexcept {
  std::uint64_t sum = 0;
  return __builtin_add_overflow(a, b, &sum) ? std::numeric_limits<std::uint64_t>::max() : sum;
}

std::string counted(std::uint64_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

}  // namespace

void Losses::add(GapReason reason, LossCount more) noexcept {
  LossCount& count = by_reason_[static_cast<std::size_t>(reason) % kGapReasons];
  count.gaps = bounded_sum(count.gaps, more.gaps);
  count.scans = bounded_sum(count.scans, more.scans);
}

LossCount Losses::total() const noexcept {
  LossCount sum;
  for (const LossCount& count : by_reason_) {
    sum.gaps = bounded_sum(sum.gaps, count.gaps);
    sum.scans = bounded_sum(sum.scans, count.scans);
  }
  return sum;
}

std::string to_text(const Losses& losses) {
  const LossCount total = losses.total();
  if (total == LossCount{}) return {};
  std::string text = counted(total.scans, "scan") + " lost in " + counted(total.gaps, "gap");
  const char* separator = ": ";
  for (std::size_t index = 0; index < kGapReasons; ++index) {
    const auto reason = static_cast<GapReason>(index);
    if (losses.of(reason).gaps == 0) continue;
    text += separator + (reason == GapReason::None ? std::string("unknown") : std::string(name(reason))) + " " +
            std::to_string(losses.of(reason).gaps);
    separator = ", ";
  }
  return text;
}

}  // namespace dts::core
