// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "dts/wire/event_json.h"
#include "record/session_facts.h"
#include "record/xdf/xdf_writer.h"

namespace dts::report {

/// A sway-like signal, mm: many slow waves that have no common period.
inline double made_sway(double t_s, double seed, double size = 1.0) {
  double value = 0.0;
  for (int k = 1; k <= 14; ++k) {
    const double frequency_hz = 0.06 * std::pow(static_cast<double>(k), 1.4);
    value += size * 4.0 / k * std::sin(2.0 * std::numbers::pi * frequency_hz * t_s + seed * k * k);
  }
  return value;
}

/// A step of a protocol in the recording.
struct MadeStep {
  std::string phase;
  std::uint32_t trial = 1;
  std::uint32_t attempt = 1;
  std::string condition{};
  std::vector<std::pair<std::string, std::string>> labels{};
  double at_s = 0.0;
};

/// What a test wants of its recording: one segment of a stream "floor/cop".
struct MadeStanding {
  record::SessionFacts facts{.session_id = "20261121T144525Z-floor-1",
                             .rig = "floor",
                             .kind = "floor",
                             .protocol = "quiet-standing",
                             .subject = "P017",
                             .started_utc_ns = 1'795'272'325'000'000'000,
                             .utc_minus_monotonic_ns = 1'795'272'315'000'000'000,
                             .software = "dtsd 0.1.0",
                             .device_uri = "ni6008:",
                             .device_model = "USB-6008",
                             .device_serial = "0123",
                             .stages = {"window_filter window_scans=3", "cop estimator=poly3"}};
  int rate_hz = 100;
  double length_s = 30.0;
  std::function<double(double)> ml_mm = [](double t_s) { return 12.0 + made_sway(t_s, 0.3, 0.7); };
  std::function<double(double)> ap_mm = [](double t_s) { return -20.0 + made_sway(t_s, 0.8); };
  std::vector<MadeStep> steps{};
  std::vector<v1::Event> events{};  ///< As they are, at their scans.
  bool has_cop = true;
};

/// Trial `trial` from `from_s` on for `length_s`, ending in `outcome`.
inline void add_trial(MadeStanding& made, std::uint32_t trial, double from_s, double length_s, const std::string& condition,
                      const std::vector<std::pair<std::string, std::string>>& labels, const std::string& outcome = "done",
                      std::uint32_t attempt = 1) {
  for (const auto& [phase, at_s] : {std::pair<std::string, double>{"measure", from_s}, {outcome, from_s + length_s}}) {
    made.steps.push_back({.phase = phase, .trial = trial, .attempt = attempt, .condition = condition, .labels = labels, .at_s = at_s});
  }
}

inline v1::Event event_of(const MadeStep& step, std::uint64_t scan) {
  static const std::map<std::string, v1::TrialEventKind> steps{{"measure", v1::TRIAL_EVENT_KIND_MEASURE},
                                                               {"done", v1::TRIAL_EVENT_KIND_DONE},
                                                               {"redone", v1::TRIAL_EVENT_KIND_REDONE},
                                                               {"rejected", v1::TRIAL_EVENT_KIND_REJECTED},
                                                               {"aborted", v1::TRIAL_EVENT_KIND_ABORTED}};
  v1::Event event;
  event.set_scan(scan);
  v1::TrialChange& trial = *event.mutable_trial();
  trial.set_step(steps.at(step.phase));
  trial.set_trial(step.trial);
  trial.set_attempt(step.attempt);
  trial.set_block(1);
  trial.set_condition(step.condition);
  for (const auto& [name, value] : step.labels) (*trial.mutable_labels())[name] = value;
  return event;
}

/// Writes it, closed; returns the file's name.
inline std::string write_standing(const std::string& name, const MadeStanding& made) {
  constexpr double kOrigin_s = 10.0;
  auto writer = record::XdfWriter::create(name, record::to_facts(made.facts)).value();
  const std::uint32_t events = writer->add_stream(
      {.name = "floor/events", .content = "Markers", .value_type = record::ValueType::Text, .channels = {{.label = "event"}}});
  const std::uint32_t cop = writer->add_stream(
      {.name = made.has_cop ? "floor/cop" : "floor/transient",
       .content = "DTS",
       .value_type = record::ValueType::Float32,
       .rate = *core::Rate::create(static_cast<std::uint64_t>(made.rate_hz), 1),
       .channels = {{.label = "ml_mm", .unit = "mm"}, {.label = "ap_mm", .unit = "mm"}, {.label = "load_n", .unit = "N"}}});
  const auto tell = [&](const v1::Event& event) {
    const double time_s = kOrigin_s + static_cast<double>(event.scan()) / made.rate_hz;
    const std::vector<std::pair<double, std::string>> texts{{time_s, wire::to_json(event)}};
    EXPECT_TRUE(writer->write_texts(events, texts, {}).has_value());
  };
  v1::Event begin;
  begin.set_host_time_ns(10'000'000'000);
  static_cast<void>(begin.mutable_segment_start());
  tell(begin);
  const auto scans = static_cast<std::uint64_t>(made.length_s * made.rate_hz);
  const auto block = static_cast<std::uint64_t>(made.rate_hz);
  for (std::uint64_t first = 0; first < scans; first += block) {
    std::vector<double> values;
    for (std::uint64_t scan = first; scan < std::min(scans, first + block); ++scan) {
      const double t_s = static_cast<double>(scan) / made.rate_hz;
      values.insert(values.end(), {made.ml_mm(t_s), made.ap_mm(t_s), 700.0});
    }
    EXPECT_TRUE(
        writer->write_samples(cop, kOrigin_s + static_cast<double>(first) / made.rate_hz, values, {.first_scan = {first}}).has_value());
  }
  for (const MadeStep& step : made.steps) tell(event_of(step, static_cast<std::uint64_t>(std::llround(step.at_s * made.rate_hz))));
  for (const v1::Event& event : made.events) tell(event);
  EXPECT_TRUE(writer->synchronise().has_value());
  const auto closed = writer->close();
  EXPECT_TRUE(closed.has_value());
  return closed ? closed->file : std::string();
}

}  // namespace dts::report
