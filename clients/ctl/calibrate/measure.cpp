// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/measure.h"

#include <algorithm>
#include <cmath>

#include "cli/table.h"
#include "cli/try.h"
#include "ctl/json.h"

namespace dts::ctl {

using client::Result;

Result<std::size_t> hold_scans(double hold_s, double rate_hz) {
  const auto scans = static_cast<std::size_t>(std::llround(hold_s * rate_hz));
  if (scans >= kLeastWindowScans) return scans;
  return client::fail(client::ErrorCode::InvalidArgument,
                      "a hold of " + cli::decimal(hold_s, 3) + " s has " + std::to_string(scans) + " scans at " + cli::decimal(rate_hz, 1) +
                          " Hz; required: at least " + std::to_string(kLeastWindowScans),
                      "average for longer: --hold " + cli::decimal(static_cast<double>(kLeastWindowScans) / rate_hz + 0.005, 2));
}

Measurer::Measurer(Feed& feed, MeasureOptions options)
    : feed_(feed), options_(std::move(options)), detector_(options_.labels.size(), options_.limits), scan_(options_.labels.size()) {}

Result<std::optional<SteadyReading>> Measurer::measure(const Test& is_there) {
  detector_.reset();
  has_begun_ = false;
  reported_.clear();
  doubt_.clear();
  doubted_.clear();
  waited_scans_ = 0;
  while (true) {
    if (options_.is_stopped && options_.is_stopped()) return std::nullopt;
    DTS_TRY_ASSIGN(const auto block, feed_.next());
    if (!block) continue;
    add(*block, is_there);
    if (auto reading = detector_.reading()) return reading;
    say_unrest(block->columns.front().size());
  }
}

void Measurer::add(const FeedBlock& block, const Test& is_there) {
  if (block.follows_loss) spoil("scans were lost");
  doubt_ = doubts(block);
  if (!doubt_.empty()) {
    if (has_begun_) count_doubt(doubt_);
    return spoil(doubt_);
  }
  for (std::size_t i = 0; i < block.columns.front().size(); ++i) {
    for (std::size_t channel = 0; channel < scan_.size(); ++channel) scan_[channel] = block.columns[channel][i];
    if (is_there(scan_)) {
      detector_.add(scan_);
      has_begun_ = true;
    } else if (has_begun_) {
      spoil("removed too early: put it back");
    }
  }
}

void Measurer::spoil(const std::string& why) {
  if (has_begun_ && why != reported_) options_.say("  the reading starts again: " + why);
  if (has_begun_) reported_ = why;
  detector_.reset();
  has_begun_ = false;
}

std::string Measurer::doubts(const FeedBlock& block) {
  for (std::size_t channel = 0; channel < block.quality.size(); ++channel) {
    const auto bits = static_cast<std::uint8_t>(block.quality[channel] & options_.refused_quality);
    if (bits == 0) continue;
    std::string words = options_.labels[channel] + " is flagged";
    for (const std::string& word : quality_words(bits)) words += " " + word;
    advice_ = options_.advise ? options_.advise(options_.labels[channel], bits) : std::string();
    return words;
  }
  return {};
}

void Measurer::count_doubt(const std::string& doubt) {
  constexpr std::size_t kEnoughHolds = 3;
  doubted_holds_ = doubt == doubted_ ? doubted_holds_ + 1 : 1;
  doubted_ = doubt;
  if (doubted_holds_ % kEnoughHolds == 0 && !advice_.empty()) options_.say("  repeated problem: " + doubt + ": " + advice_);
}

bool Measurer::is_patience_over(std::size_t scans) {
  waited_scans_ += scans;
  if (waited_scans_ < options_.patience_scans) return false;
  waited_scans_ = 0;
  return true;
}

std::string Measurer::seen(const std::string& otherwise) const {
  if (!doubt_.empty()) return doubt_ + (advice_.empty() ? "" : ": " + advice_);
  return options_.sees ? options_.sees(scan_) : otherwise;
}

void Measurer::say_unrest(std::size_t scans) {
  if (!is_patience_over(scans)) return;
  if (!has_begun_) return options_.say("  still waiting: " + seen("no load found"));
  if (const auto unrest = detector_.unrest()) {
    options_.say("  waiting until the reading is steady: " + options_.labels[unrest->channel] + " " + unrest->text + " " + options_.unit);
  }
}

Result<void> Measurer::wait_until(const Test& is_gone) {
  constexpr std::size_t kEnoughScans = 3;
  std::size_t gone = 0;
  waited_scans_ = 0;
  while (gone < kEnoughScans) {
    DTS_TRY_ASSIGN(const auto block, feed_.next());
    if (!block) continue;
    const std::size_t scans = block->columns.front().size();
    doubt_ = doubts(*block);
    if (!doubt_.empty() || block->follows_loss) gone = 0;
    for (std::size_t i = 0; i < scans && gone < kEnoughScans && doubt_.empty() && !block->follows_loss; ++i) {
      for (std::size_t channel = 0; channel < scan_.size(); ++channel) scan_[channel] = block->columns[channel][i];
      const bool is_known = std::ranges::all_of(scan_, [](double value) { return std::isfinite(value); });
      gone = is_known && is_gone(scan_) ? gone + 1 : 0;
    }
    if (gone < kEnoughScans && is_patience_over(scans)) options_.say("  still waiting: remove the weight: " + seen("it is still there"));
  }
  return {};
}

Result<void> Measurer::begin_anew() { return feed_.discard(); }

}  // namespace dts::ctl
