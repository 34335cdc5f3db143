// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/measure.h"

#include <cmath>

#include "cli/table.h"
#include "ctl/json.h"

namespace dts::ctl {

using client::Result;

Result<std::size_t> hold_scans(double hold_s, double rate_hz) {
  const auto scans = static_cast<std::size_t>(std::llround(hold_s * rate_hz));
  if (scans >= kLeastWindowScans) return scans;
  return client::fail(client::ErrorCode::InvalidArgument,
                      "a hold of " + cli::decimal(hold_s, 3) + " s has " + std::to_string(scans) + " scans at " + cli::decimal(rate_hz, 1) +
                          " Hz; at least " + std::to_string(kLeastWindowScans) + " are needed",
                      "hold longer: --hold " + cli::decimal(static_cast<double>(kLeastWindowScans) / rate_hz + 0.005, 2));
}

Measurer::Measurer(Feed& feed, MeasureOptions options)
    : feed_(feed), options_(std::move(options)), detector_(options_.labels.size(), options_.limits), scan_(options_.labels.size()) {}

Result<SteadyReading> Measurer::measure(const Test& is_there) {
  detector_.reset();
  has_begun_ = false;
  told_.clear();
  waited_scans_ = 0;
  while (true) {
    const auto block = feed_.next();
    if (!block) return tl::make_unexpected(block.error());
    if (!*block) continue;
    take(**block, is_there);
    if (auto reading = detector_.reading()) return std::move(*reading);
    say_unrest((*block)->columns.front().size());
  }
}

void Measurer::take(const FeedBlock& block, const Test& is_there) {
  if (block.follows_loss) spoil("scans were lost");
  const std::string doubt = doubts(block);
  if (!doubt.empty()) return spoil(doubt);
  for (std::size_t i = 0; i < block.columns.front().size(); ++i) {
    for (std::size_t channel = 0; channel < scan_.size(); ++channel) scan_[channel] = block.columns[channel][i];
    if (is_there(scan_)) {
      detector_.add(scan_);
      has_begun_ = true;
    } else if (has_begun_) {
      spoil("taken away before it was measured: put it back");
    }
  }
}

void Measurer::spoil(const std::string& why) {
  if (has_begun_ && why != told_) options_.say("  the hold begins anew: " + why);
  if (has_begun_) told_ = why;
  detector_.reset();
  has_begun_ = false;
}

std::string Measurer::doubts(const FeedBlock& block) const {
  for (std::size_t channel = 0; channel < block.quality.size(); ++channel) {
    const auto bits = static_cast<std::uint8_t>(block.quality[channel] & options_.refused_quality);
    if (bits == 0) continue;
    std::string words = options_.labels[channel] + " is marked";
    for (const std::string& word : quality_words(bits)) words += " " + word;
    return words;
  }
  return {};
}

void Measurer::say_unrest(std::size_t scans) {
  waited_scans_ += scans;
  if (waited_scans_ < options_.patience_scans) return;
  waited_scans_ = 0;
  if (!has_begun_) return options_.say("  waiting for it");
  if (const auto unrest = detector_.unrest()) {
    options_.say("  waiting for rest: " + options_.labels[unrest->channel] + " " + unrest->text + " " + options_.unit);
  }
}

Result<void> Measurer::wait_until(const Test& is_gone) {
  constexpr std::size_t kEnoughScans = 3;
  std::size_t gone = 0;
  while (gone < kEnoughScans) {
    const auto block = feed_.next();
    if (!block) return tl::make_unexpected(block.error());
    if (!*block) continue;
    for (std::size_t i = 0; i < (*block)->columns.front().size() && gone < kEnoughScans; ++i) {
      for (std::size_t channel = 0; channel < scan_.size(); ++channel) scan_[channel] = (*block)->columns[channel][i];
      gone = is_gone(scan_) ? gone + 1 : 0;
    }
  }
  return {};
}

Result<void> Measurer::begin_anew() { return feed_.discard(); }

}  // namespace dts::ctl
