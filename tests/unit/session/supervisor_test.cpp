// SPDX-License-Identifier: Apache-2.0
// What clients ask of the rigs, and what the supervisor reports by itself, on a device that the test feeds.
#include "session/supervisor.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "supervisor_fixture.h"
#include "unit/physics/cop/constant_two_feet.h"

namespace dts::session {
namespace {

using core::ErrorCode;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(SupervisorTest, MarkerWithATime_StandsAtTheScanOfThatTime) {
  RecordProperty("requirement", "SES-7");
  open();
  run();
  feed(2 * kBlock);
  const auto newest = supervisor_->mark("floor", "x").value().front().at;
  static_cast<void>(taken_events(v1::Event::kMarker));
  constexpr std::int64_t kScans = 3;
  const std::int64_t earlier_ns = newest.host_time_ns - kScans * core::kNanosecondsPerSecond / 1500;

  const auto marks = supervisor_->mark("floor", "x", earlier_ns).value();
  EXPECT_EQ(marks.front().at.segment, newest.segment);
  EXPECT_EQ(marks.front().at.scan.value, newest.scan.value - kScans);
  const auto events = taken_events(v1::Event::kMarker);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].host_time_ns(), earlier_ns);
  for (const std::int64_t beyond_ns : {-6 * core::kNanosecondsPerSecond, 2 * core::kNanosecondsPerSecond}) {
    EXPECT_THAT(why_refused(supervisor_->mark("floor", "x", clock_.now_ns() + beyond_ns), ErrorCode::InvalidArgument),
                HasSubstr("5 s before now"));
  }
  EXPECT_THAT(taken_events(v1::Event::kMarker), IsEmpty());
}

TEST_F(SupervisorTest, MarkerFromBeforeAGap_StandsAtTheFirstScanAfterIt_WithItsOwnTime) {
  open();
  run();
  feed(2 * kBlock);
  const std::int64_t before_ns = supervisor_->mark("floor", "x").value().front().at.host_time_ns;
  give({.outcome = device::ReadOutcome::Gap, .gap = {.reason = core::GapReason::Overrun, .missing_scans = 5, .is_exact = true}});
  feed(kBlock);
  static_cast<void>(taken_events(v1::Event::kMarker));

  const PlacedMark mark = supervisor_->mark("floor", "x", before_ns).value().front();

  EXPECT_EQ(mark.at.segment, 1U);
  EXPECT_EQ(mark.at.scan.value, 0U);
  const auto events = taken_events(v1::Event::kMarker);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].host_time_ns(), before_ns);
}

TEST_F(SupervisorTest, Marker_HasOneTo200BytesAndStandsAtTheNewestScan) {
  open();
  EXPECT_THAT(why_refused(supervisor_->mark("", "x")), HasSubstr("no rig delivers"));
  EXPECT_THAT(why_refused(supervisor_->mark("floor", "x")), HasSubstr("rig 'floor' delivers no scans"));
  run();
  feed(2 * kBlock);
  for (const std::size_t size : {0U, 201U}) {
    EXPECT_THAT(why_refused(supervisor_->mark("", std::string(size, 'x')), ErrorCode::InvalidArgument),
                HasSubstr("this one " + std::to_string(size)));
  }
  EXPECT_THAT(why_refused(supervisor_->mark("chair", "x"), ErrorCode::NotFound), AllOf(HasSubstr("'chair'"), HasSubstr("known: floor")));
  EXPECT_THAT(taken_events(v1::Event::kMarker), IsEmpty());

  for (const char* rig : {"", "floor"}) {
    const auto marks = supervisor_->mark(rig, std::string(200, 'x'));
    ASSERT_TRUE(marks);
    ASSERT_EQ(marks->size(), 1U);
    EXPECT_EQ(marks->at(0).rig, "floor");
    const auto notices = taken_events(v1::Event::kMarker);
    ASSERT_EQ(notices.size(), 1U);
    EXPECT_EQ(notices[0].marker().text(), std::string(200, 'x'));
    EXPECT_EQ(notices[0].segment(), 0U);
    EXPECT_EQ(notices[0].scan(), 2 * kBlock - 1);
    EXPECT_NEAR(static_cast<double>(clock_.now_ns() - notices[0].host_time_ns()), 1e9 / 1500.0, 2.0);
  }
}

TEST_F(SupervisorTest, TwoRigsOfOneName_AreRefused) {
  open();
  auto second = Rig::create(config_, std::make_unique<HandFedDevice>(4), clock_, bell_).value();
  EXPECT_THAT(why_refused(supervisor_->add(std::move(second)), ErrorCode::InvalidArgument), HasSubstr("two rigs are named 'floor'"));
}

TEST_F(SupervisorTest, SerialPorts_AreListedUntilARigUsesThem) {
  namespace fs = std::filesystem;
  for (const std::string name : {"ttyACM0", "ttyACM1"}) {
    const fs::path device = folder_ / "sys/devices" / name;
    fs::create_directories(device / "interface/tty" / name);
    std::ofstream(device / "idVendor") << "2341";
    std::ofstream(device / "idProduct") << "0043";
    fs::create_directories(folder_ / "sys/class/tty");
    fs::create_directory_symlink(device / "interface", device / "interface/tty" / name / "device");
    fs::create_directory_symlink(device / "interface/tty" / name, folder_ / "sys/class/tty" / name);
  }
  recordings_ = Recordings::open(storage_, clock_, log_).value();
  supervisor_ = std::make_unique<Supervisor>(
      clock_, log_, nullptr, SessionServices{.recordings = *recordings_, .worker = worker_, .ports_root = folder_.string()});
  EXPECT_EQ(supervisor_->unused_ports().size(), 2U);
  config_.device_uri = "serial:/dev/ttyACM0?channels=4";
  ASSERT_TRUE(supervisor_->add(Rig::create(config_, std::make_unique<HandFedDevice>(4), clock_, bell_).value()));
  const auto unused = supervisor_->unused_ports();
  ASSERT_EQ(unused.size(), 1U);
  EXPECT_EQ(unused[0].uri, "serial:/dev/ttyACM1?channels=N");
}

TEST_F(SupervisorTest, SeveralRigs_ASessionIsNamedByItsRig) {
  open();
  for (const char* name : {"chair", "wall"}) {
    config_.name = name;
    ASSERT_TRUE(supervisor_->add(Rig::create(config_, std::make_unique<HandFedDevice>(4), clock_, bell_).value()));
  }
  run();
  EXPECT_THAT(why_refused(supervisor_->session("no"), ErrorCode::NotFound), HasSubstr("known: chair, floor, wall"));
  EXPECT_THAT(why_refused(supervisor_->stop_session("")), HasSubstr("no rig has a session"));
  ASSERT_TRUE(supervisor_->start_session("wall", {}));
  EXPECT_THAT(why_refused(supervisor_->trial("", TrialAction::Next)), HasSubstr("rig 'wall' has no session with trials"));
  ASSERT_TRUE(supervisor_->start_session("floor", {}));
  EXPECT_THAT(why_refused(supervisor_->stop_session(""), ErrorCode::InvalidArgument), HasSubstr("choose one: --rig floor or --rig wall"));
  EXPECT_TRUE(supervisor_->stop_session("floor"));
  EXPECT_EQ(supervisor_->session("wall")->state, SessionState::Starting);
}

TEST_F(SupervisorTest, DeviceAndItsGaps_AreToldOnce) {
  open();
  device_->is_absent = true;
  run();
  while (rig().acquisition().text().empty()) std::this_thread::yield();
  supervisor_->tick();
  supervisor_->tick();
  auto notices = taken_events(v1::Event::kDevice);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_THAT(notices[0].device().message(), HasSubstr("not plugged in"));
  EXPECT_EQ(notices[0].scan(), 0U);
  EXPECT_THAT(log(), AllOf(HasSubstr("rig 'floor': Hand-fed device (hand:fed)"), HasSubstr("[warning]"), HasSubstr("not plugged in")));
  EXPECT_THAT(why_refused(supervisor_->start_session("floor", {})), HasSubstr("delivers nothing: "));
  EXPECT_THAT(why_refused(supervisor_->tare("floor")), HasSubstr("is not streaming"));

  device_->is_absent = false;
  clock_.advance_s(5.0);
  feed(kBlock);
  supervisor_->tick();
  supervisor_->tick();
  notices = taken_events(v1::Event::kDevice);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices[0].device().state(), v1::DEVICE_STATE_STREAMING);
  EXPECT_EQ(notices[0].device().uri(), "hand:fed");
  EXPECT_EQ(notices[0].device().message(), "");
  EXPECT_THAT(log(), AllOf(HasSubstr("[info] rig 'floor': device streaming\n"), testing::Not(HasSubstr("missing"))));

  const auto gap = [](core::GapReason reason, std::uint64_t scans, bool is_exact) {
    return HandFedDevice::Given{.outcome = device::ReadOutcome::Gap,
                                .gap = {.reason = reason, .missing_scans = scans, .is_exact = is_exact}};
  };
  give(gap(core::GapReason::Overrun, 5, true));
  feed(kBlock);
  supervisor_->tick();
  supervisor_->tick();
  EXPECT_THAT(log(), testing::EndsWith("rig 'floor': 5 scans missing before segment 1, overrun\n"));
  for (const std::uint64_t scans : {6U, 7U, 800U}) {
    give(gap(core::GapReason::Integrity, scans, scans != 800));
    feed(kBlock);
  }
  supervisor_->tick();
  EXPECT_THAT(log(), HasSubstr("rig 'floor': about 800 scans missing before segment 4, integrity (and 2 more gaps before it)\n"));
}

TEST_F(SupervisorTest, MeasuredRate_IsThatOfAtLeastTwoSeconds_AndNoneInSilence) {
  start();
  supervisor_->tick();
  EXPECT_EQ(now().measured_rate_hz, 0.0);
  pass(1.99, 0.01);
  EXPECT_EQ(now().measured_rate_hz, 0.0);
  pass(0.01, 0.01);
  EXPECT_NEAR(now().measured_rate_hz, 1500.0, 1e-6);
  for (int block = 0; block < 201; ++block) {  // the device slows down
    clock_.advance_s(0.005);
    pass(0.01, 0.01);
    if (block == 100) {
      EXPECT_NEAR(now().measured_rate_hz, 1500.0, 1e-6) << "until the next two seconds are over";
    }
  }
  EXPECT_NEAR(now().measured_rate_hz, 1000.0, 5.0);
  silence(1.9);
  EXPECT_GT(now().measured_rate_hz, 0.0);
  silence(0.2);
  EXPECT_EQ(now().measured_rate_hz, 0.0);
  pass(0.1);
  EXPECT_EQ(now().measured_rate_hz, 0.0) << "two seconds anew";
}

TEST_F(SupervisorTest, DeviceTest_HasAWholeSecondOrSaysWhyNot) {
  open();
  device_->is_absent = true;
  run();
  while (rig().acquisition().text().empty()) std::this_thread::yield();
  EXPECT_THAT(why_refused(supervisor_->test_device("floor"), ErrorCode::DeviceGone),
              AllOf(HasSubstr("rig 'floor'"), HasSubstr("not plugged in")));
  device_->found.checks = {{.name = "power", .outcome = device::DeviceCheck::Outcome::Failed, .detail = "none"}};
  const auto failed = supervisor_->test_device("floor");
  ASSERT_TRUE(failed);
  EXPECT_THAT(failed->problem, HasSubstr("not plugged in"));
  EXPECT_EQ(failed->report.checks.size(), 1U);
  EXPECT_EQ(failed->statistics.scans, 0U);

  device_->is_absent = false;
  clock_.advance_s(5.0);
  feed(99 * kBlock);
  EXPECT_THAT(why_refused(supervisor_->test_device("floor")), HasSubstr("has not streamed for a second yet"));
  feed(kBlock);
  const auto fine = supervisor_->test_device("floor");
  ASSERT_TRUE(fine);
  EXPECT_EQ(fine->problem, "");
  EXPECT_EQ(fine->statistics.scans, 1500U);
  EXPECT_EQ(fine->statistics.channels[3].minimum, HandFedDevice::volts(3, 400));
  EXPECT_EQ(fine->rig, &rig());

  give({.outcome = device::ReadOutcome::Armed});
  while (!rig().acquisition().is_armed) std::this_thread::yield();
  EXPECT_THAT(supervisor_->test_device("floor")->problem, HasSubstr("trigger"));
}

TEST_F(SupervisorTest, Tare_KeepsSessionsAwayUntilItIsAnsweredOrWithdrawn) {
  start();
  const auto request = supervisor_->tare("floor");
  ASSERT_TRUE(request);
  EXPECT_THAT(why_refused(supervisor_->start_session("floor", {})), HasSubstr("rig 'floor' is being tared"));
  supervisor_->cancel_tare("floor", *request + 1);  // not this one
  EXPECT_NE(why_refused(supervisor_->start_session("floor", {})), "");
  supervisor_->cancel_tare("chair", *request);
  supervisor_->cancel_tare("floor", *request);
  ASSERT_TRUE(supervisor_->start_session("floor", {}));
  EXPECT_THAT(why_refused(supervisor_->tare("floor")), HasSubstr("has a session"));
  ASSERT_TRUE(supervisor_->stop_session(""));
  ASSERT_TRUE(eventually([&] { return !now().recording.is_recording && state() != SessionState::Stopping; }));

  const auto second = supervisor_->tare("floor").value();
  EXPECT_GT(second, *request);
  EXPECT_TRUE(eventually([&] { return supervisor_->start_session("floor", {}).has_value(); }));
  EXPECT_GE(supervisor_->tare_report("floor")->request, second);
  EXPECT_EQ(supervisor_->tare_report("floor")->outcome, now().tare.outcome);
}

TEST_F(SupervisorTest, RigWithoutStages_CannotBeTared) {
  config_.stages.resize(2);  // checks and filters
  config_.published = {"raw"};
  start();
  EXPECT_THAT(why_refused(supervisor_->tare("floor"), ErrorCode::Unsupported), HasSubstr("has no stage that tares"));
}

TEST_F(SupervisorTest, SyncPulse_RisesWithTheFirstScanOfASessionAndFallsAfterItsTime) {
  config_.sync_pulse_ms = 100.0;
  start();
  pass(0.1);
  EXPECT_THAT(device_->sync_outputs, IsEmpty());
  ASSERT_TRUE(supervisor_->start_session("floor", {}));
  supervisor_->tick();
  EXPECT_THAT(device_->sync_outputs, IsEmpty()) << "no scan yet";
  pass(0.01, 0.01);
  EXPECT_THAT(device_->sync_outputs, ElementsAre(true));
  pass(0.09, 0.01);
  EXPECT_THAT(device_->sync_outputs, ElementsAre(true));
  device_->sync_answer = core::fail(ErrorCode::WrongState, "starting");
  pass(0.01, 0.01);
  EXPECT_THAT(device_->sync_outputs, ElementsAre(true, false));
  EXPECT_THAT(log(), HasSubstr("rig 'floor': the sync pulse did not end: "));
  pass(0.99, 0.01);
  EXPECT_EQ(device_->sync_outputs.size(), 2U) << "tried again after a second";
  device_->sync_answer = {};
  pass(0.01, 0.01);
  EXPECT_THAT(device_->sync_outputs, ElementsAre(true, false, false));
  pass(2.0);
  EXPECT_EQ(device_->sync_outputs.size(), 3U);

  ASSERT_TRUE(stop());
  device_->sync_outputs.clear();
  static_cast<void>(taken_events(v1::Event::kDevice));
  device_->sync_answer = core::fail(ErrorCode::DeviceGone, "away");
  static_cast<void>(record(kBlock));
  pass(0.5);
  EXPECT_THAT(device_->sync_outputs, ElementsAre(true)) << "what did not rise does not fall";
  const auto notices = taken_events(v1::Event::kDevice);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_THAT(notices[0].device().message(), HasSubstr("no sync pulse: away"));
  EXPECT_EQ(notices[0].device().state(), v1::DEVICE_STATE_STREAMING);

  ASSERT_TRUE(stop());
  device_->sync_answer = {};
  static_cast<void>(record(kBlock));
  device_->sync_outputs.clear();
  device_->sync_answer = core::fail(ErrorCode::DeviceGone, "away");
  pass(2.0);
  EXPECT_THAT(device_->sync_outputs, ElementsAre(false)) << "a device that is away forgets its outputs";
  ASSERT_TRUE(stop());
  device_->sync_answer = {};
  static_cast<void>(record(kBlock));
  device_->sync_outputs.clear();
  supervisor_->stop();
  EXPECT_THAT(device_->sync_outputs, ElementsAre(false)) << "the daemon ends, and the pulse with it";
}

TEST_F(SupervisorTest, SyncPulseTrain_RepeatsWithItsPeriodUntilTheSessionEnds) {
  RecordProperty("requirement", "ACQ-18");
  config_.sync_pulse_ms = 100.0;
  config_.sync_pulse_every_ms = 1000.0;
  start();
  static_cast<void>(record(kBlock));
  device_->sync_outputs.clear();
  pass(0.9);
  const std::size_t first = device_->sync_outputs.size();
  pass(4.0);
  EXPECT_EQ(device_->sync_outputs.size(), first + 8U) << "four pulses, each of them up and down";

  silence(2.35);  // the control thread was late: the train keeps its grid and sends no pulses in the past
  pass(0.1);
  device_->sync_outputs.clear();
  pass(3.0);
  EXPECT_THAT(device_->sync_outputs.size(), testing::AllOf(testing::Ge(5U), testing::Le(7U)));

  static_cast<void>(taken_events(v1::Event::kDevice));
  device_->sync_answer = core::fail(ErrorCode::DeviceGone, "away");
  pass(5.0);
  EXPECT_EQ(taken_events(v1::Event::kDevice).size(), 1U) << "one report for all pulses that the device misses";
  device_->sync_answer = {};
  pass(2.0);
  device_->sync_answer = core::fail(ErrorCode::DeviceGone, "away");
  pass(2.0);
  EXPECT_EQ(taken_events(v1::Event::kDevice).size(), 1U) << "the device was there in between";

  device_->sync_answer = {};
  ASSERT_TRUE(stop());
  pass(0.2);
  device_->sync_outputs.clear();
  pass(3.0);
  EXPECT_THAT(device_->sync_outputs, IsEmpty());
}

TEST_F(SupervisorTest, SensorsThatStandStill_AreNamed_WhileTheDeviceDelivers) {
  config_.sensor_channels = {3, 2, 1, 0};
  start();
  feed(3000);
  EXPECT_EQ(now().sensor_problems, "");
  device_->stuck_channel = 2;
  feed(30'000);
  EXPECT_THAT(now().sensor_problems, HasSubstr(": ch2 (unchanged): check"));
  give({.outcome = device::ReadOutcome::Armed});
  while (!rig().acquisition().is_armed) std::this_thread::yield();
  EXPECT_EQ(now().sensor_problems, "");
}

TEST_F(SupervisorTest, LoadBeyondTheTravelOfTheSensors_IsReportedWithWhatToDo) {
  const auto samples = physics::model_samples(physics::CopMethod::Poly3, config_.model, physics::PlateBehaviour::Linear).value();
  config_.cop_calibration =
      physics::calibrate_cop(physics::CopMethod::Poly3, samples, {.created_utc = "2026-01-31T12:00:00Z", .rig = "floor"}).value();
  physics::TwoFeetForm form = physics::test::constant_form();
  form.travel_mm = 0.001;
  config_.cop_calibration->two_feet = physics::TwoFeetCorrection::from_form(form).value();
  start();
  EXPECT_EQ(now().sensor_problems, "");
  feed(3000);  // a person settles
  EXPECT_THAT(now().sensor_problems, HasSubstr("ask the person to stand in the middle"));
  clock_.advance_s(3.0);
  EXPECT_EQ(now().sensor_problems, "") << "the person left";
}

}  // namespace
}  // namespace dts::session
