// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/settled_stance.h"

#include <cmath>

namespace dts::pipeline {
namespace {

constexpr double kSettleMs = 500.0;
constexpr double kLongestOutMs = 250.0;
constexpr double kSettledPart = 0.05;
constexpr double kLeavingPart = 0.2;
constexpr double kLargestReferenceN = 1e9;  // limit for a value from a file

}  // namespace

void SettledStance::prepare(const core::Rate& rate) noexcept {
  settle_ = rate.scans_in_ms(kSettleMs);
  longest_out_ = rate.scans_in_ms(kLongestOutMs);
  reset();
}

bool SettledStance::update(double load_n, bool is_possible) noexcept {
  const double difference_n = std::abs(load_n - reference_n_);
  if (is_settled_) {
    run_ = is_possible ? 0 : run_ + 1;
    if (run_ <= longest_out_ && difference_n <= kLeavingPart * reference_n_) return true;
    reset();
  }
  if (!is_possible || difference_n > kSettledPart * reference_n_) {
    run_ = 0;
    reference_n_ = load_n;
    return false;
  }
  if (++run_ < settle_) return false;
  is_settled_ = true;
  run_ = 0;
  reference_n_ = load_n;
  return true;
}

void SettledStance::reset() noexcept {
  is_settled_ = false;
  run_ = 0;
  reference_n_ = 0.0;
}

void SettledStance::save(StateWriter& writer) const noexcept {
  writer.put(is_settled_ ? 1.0 : 0.0);
  writer.put_count(run_);
  writer.put(reference_n_);
}

void SettledStance::restore(StateReader& reader) noexcept {
  is_settled_ = reader.flag();
  run_ = reader.count(is_settled_ ? longest_out_ : settle_);
  reference_n_ = reader.number(0.0, kLargestReferenceN);
}

}  // namespace dts::pipeline
