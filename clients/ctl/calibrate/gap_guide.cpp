// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/gap_guide.h"

#include <cmath>

#include "cli/table.h"
#include "cli/try.h"

namespace dts::ctl {
namespace {

using cli::decimal;
using client::Result;

constexpr double kNewLevelV = 0.02;  // four codes of an 11-bit converter over +-5 V
constexpr std::size_t kPatienceHolds = 5;

bool always(std::span<const double> /*scan*/) { return true; }

bool is_other_level(const SteadyReading& one, const SteadyReading& other) {
  for (std::size_t i = 0; i < one.mean.size(); ++i) {
    if (std::abs(one.mean[i] - other.mean[i]) <= kNewLevelV) return false;
  }
  return true;
}

void report(const GapGuideParts& parts, const SteadyReading& reading) {
  std::string text = "  read";
  double noise_v = 0.0;
  for (std::size_t i = 0; i < reading.mean.size(); ++i) {
    text += "  " + decimal(reading.mean[i], 4);
    noise_v = std::max(noise_v, reading.noise[i]);
  }
  parts.say(text + " V; noise up to " + decimal(1e3 * noise_v, 1) + " mV over " + std::to_string(reading.scans) + " scans");
}

/// Reports sensors whose voltage does not change: one such sensor blocks the gap for all.
void say_stuck(const GapGuideParts& parts, const SteadyReading& now, const SteadyReading& last) {
  std::vector<std::string> stuck;
  bool has_mover = false;
  for (std::size_t i = 0; i < now.mean.size() && i < parts.labels.size(); ++i) {
    if (std::abs(now.mean[i] - last.mean[i]) > kNewLevelV) {
      has_mover = true;
    } else {
      stuck.push_back(parts.labels[i]);
    }
  }
  if (!has_mover || stuck.empty()) return;
  parts.say("  still waiting: " + cli::join(stuck) + " changed by less than " + decimal(1e3 * kNewLevelV, 0) +
            " mV, other sensors by more. Check the spacer and the cable. To measure one sensor only: --sensor LABEL");
}

std::string request(const GapGuideParts& parts, std::size_t index) {
  return "Gap " + std::to_string(index + 1) + " of " + std::to_string(parts.gaps_mm.size()) + ": " + decimal(parts.gaps_mm[index], 3) +
         " mm";
}

Result<std::vector<SteadyReading>> measure_guided(const GapGuideParts& parts) {
  std::vector<SteadyReading> readings;
  while (readings.size() < parts.gaps_mm.size()) {
    const Reply answer = parts.prompt->ask(request(parts, readings.size()) + ". Is the spacer in place?", Prompt::kWithRedo);
    if (answer == Answer::Quit) return readings;
    if (answer == Answer::Redo) {
      if (!readings.empty()) readings.pop_back();
      continue;
    }
    DTS_TRY(parts.measurer.begin_anew());
    DTS_TRY_ASSIGN(auto reading, parts.measurer.measure(always));
    if (!reading) return readings;
    report(parts, *reading);
    readings.push_back(std::move(*reading));
  }
  return readings;
}

Result<std::vector<SteadyReading>> measure_alone(const GapGuideParts& parts) {
  parts.say("Clear the space in front of the sensors");
  DTS_TRY_ASSIGN(auto open, parts.measurer.measure(always));
  std::vector<SteadyReading> readings;
  if (!open) return readings;
  report(parts, *open);
  SteadyReading last = *open;
  while (readings.size() < parts.gaps_mm.size()) {
    parts.say(request(parts, readings.size()));
    std::size_t in_vain = 0;
    while (true) {
      DTS_TRY_ASSIGN(auto reading, parts.measurer.measure(always));
      if (!reading) return readings;
      if (!is_other_level(*reading, last)) {
        if (++in_vain % kPatienceHolds == 0) say_stuck(parts, *reading, last);
        continue;
      }
      last = *reading;
      if (!is_other_level(*reading, *open)) continue;
      report(parts, *reading);
      readings.push_back(std::move(*reading));
      break;
    }
  }
  return readings;
}

}  // namespace

Result<std::vector<SteadyReading>> measure_gaps(const GapGuideParts& parts) {
  return parts.prompt != nullptr ? measure_guided(parts) : measure_alone(parts);
}

}  // namespace dts::ctl
