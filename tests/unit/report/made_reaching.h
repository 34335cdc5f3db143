// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "dts/wire/event_json.h"
#include "events/make.h"
#include "record/session_facts.h"
#include "record/xdf/xdf_writer.h"
#include "session/session_events.h"

namespace dts::report {

/// One trial of a made session of the reaching task.
struct MadeReach {
  std::uint32_t trial = 1;
  std::string condition = "150";
  double target_cm = 100.5;
  double rise_mm = 1.2;  ///< d2; 0: no reach.
  core::TrunkMovement movement{.trunk_class = core::TrunkClass::Moderate,
                               .probability = {0.01, 0.97, 0.02},
                               .trunk_deg = 25.0,
                               .trunk_lo_deg = 21.0,
                               .trunk_hi_deg = 29.0};
  std::uint16_t flags = 0;
  std::string outcome = "done";  ///< "done", "aborted"; "redone", "rejected" after it was done
  std::uint32_t attempt = 1;
  std::uint32_t end_segment = 1;  ///< Segment of the steps that end the trial.
};

/// What a test wants of its recording: one segment of a stream "chair/transient" at 100 Hz, 6 s per trial, the cue 1 s after its begin.
struct MadeReaching {
  record::SessionFacts facts{.session_id = "20261121T144525Z-chair-1",
                             .rig = "chair",
                             .kind = "chair",
                             .protocol = "reaching-short",
                             .subject = "P017",
                             .fields = {{"weight_kg", "68"}, {"height_cm", "175"}, {"arm_length_cm", "67"}, {"max_reach_cm", "124"}},
                             .started_utc_ns = 1'795'272'325'000'000'000,
                             .utc_minus_monotonic_ns = 1'795'272'315'000'000'000,
                             .software = "dtsd 0.1.0",
                             .device_uri = "ni6008:",
                             .device_model = "USB-6008",
                             .stages = {"transient", "reach", "classify"}};
  std::vector<MadeReach> reaches{};
  bool has_results = true;         ///< The daemon recorded the results of its trials.
  double recorded_deg_more = 0.0;  ///< The recorded results have another angle than the classes.
};

constexpr std::uint64_t kMadeTrialScans = 600;
constexpr double kMadeRestMm = 3.5;

/// The seat during one trial: at rest, a dip of 0.3 mm at 1.7 s, the maximum at 2.5 s.
inline double made_transient(const MadeReach& reach, double t_s) {
  const auto bump = [t_s](double at_s, double width_s) { return std::exp(-std::pow((t_s - at_s) / width_s, 2.0)); };
  if (reach.rise_mm == 0.0) return kMadeRestMm;
  return kMadeRestMm - 0.3 * bump(1.7, 0.12) + reach.rise_mm * bump(2.5, 0.3);
}

inline core::ReachEvent made_reach_event(const MadeReach& reach, std::uint64_t begin) {
  core::ReachEvent event{.step = core::ReachStep::Final, .number = reach.trial, .segment = 1, .scan = {begin + 320}};
  event.p1 = {{begin + 150}, kMadeRestMm};
  event.p2 = {{begin + 170}, kMadeRestMm - 0.3};
  event.p3 = {{begin + 250}, kMadeRestMm + reach.rise_mm};
  event.features = {.p1_mm = kMadeRestMm,
                    .p2_mm = kMadeRestMm - 0.3,
                    .p3_mm = kMadeRestMm + reach.rise_mm,
                    .hold_mm = 0.9 * reach.rise_mm,
                    .rise_s = 0.8,
                    .ratio_change = 0.1,
                    .smoothness = -1.9};
  event.flags = reach.flags;
  return event;
}

/// Writes it, closed; returns the file's name.
inline std::string write_reaching(const std::string& name, const MadeReaching& made) {
  constexpr double kOrigin_s = 10.0;
  constexpr double kRateHz = 100.0;
  auto writer = record::XdfWriter::create(name, record::to_facts(made.facts)).value();
  const std::uint32_t events = writer->add_stream(
      {.name = "chair/events", .content = "Markers", .value_type = record::ValueType::Text, .channels = {{.label = "event"}}});
  const std::uint32_t transient = writer->add_stream(
      {.name = "chair/transient",
       .content = "DTS",
       .value_type = record::ValueType::Float32,
       .rate = *core::Rate::create(100, 1),
       .channels = {{.label = "transient_mm", .unit = "mm"}, {.label = "ratio", .unit = "1"}, {.label = "twist", .unit = "1"}}});
  const auto add_event = [&](v1::Event event, std::uint64_t scan, std::uint32_t segment = 1) {
    event.set_segment(segment);
    event.set_scan(scan);
    const std::vector<std::pair<double, std::string>> texts{{kOrigin_s + static_cast<double>(scan) / kRateHz, wire::to_json(event)}};
    EXPECT_TRUE(writer->write_texts(events, texts, {}).has_value());
  };
  v1::Event begin;
  begin.set_host_time_ns(10'000'000'000);
  static_cast<void>(begin.mutable_segment_start());
  add_event(begin, 0);
  std::uint64_t first = 0;
  for (const MadeReach& reach : made.reaches) {
    std::vector<double> values;
    for (std::uint64_t scan = 0; scan < kMadeTrialScans; ++scan)
      values.insert(values.end(), {made_transient(reach, static_cast<double>(scan) / kRateHz), 0.0, 0.0});
    EXPECT_TRUE(
        writer->write_samples(transient, kOrigin_s + static_cast<double>(first) / kRateHz, values, {.segment = 1, .first_scan = {first}})
            .has_value());
    const auto step = [&](session::TrialEventKind kind, std::uint64_t scan) {
      const session::TrialEvent event{
          .kind = kind, .trial = reach.trial, .attempt = reach.attempt, .condition = reach.condition, .target_cm = reach.target_cm};
      add_event(session::to_event(event, made.facts.session_id), first + scan, kind == session::TrialEventKind::Go ? 1 : reach.end_segment);
    };
    step(session::TrialEventKind::Go, 100);
    session::ReachTrialResult result{.trial = reach.trial,
                                     .attempt = reach.attempt,
                                     .condition = reach.condition,
                                     .target_cm = reach.target_cm,
                                     .segment = 1,
                                     .go = {first + 100}};
    if (reach.rise_mm != 0.0) {
      result.reach = made_reach_event(reach, first);
      result.movement = reach.movement;
      add_event(events::make(*result.reach, ""), first + 320);
      add_event(events::make(core::ClassEvent{.number = reach.trial, .segment = 1, .scan = {first + 320}, .movement = reach.movement}, ""),
                first + 320);
      result.movement->trunk_deg += made.recorded_deg_more;
    }
    if (reach.outcome == "aborted") {
      step(session::TrialEventKind::Aborted, 500);
    } else {
      step(session::TrialEventKind::Done, 500);
      if (made.has_results) add_event(session::to_event(result, made.facts.session_id), first + 501);
    }
    if (reach.outcome == "redone") step(session::TrialEventKind::Redone, 510);
    if (reach.outcome == "rejected") step(session::TrialEventKind::Rejected, 510);
    first += kMadeTrialScans;
  }
  EXPECT_TRUE(writer->synchronise().has_value());
  const auto closed = writer->close();
  EXPECT_TRUE(closed.has_value());
  return closed ? closed->file : std::string();
}

}  // namespace dts::report
