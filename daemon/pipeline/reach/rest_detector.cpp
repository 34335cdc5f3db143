// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reach/rest_detector.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace dts::pipeline {
namespace {

// Reach-model section 5.
constexpr double kNoiseMm = 0.03;      // three times the noise of the smoothed mean for sensors with 3 mV
constexpr double kSteadyPart = 0.02;   // of the level, peak to peak
constexpr double kRelaxS = 0.4;        // nobody sits still forever: in this time, the limit grows by its own size
constexpr double kSessionPart = 0.06;  // maximum distance of a rest from the session's baseline
constexpr double kElsewhereS = 0.5;
constexpr double kShortS = 0.2;     // a rest of this length before a movement is used ...
constexpr double kOnsetS = 0.08;    // ... without its end, which may already belong to the movement ...
constexpr double kMovedOnS = 0.06;  // ... and only after the transient has left it for this long
constexpr std::size_t kLeastSession = 3;
constexpr double kLevelS = 0.5;
constexpr double kSpreadS = 1.0;
constexpr double kLeastThresholdMm = 0.03;
constexpr double kThresholdSpreads = 5.0;
constexpr double kThresholdPart = 0.012;
constexpr double kMostThresholdPart = 0.04;  // small movements at rest must not hide a reach

template <std::size_t kSize>
double median_of(std::array<double, kSize> values, std::size_t count) noexcept {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

}  // namespace

double RestDetector::steady_mm(double level_mm) noexcept { return std::max(3.0 * kNoiseMm, kSteadyPart * level_mm); }

void RestDetector::restart(bool is_first) noexcept {
  is_first_ = is_first;
  filled_ = 0;
  next_ = 0;
  settling_ = 0;
  calm_ = 0;
  elsewhere_ = 0;
  is_uncertain_ = is_short_ = false;
}

void RestDetector::put(const ReachSample& sample) noexcept {
  window_[next_] = {sample.mm, sample.ratio, sample.twist};
  next_ = (next_ + 1) % kWindow;
  filled_ = std::min(filled_ + 1, kWindow);
}

double RestDetector::median_mm(std::span<const Entry> rest) noexcept {
  std::array<double, kWindow> values{};
  std::ranges::transform(rest, values.begin(), &Entry::mm);
  return median_of(values, rest.size());
}

double RestDetector::session_mm() const noexcept { return median_of(session_, session_count_); }

double RestDetector::range_mm() const noexcept {
  const auto [lowest, highest] = std::ranges::minmax_element(std::span(window_).first(filled_), {}, &Entry::mm);
  return highest->mm - lowest->mm;
}

bool RestDetector::settle(const ReachSample& sample) noexcept {
  put(sample);
  ++settling_;
  if (settle_shortly(sample)) return true;
  if (filled_ < kWindow) return false;
  const double relaxed = 1.0 + static_cast<double>(settling_ - kWindow) / (kRelaxS * rate_hz_);
  const double level_mm = median_mm(window_);
  if (range_mm() > relaxed * steady_mm(level_mm)) {
    elsewhere_ = 0;
    return false;
  }
  const bool has_session = session_count_ >= kLeastSession;
  if (!has_session || std::abs(level_mm - session_mm()) <= kSessionPart * session_mm()) {
    begin(level_mm, window_);
    return true;
  }
  if (static_cast<double>(++elsewhere_) < kElsewhereS * rate_hz_) return false;
  is_uncertain_ = true;
  begin(session_mm(), window_);
  return true;
}

/// Returns true if the transient was steady at first and has then left this rest before the window was full.
bool RestDetector::settle_shortly(const ReachSample& sample) noexcept {
  const auto ticks = [this](double seconds) { return static_cast<std::uint64_t>(seconds * rate_hz_ + 0.5); };
  if (!is_first_ || settling_ > kWindow + ticks(kMovedOnS)) return false;
  if (calm_ + 1 == settling_ && range_mm() <= steady_mm(sample.mm)) {
    calm_ = settling_;
    return false;
  }
  if (calm_ < ticks(kShortS) || settling_ < calm_ + ticks(kMovedOnS)) return false;
  const std::uint64_t overwritten = settling_ - filled_;
  const std::uint64_t end = calm_ - ticks(kOnsetS);
  if (end > kWindow || overwritten >= end) return false;
  const auto rest = std::span<const Entry>(window_).first(end).subspan(overwritten);
  begin(median_mm(rest), rest);
  if (std::abs(sample.mm - level_mm_) <= threshold_mm()) return false;
  is_short_ = true;
  calm_ = 0;
  window_.fill({level_mm_, ratio_, twist_});
  filled_ = kWindow;
  return true;
}

void RestDetector::begin(double level_mm, std::span<const Entry> rest) noexcept {
  level_mm_ = level_mm;
  double square = 0.0;
  ratio_ = twist_ = 0.0;
  const double middle_mm = median_mm(rest);
  const auto count = static_cast<double>(rest.size());
  for (const Entry& entry : rest) {
    square += (entry.mm - middle_mm) * (entry.mm - middle_mm) / count;
    ratio_ += entry.ratio / count;
    twist_ += entry.twist / count;
  }
  spread_mm_ = std::sqrt(square);
}

void RestDetector::track(const ReachSample& sample) noexcept {
  put(sample);
  if (is_short_ && ++calm_ > kWindow) is_short_ = false;
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
  if (is_uncertain()) return;
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
  archive.count(self.calm_, kAnyCount);
  archive.count(self.elsewhere_, kAnyCount);
  for (auto& level_mm : self.session_) archive.number(level_mm, -kMostStateMm, kMostStateMm);
  archive.count(self.session_next_, kSession - 1);
  archive.count(self.session_count_, kSession);
  archive.number(self.level_mm_, -kMostStateMm, kMostStateMm);
  archive.number(self.spread_mm_, 0.0, kMostStateMm);
  archive.number(self.ratio_, -kMostStateMm, kMostStateMm);
  archive.number(self.twist_, -kMostStateMm, kMostStateMm);
  archive.flag(self.is_first_);
  archive.flag(self.is_short_);
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
