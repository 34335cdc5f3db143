// SPDX-License-Identifier: Apache-2.0
#include "lab/study/confusion.h"

#include <algorithm>
#include <limits>

#include "classifier/trunk_model_parts.h"

namespace dts::lab::study {
namespace {

using core::TrunkClass;

std::size_t column(TrunkClass answer) noexcept {
  return static_cast<std::size_t>(std::clamp(static_cast<int>(answer) + 1, 0, static_cast<int>(Confusion::kAnswers) - 1));
}
std::size_t row(TrunkClass wanted) noexcept {
  return static_cast<std::size_t>(std::clamp(static_cast<int>(wanted), 0, static_cast<int>(Confusion::kWanted) - 1));
}
double share(std::size_t part, std::size_t whole) noexcept {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

TrunkClass true_class(double flexion_deg) noexcept {
  return flexion_deg > 0.0 ? static_cast<TrunkClass>(classifier::class_index(flexion_deg) + 1) : TrunkClass::None;
}

void Confusion::add(TrunkClass wanted, TrunkClass answer) noexcept { ++counts_[row(wanted)][column(answer)]; }

void Confusion::add(const Confusion& other) noexcept {
  for (std::size_t r = 0; r < kWanted; ++r) {
    for (std::size_t c = 0; c < kAnswers; ++c) counts_[r][c] += other.counts_[r][c];
  }
}

std::size_t Confusion::count(TrunkClass wanted, TrunkClass answer) const noexcept { return counts_[row(wanted)][column(answer)]; }

std::size_t Confusion::of(TrunkClass wanted) const noexcept {
  std::size_t sum = 0;
  for (const std::size_t count : counts_[row(wanted)]) sum += count;
  return sum;
}

std::size_t Confusion::correct() const noexcept {
  std::size_t sum = 0;
  for (std::size_t r = 0; r < kWanted; ++r) sum += counts_[r][r + 1];
  return sum;
}

std::size_t Confusion::total() const noexcept {
  std::size_t sum = 0;
  for (const auto& answers : counts_) {
    for (const std::size_t count : answers) sum += count;
  }
  return sum;
}

Confusion Confusion::of_trunk() const noexcept {
  Confusion others = *this;
  others.counts_.front() = {};
  return others;
}

std::size_t Confusion::kept() const noexcept {
  std::size_t rejected = 0;
  for (const auto& answers : counts_) rejected += answers.front();
  return total() - rejected;
}

double Confusion::accuracy() const noexcept { return share(correct(), total()); }
double Confusion::kept_share() const noexcept { return share(kept(), total()); }
double Confusion::kept_accuracy() const noexcept { return share(correct(), kept()); }

}  // namespace dts::lab::study
