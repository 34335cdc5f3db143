// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reach/rest_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dts::pipeline {
namespace {

// Reach-model section 5.
constexpr double kNoiseMm = 0.03;      // three times what 3 mV of noise leaves of the smoothed mean
constexpr double kSteadyPart = 0.02;   // of the level, peak to peak
constexpr double kRelaxS = 0.4;        // nobody sits still forever: the limit grows by itself once in this time
constexpr double kSessionPart = 0.06;  // how far a rest may lie from the session's
constexpr double kElsewhereS = 0.5;
constexpr std::size_t kLeastSession = 3;
constexpr double kLevelS = 0.5;
constexpr double kSpreadS = 1.0;
constexpr double kLeastThresholdMm = 0.03;
constexpr double kThresholdSpreads = 5.0;
constexpr double kThresholdPart = 0.012;
constexpr double kMostThresholdPart = 0.04;  // a fidget must not hide a reach

constexpr std::uint64_t kAnyCount = std::numeric_limits<std::uint64_t>::max();

template <std::size_t kSize>
double median_of(std::array<double, kSize> values, std::size_t count) noexcept {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

}  // namespace

double RestDetector::steady_mm(double level_mm) noexcept { return std::max(3.0 * kNoiseMm, kSteadyPart * level_mm); }

void RestDetector::restart() noexcept {
  filled_ = 0;
  next_ = 0;
  settling_ = 0;
  elsewhere_ = 0;
  is_uncertain_ = false;
}

void RestDetector::put(const ReachSample& sample) noexcept {
  window_[next_] = {sample.mm, sample.ratio, sample.twist};
  next_ = (next_ + 1) % kWindow;
  filled_ = std::min(filled_ + 1, kWindow);
}

double RestDetector::median_mm() const noexcept {
  std::array<double, kWindow> values{};
  std::ranges::transform(window_, values.begin(), &Entry::mm);
  return median_of(values, kWindow);
}

double RestDetector::session_mm() const noexcept { return median_of(session_, session_count_); }

double RestDetector::range_mm() const noexcept {
  const auto [lowest, highest] = std::ranges::minmax_element(window_, {}, &Entry::mm);
  return highest->mm - lowest->mm;
}

bool RestDetector::settle(const ReachSample& sample) noexcept {
  put(sample);
  ++settling_;
  if (filled_ < kWindow) return false;
  const double relaxed = 1.0 + static_cast<double>(settling_ - kWindow) / (kRelaxS * rate_hz_);
  const double level_mm = median_mm();
  if (range_mm() > relaxed * steady_mm(level_mm)) {
    elsewhere_ = 0;
    return false;
  }
  const bool has_session = session_count_ >= kLeastSession;
  if (!has_session || std::abs(level_mm - session_mm()) <= kSessionPart * session_mm()) {
    begin(level_mm);
    return true;
  }
  if (static_cast<double>(++elsewhere_) < kElsewhereS * rate_hz_) return false;
  is_uncertain_ = true;
  begin(session_mm());
  return true;
}

void RestDetector::begin(double level_mm) noexcept {
  level_mm_ = level_mm;
  double square = 0.0;
  ratio_ = twist_ = 0.0;
  const double middle_mm = median_mm();
  for (const Entry& entry : window_) {
    square += (entry.mm - middle_mm) * (entry.mm - middle_mm) / kWindow;
    ratio_ += entry.ratio / kWindow;
    twist_ += entry.twist / kWindow;
  }
  spread_mm_ = std::sqrt(square);
}

void RestDetector::track(const ReachSample& sample) noexcept {
  put(sample);
  const Entry& old = window_[(next_ + kWindow / 2) % kWindow];
  const double gain = 1.0 - std::exp(-1.0 / (kLevelS * rate_hz_));
  const double spread_gain = 1.0 - std::exp(-1.0 / (kSpreadS * rate_hz_));
  level_mm_ += gain * (old.mm - level_mm_);
  ratio_ += gain * (old.ratio - ratio_);
  twist_ += gain * (old.twist - twist_);
  const double off_mm = old.mm - level_mm_;
  spread_mm_ = std::sqrt(spread_mm_ * spread_mm_ + spread_gain * (off_mm * off_mm - spread_mm_ * spread_mm_));
}

void RestDetector::remember() noexcept {
  if (is_uncertain_) return;
  session_[session_next_] = level_mm_;
  session_next_ = (session_next_ + 1) % kSession;
  session_count_ = std::min(session_count_ + 1, kSession);
}

double RestDetector::threshold_mm() const noexcept {
  const double spread_mm = std::min(kThresholdSpreads * spread_mm_, kMostThresholdPart * level_mm_);
  return std::max({kLeastThresholdMm, spread_mm, kThresholdPart * level_mm_});
}

void RestDetector::reset() noexcept {
  const double rate_hz = rate_hz_;
  *this = {};
  rate_hz_ = rate_hz;
}

template <class Self, class Archive>
void RestDetector::exchange(Self& self, Archive& archive) noexcept {
  for (auto& entry : self.window_) {
    archive.number(entry.mm, -kMostStateMm, kMostStateMm);
    archive.number(entry.ratio, -kMostStateMm, kMostStateMm);
    archive.number(entry.twist, -kMostStateMm, kMostStateMm);
  }
  archive.count(self.next_, kWindow - 1);
  archive.count(self.filled_, kWindow);
  archive.count(self.settling_, kAnyCount);
  archive.count(self.elsewhere_, kAnyCount);
  for (auto& level_mm : self.session_) archive.number(level_mm, -kMostStateMm, kMostStateMm);
  archive.count(self.session_next_, kSession - 1);
  archive.count(self.session_count_, kSession);
  archive.number(self.level_mm_, -kMostStateMm, kMostStateMm);
  archive.number(self.spread_mm_, 0.0, kMostStateMm);
  archive.number(self.ratio_, -kMostStateMm, kMostStateMm);
  archive.number(self.twist_, -kMostStateMm, kMostStateMm);
  archive.flag(self.is_uncertain_);
}

void RestDetector::save(StateWriter& writer) const noexcept {
  StateSaver saver(writer);
  exchange(*this, saver);
}

void RestDetector::restore(StateReader& reader) noexcept {
  StateLoader loader(reader);
  exchange(*this, loader);
}

}  // namespace dts::pipeline
