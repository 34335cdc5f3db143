// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reach/smoother.h"

#include <algorithm>
#include <cmath>

#include "core/block.h"

namespace dts::pipeline {
namespace {

constexpr double kBridgedMs = 250.0;

}  // namespace

void Smoother::prepare(const core::Rate& rate) noexcept {
  divisor_ = static_cast<std::uint64_t>(std::max(1.0, std::round(rate.hz() / kRateHz)));
  bridged_limit_ = std::max<std::uint64_t>(1, rate.scans_in_ms(kBridgedMs) / divisor_);
  reset();
}

bool Smoother::add(double mm, double ratio, double twist, std::uint8_t bits) noexcept {
  ++scans_;
  if (std::isfinite(mm) && std::isfinite(ratio) && std::isfinite(twist)) {
    ++known_;
    sum_mm_ += mm;
    sum_ratio_ += ratio;
    sum_twist_ += twist;
  }
  if ((bits & core::quality::kSubstituted) != 0) ++substituted_;
  if ((bits & core::quality::kUncalibrated) != 0) ++at_end_;
  is_untared_ = is_untared_ || (bits & core::quality::kUntared) != 0;
  return scans_ == divisor_ && finish_block();
}

bool Smoother::finish_block() noexcept {
  Entry entry{};
  if (2 * known_ >= scans_ && known_ > 0) {
    const auto count = static_cast<double>(known_);
    entry = {sum_mm_ / count, sum_ratio_ / count, sum_twist_ / count, 2 * substituted_ > scans_, 2 * at_end_ > scans_, is_untared_};
    bridged_ = 0;
    filled_ = std::min(filled_ + 1, kWindow);
  } else {
    entry = window_[(next_ + kWindow - 1) % kWindow];
    ++bridged_;
  }
  sum_mm_ = sum_ratio_ = sum_twist_ = 0.0;
  scans_ = known_ = substituted_ = at_end_ = 0;
  is_untared_ = false;
  window_[next_] = entry;
  next_ = (next_ + 1) % kWindow;
  if (bridged_ > bridged_limit_) filled_ = 0;
  sample_ = {.is_known = filled_ == kWindow};
  for (const Entry& each : window_) {
    sample_.mm += each.mm / kWindow;
    sample_.ratio += each.ratio / kWindow;
    sample_.twist += each.twist / kWindow;
    sample_.is_substituted = sample_.is_substituted || each.is_substituted;
    sample_.is_at_end = sample_.is_at_end || each.is_at_end;
    sample_.is_untared = sample_.is_untared || each.is_untared;
  }
  return true;
}

void Smoother::reset() noexcept {
  sum_mm_ = sum_ratio_ = sum_twist_ = 0.0;
  scans_ = known_ = substituted_ = at_end_ = 0;
  is_untared_ = false;
  window_ = {};
  next_ = 0;
  bridged_ = 0;
  filled_ = 0;
  sample_ = {};
}

template <class Self, class Archive>
void Smoother::exchange(Self& self, Archive& archive) noexcept {
  const double most = kMostStateMm * static_cast<double>(self.divisor_);
  archive.number(self.sum_mm_, -most, most);
  archive.number(self.sum_ratio_, -most, most);
  archive.number(self.sum_twist_, -most, most);
  archive.count(self.scans_, self.divisor_ - 1);
  archive.count(self.known_, self.divisor_ - 1);
  archive.count(self.substituted_, self.divisor_ - 1);
  archive.count(self.at_end_, self.divisor_ - 1);
  archive.flag(self.is_untared_);
  archive.count(self.next_, kWindow - 1);
  archive.count(self.bridged_, kAnyCount);
  archive.count(self.filled_, kWindow);
  for (auto& entry : self.window_) {
    archive.number(entry.mm, -kMostStateMm, kMostStateMm);
    archive.number(entry.ratio, -kMostStateMm, kMostStateMm);
    archive.number(entry.twist, -kMostStateMm, kMostStateMm);
    archive.flag(entry.is_substituted);
    archive.flag(entry.is_at_end);
    archive.flag(entry.is_untared);
  }
}

void Smoother::save(StateWriter& writer) const noexcept {
  StateSaver saver(writer);
  exchange(*this, saver);
}

void Smoother::restore(StateReader& reader) noexcept {
  StateLoader loader(reader);
  exchange(*this, loader);
  sample_ = {};
}

}  // namespace dts::pipeline
