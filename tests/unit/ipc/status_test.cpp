// SPDX-License-Identifier: Apache-2.0
// What the status says: whole messages, every input with a value of its own.
#include <gtest/gtest.h>

#include "ipc/encode.h"
#include "unit/ipc/message_text.h"
#include "unit/session/floor_config.h"

namespace dts::ipc {
namespace {

TEST(LatencyHistogram, BucketsAddUpToAnInfiniteOne) {
  session::LatencyReport report;
  for (const double ms : {0.4, 3.0, 4.0, 5000.0}) report.add(ms);
  std::string expected;
  const struct {
    const char* upper;
    int total;
  } buckets[]{{"0.1", 0}, {"0.2", 0}, {"0.5", 1}, {"1", 1},   {"2", 1},   {"5", 3},    {"10", 3},
              {"20", 3},  {"50", 3},  {"100", 3}, {"200", 3}, {"500", 3}, {"1000", 3}, {"inf", 4}};
  for (const auto& [upper, total] : buckets) {
    expected += "buckets { upper_ms: " + std::string(upper) + (total == 0 ? "" : " blocks_total: " + std::to_string(total)) + " } ";
  }
  EXPECT_EQ(text(latency_histogram(report)), expected + "sum_ms: 5007.4");
}

class StatusTest : public ::testing::Test {
 protected:
  static std::unique_ptr<session::Rig> make_rig(core::Clock& clock, core::Doorbell& bell) {
    pipeline::RigConfig config = session::floor_config("sim:floor?seed=3");
    config.model.plate.h = {12};
    config.model.sensors.front().unloaded_gap = {5};
    config.sensor_channels = {1, 0, 2, 3};
    return session::Rig::create(config, clock, bell).value();
  }
  [[nodiscard]] dts::v1::RigStatus status() const { return status_snapshot({}, core::VirtualClock(), {state_}, {}).rigs(0); }

  core::VirtualClock clock_;
  core::Doorbell bell_;
  std::unique_ptr<session::Rig> rig_ = make_rig(clock_, bell_);
  session::RigState state_{.rig = *rig_};
};

TEST_F(StatusTest, Snapshot_SaysWhoSaysItAndWhen) {
  const core::VirtualClock clock(7'500'000'000);
  dts::v1::StatusSnapshot out =
      status_snapshot({.instance_id = 42, .version = "1.0", .boot_id = "boot", .started_ns = 5'000'000'000}, clock, {}, {"one", "two"});
  EXPECT_GT(out.utc_minus_monotonic_ns(), 0);
  out.clear_utc_minus_monotonic_ns();
  EXPECT_EQ(text(out),
            "instance_id: 42 version: \"1.0\" uptime_s: 2.5 host_time_ns: 7500000000 notices: \"one\" notices: \"two\" boot_id: \"boot\"");
}

TEST_F(StatusTest, Rig_SaysAllThatItCounts) {
  session::AcquisitionReport& acquisition = state_.acquisition;
  acquisition = {.device = device::DeviceState::Streaming,
                 .segment = 1,
                 .scans_total = 2,
                 .reconnects_total = 5,
                 .restarts_total = 10,
                 .host_time_uncertainty_ns = 12,
                 .clock_drift_ppm = 11,
                 .rate = core::Rate::create(6, 1).value()};
  acquisition.losses.add(core::GapReason::Silence, {.gaps = 4, .scans = 3});
  state_.pipeline = {.us_per_scan = 15};
  state_.published = {.lost_frames = 13, .lost_events = 14};
  state_.tare.outcome = pipeline::TareOutcome::Done;
  state_.session = {.id = "s1", .state = session::SessionState::Running, .elapsed_s = 16, .message = "m\xFF"};
  state_.session.request = {
      .protocol = "reach", .subject = "P7", .label = "before", .duration_s = 17, .settle_s = 18, .fields = {{"b", "2"}, {"a\xFF", "1"}}};
  state_.recording = {.is_recording = true, .file = "f\xFF", .bytes = 19, .lost_scans = 20, .problem = "p\xFF", .lag_s = 21};
  state_.part = 22;
  state_.trial = session::TrialView{.phase = session::TrialPhase::Resting,
                                    .trial = 23,
                                    .attempt = 24,
                                    .block = 25,
                                    .of = 26,
                                    .condition = "80",
                                    .next_trial = 30,
                                    .next_condition = "120",
                                    .next_target_cm = 27,
                                    .remaining_s = 28};
  state_.measured_rate_hz = 29;
  state_.ring_fill = {.frames_percent = 31, .record_percent = 32};
  state_.published.latency.add(3);

  dts::v1::RigStatus out = status();
  EXPECT_EQ(text(out.rig()), text(rig_info(*rig_)));
  EXPECT_EQ(text(out.latency()), text(latency_histogram(state_.published.latency)));
  out.clear_rig();
  out.clear_latency();
  EXPECT_EQ(
      text(out),
      "device: DEVICE_STATE_STREAMING segment: 1 scans_total: 2 lost_scans_total: 3 gaps_total: 4 reconnects_total: 5 "
      "dropped_blocks_total: 13 nominal_rate_hz: 6 measured_rate_hz: 29 pipeline_us_per_scan: 15 tare: TARE_STATE_DONE "
      "session { session_id: \"s1\" rig: \"floor\" state: SESSION_STATE_RUNNING protocol: \"reach\" subject: \"P7\" label: \"before\" "
      "duration_s: 17 elapsed_s: 16 settle_s: 18 message: \"m\\357\\277\\275\" "
      "recording { is_recording: true part: 22 file: \"f\\357\\277\\275\" bytes: 19 lost_scans_total: 20 problem: \"p\\357\\277\\275\" } "
      "trial { phase: TRIAL_PHASE_RESTING trial: 23 attempt: 24 block: 25 of: 26 condition: \"80\" next_condition: \"120\" "
      "next_target_cm: 27 remaining_s: 28 next_trial: 30 } fields { key: \"a\\357\\277\\275\" value: \"1\" } fields { key: \"b\" value: \"2\" } } "
      "restarts_total: 10 clock_drift_ppm: 11 host_time_uncertainty_ns: 12 lost_events_total: 14 "
      "losses { reason: GAP_REASON_SILENCE gaps_total: 4 lost_scans_total: 3 } "
      "ring_fill { frames_percent: 31 record_percent: 32 } record_lag_s: 21");
}

TEST_F(StatusTest, SensorProblems_AreShownWhereTheDeviceItselfHasNone) {
  state_.sensor_problems = "sensor ch3 does not change";
  EXPECT_EQ(status().device_message(), "sensor ch3 does not change");
  state_.acquisition.set_message("the device fell silent");
  EXPECT_EQ(status().device_message(), "the device fell silent");
}

TEST_F(StatusTest, TheDriftOfAForcePlate_IsShownOnceItIsKnown) {
  EXPECT_FALSE(status().has_zero_drift_n_per_min());
  state_.tare.drift_n_per_min = -0.25;
  EXPECT_EQ(status().zero_drift_n_per_min(), -0.25);
}

TEST_F(StatusTest, Words_OfDeviceAndTare) {
  using device::DeviceState;
  using pipeline::TareOutcome;
  const DeviceState devices[]{DeviceState::Closed, DeviceState::Open, DeviceState::Streaming, DeviceState::Gone};
  for (const DeviceState device : devices) {
    state_.acquisition.device = device;
    EXPECT_EQ(status().device(), static_cast<int>(device) + 1);
  }
  state_.acquisition.is_armed = true;
  EXPECT_EQ(status().device(), dts::v1::DEVICE_STATE_WAITING);
  for (const auto& [outcome, shown] : {std::pair(TareOutcome::None, dts::v1::TARE_STATE_UNSPECIFIED),
                                       {TareOutcome::Running, dts::v1::TARE_STATE_RUNNING},
                                       {TareOutcome::Done, dts::v1::TARE_STATE_DONE},
                                       {TareOutcome::Loaded, dts::v1::TARE_STATE_LOADED},
                                       {TareOutcome::Unsteady, dts::v1::TARE_STATE_UNSTEADY},
                                       {TareOutcome::BadSensor, dts::v1::TARE_STATE_BAD_SENSOR}}) {
    state_.tare = {.outcome = outcome};
    EXPECT_EQ(status().tare(), shown);
    state_.tare.is_older_in_use = true;
    EXPECT_EQ(status().tare(), dts::v1::TARE_STATE_DONE) << "a refused tare leaves the one before it in use";
  }
}

TEST_F(StatusTest, Rig_IsDescribedAsItWasConfigured) {
  v1::RigInfo out = rig_info(*rig_);
  ASSERT_EQ(out.sensors_size(), 4);
  EXPECT_EQ(text(out.sensors(0)),
            "label: \"w1\" x_mm: 86 y_mm: 86 channel: \"ch1\" curve: \"hoa1405-assumed\" unloaded_gap_mm: 5 range_low_v: -5 "
            "range_high_v: 4.9951171875");
  EXPECT_TRUE(text(out.sensors(1)).starts_with("label: \"w2\" x_mm: 344 y_mm: 86 channel: \"ch0\" "));
  ASSERT_EQ(out.streams_size(), 5);
  EXPECT_EQ(text(out.streams(3)),
            "name: \"cop\" rate { numerator: 1500 denominator: 1 } channels { name: \"ml_mm\" unit: \"mm\" } "
            "channels { name: \"ap_mm\" unit: \"mm\" } channels { name: \"load_n\" unit: \"N\" } delay_ns: 666666");
  EXPECT_EQ(std::vector(out.stages().begin(), out.stages().end()), rig_->stage_texts());
  out.clear_sensors();
  out.clear_streams();
  out.clear_stages();
  EXPECT_EQ(text(out),
            "name: \"floor\" kind: \"floor\" device_uri: \"sim:floor?seed=3\" plate_a_mm: 430 plate_b_mm: 430 plate_h_mm: 12 "
            "published: \"raw\" published: \"cop\"");
}

}  // namespace
}  // namespace dts::ipc
