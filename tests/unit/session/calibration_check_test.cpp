// SPDX-License-Identifier: Apache-2.0
// A calibration of the centre of pressure, or a sensor curve, that was measured with another device than the rig's; and one that is old.
#include "session/calibration_check.h"

#include <gmock/gmock.h>

#include <utility>

#include "core/notice_words.h"
#include "supervisor_fixture.h"

namespace dts::session {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::int64_t kDayNs = 86'400 * core::kNanosecondsPerSecond;
constexpr std::int64_t kMeasuredNs = 1'769'860'800 * core::kNanosecondsPerSecond;  // 2026-01-31T12:00:00Z, as below

physics::CopCalibration calibration_of(physics::CopCalibrationOrigin origin) {
  static const auto samples =
      physics::model_samples(physics::CopMethod::Poly3, floor_config("").model, physics::PlateBehaviour::Linear).value();
  origin.created_utc = "2026-01-31T12:00:00Z";
  return physics::calibrate_cop(physics::CopMethod::Poly3, samples, std::move(origin)).value();
}

std::string only_warning(const pipeline::RigConfig& config, const device::DeviceDescription& described, const device::DeviceReport& report,
                         std::int64_t now_utc_ns = kMeasuredNs) {
  const auto warnings = calibration_warnings(config, described, report, now_utc_ns);
  EXPECT_LE(warnings.size(), 1U);
  return warnings.empty() ? "" : warnings.front();
}

std::string warning_of(const physics::CopCalibrationOrigin& origin, const std::string& address = "mcc:usb-1408fs",
                       const std::string& model = "USB-1408FS", const std::string& serial = "11", const std::string& own_model = "",
                       std::int64_t now_utc_ns = kMeasuredNs) {
  pipeline::RigConfig config = floor_config(address);
  config.cop_calibration = calibration_of(origin);
  device::DeviceDescription device;
  device.model = model;
  return only_warning(config, device, {.model = own_model, .serial = serial}, now_utc_ns);
}

TEST(CalibrationCheck, AnotherDeviceIsNamed) {
  RecordProperty("requirement", "COP-14");
  EXPECT_EQ(warning_of({.rig = "floor", .daq_model = "USB-1408FS", .daq_serial = "11"}), "");
  EXPECT_EQ(warning_of({.rig = "floor", .daq_model = "LabJack U6", .daq_serial = "3"}),
            "rig 'floor': the calibration of 2026-01-31 was measured with LabJack U6 3, not with USB-1408FS 11; calibrate again: dtsctl "
            "calibrate cop --rig floor");
  EXPECT_THAT(warning_of({.rig = "floor", .daq_model = "Simulated floor platform", .daq_serial = "sim-floor-7"}),
              HasSubstr("was measured with Simulated floor platform sim-floor-7, not with USB-1408FS 11;"));
  EXPECT_THAT(warning_of({.rig = "floor", .daq_model = "USB-1408FS", .daq_serial = "11"}, "sim:floor", "Simulated floor platform"),
              HasSubstr("was measured with USB-1408FS 11, not with Simulated floor platform 11;"));
}

TEST(CalibrationCheck, AnotherUnitOfTheSameModelNeedsAComparison) {
  const physics::CopCalibrationOrigin of_12{.rig = "floor", .daq_model = "USB-1408FS", .daq_serial = "12"};
  EXPECT_EQ(warning_of(of_12),
            "rig 'floor': the calibration of 2026-01-31 was measured with USB-1408FS 12, and the device is 11, another unit of the same "
            "model; compare a known weight on the middle and near each corner, or calibrate again: dtsctl calibrate cop --rig floor");
  EXPECT_EQ(warning_of(of_12, "mcc:usb-1408fs", "USB-1408FS", ""), "") << "a device without a serial number";
  EXPECT_EQ(warning_of({.rig = "floor", .daq_model = "USB-1408FS"}), "") << "measured with one";
  EXPECT_EQ(warning_of(of_12, "sim:floor?seed=8", "USB-1408FS", "sim-floor-8"), "") << "the seed of a simulated person is no other plate";
}

TEST(CalibrationCheck, AnotherRigOrNoDaqIsNamed) {
  EXPECT_EQ(warning_of({.rig = "left", .daq_model = "USB-1408FS", .daq_serial = "11"}),
            "rig 'floor': the calibration of 2026-01-31 is of rig 'left'; calibrate again: dtsctl calibrate cop --rig floor");
  EXPECT_THAT(warning_of({.rig = "a-file"}), HasSubstr("names no DAQ: it was computed from a model or from a table of loads;"));
  EXPECT_EQ(warning_of({.rig = "a-file"}, "sim:floor", "Simulated floor platform"), "") << "the simulated plate is that model";
  EXPECT_EQ(warning_of({.rig = "left", .daq_model = "LabJack U6"}, "replay:x.xdf", "LabJack U6"), "");
  EXPECT_THAT(calibration_warnings(floor_config("mcc:usb-1408fs"), {}, {.serial = "11"}, kMeasuredNs), IsEmpty()) << "no calibration";
}

TEST(CalibrationCheck, AUnitThatSaysItsModelIsComparedByIt) {
  RecordProperty("requirement", "COP-14");
  const auto of_ni = [](const physics::CopCalibrationOrigin& origin, const std::string& serial, const std::string& own_model) {
    return warning_of(origin, "ni:Dev1", "NI-DAQmx device", serial, own_model);
  };
  const physics::CopCalibrationOrigin of_6008{.rig = "floor", .daq_model = "USB-6008", .daq_serial = "01A2B3C4"};
  EXPECT_EQ(of_ni(of_6008, "01A2B3C4", "USB-6008"), "");
  EXPECT_THAT(of_ni(of_6008, "0000000A", "USB-6255"), HasSubstr("was measured with USB-6008 01A2B3C4, not with USB-6255 0000000A;"));
  EXPECT_THAT(of_ni(of_6008, "0000000A", "USB-6008"), HasSubstr(", and the device is 0000000A, another unit of the same model;"));
  EXPECT_EQ(of_ni({.rig = "floor", .daq_model = "NI-DAQmx device", .daq_serial = "Dev1"}, "0000000A", "USB-6008"), "") << "an old file";
  const physics::CopCalibrationOrigin of_port{.rig = "floor", .daq_model = "Uno", .daq_serial = "/dev/ttyACM0"};
  EXPECT_EQ(warning_of(of_port, "serial:/dev/ttyACM1", "Board that sends frames", "", "Uno"), "") << "a port is no serial number";
}

TEST(CalibrationCheck, ASerialNumberCannotDivideTheNotice) {
  const std::string warning =
      warning_of({.rig = "floor", .daq_model = "USB-1408FS", .daq_serial = "1; 2"}, "mcc:usb-1408fs", "USB-1408FS", "3; 4");
  EXPECT_THAT(warning, HasSubstr("was measured with USB-1408FS 1, 2, and the device is 3, 4, another unit of the same model; compare"));
}

TEST(CalibrationCheck, AnOldOneIsNamed_UnlessThereIsAGraverDoubt) {
  RecordProperty("requirement", "COP-15");
  const auto after_days = [](std::int64_t days, const physics::CopCalibrationOrigin& origin, const std::string& address) {
    return warning_of(origin, address, "USB-1408FS", "11", "", kMeasuredNs + days * kDayNs);
  };
  const physics::CopCalibrationOrigin own{.rig = "floor", .daq_model = "USB-1408FS", .daq_serial = "11"};
  EXPECT_EQ(after_days(180, own, "mcc:usb-1408fs"), "");
  EXPECT_EQ(after_days(181, own, "mcc:usb-1408fs"),
            "rig 'floor': the calibration of 2026-01-31 is more than 180 days old; compare a known weight on the middle and near each "
            "corner, or calibrate again: dtsctl calibrate cop --rig floor");
  EXPECT_EQ(after_days(181, own, "sim:floor"), "") << "a simulated plate does not change";
  EXPECT_EQ(after_days(181, own, "replay:x.xdf"), "");
  EXPECT_THAT(after_days(181, {.rig = "floor", .daq_model = "LabJack U6"}, "mcc:usb-1408fs"), HasSubstr("was measured with LabJack U6"));
}

/// The sensors of a floor, each with the curve that was measured at it on channels ch0 to ch3 of unit 11.
class CurveCheck : public ::testing::Test {
 protected:
  CurveCheck() {
    device_.model = "USB-1408FS";
    for (std::size_t k = 0; k < 4; ++k) {
      const std::string channel = "ch" + std::to_string(k);
      device_.channels.push_back({.name = channel});
      origin(k) = {.created_utc = "2026-01-31T12:00:00Z",
                   .rig = "floor",
                   .sensor = config_.model.sensors[k].label,
                   .daq_model = "USB-1408FS",
                   .daq_serial = "11",
                   .channel = channel};
    }
  }
  physics::SensorCurveOrigin& origin(std::size_t k) { return config_.model.sensors[k].curve_origin; }
  [[nodiscard]] std::vector<std::string> warnings() const {
    return calibration_warnings(config_, device_, {.serial = serial_}, kMeasuredNs);
  }
  [[nodiscard]] std::string warning() const { return only_warning(config_, device_, {.serial = serial_}); }

  pipeline::RigConfig config_ = floor_config("mcc:usb-1408fs");
  device::DeviceDescription device_;
  std::string serial_ = "11";
  const std::string again_ = "calibrate again: dtsctl calibrate sensor --rig floor --sensor all";
};

TEST_F(CurveCheck, CurvesOfTheirSensorsAreFine_SoAreThoseOfWhichLittleIsKnown) {
  EXPECT_EQ(warning(), "");
  origin(2) = {};
  EXPECT_EQ(warning(), "");
  origin(2) = {.created_utc = "2026-01-31T12:00:00Z", .sensor = "hoa1405"};
  EXPECT_EQ(warning(), "") << "computed from a table of readings, perhaps for all sensors of a type";
  config_.model.sensors.clear();
  EXPECT_EQ(warning(), "") << "a force plate";
}

TEST_F(CurveCheck, ExchangedFilesAreNamed) {
  RecordProperty("requirement", "SIG-8");
  std::swap(origin(0), origin(1));
  EXPECT_EQ(
      warning(),
      "rig 'floor': sensor curves (w1, w2) were measured at other sensors (w2, w1); name the file of each sensor in the rig file, or " +
          again_);
}

TEST_F(CurveCheck, OtherChannelsAreNamed) {
  RecordProperty("requirement", "SIG-8");
  std::swap(config_.sensor_channels[2], config_.sensor_channels[3]);
  EXPECT_EQ(warning(),
            "rig 'floor': sensor curves (w3, w4) were measured on channels (ch2, ch3), not on (ch3, ch2); check the wiring and channel in "
            "the rig file, or " +
                again_);
  device_.channels.clear();
  EXPECT_EQ(warning(), "") << "a device that does not name its channels";
}

TEST_F(CurveCheck, EachDaqAndRigIsNamed_WithItsSensors) {
  RecordProperty("requirement", "SIG-8");
  origin(0).daq_model = "LabJack U6";
  origin(1).rig = "left; old";
  origin(2).daq_model = "LabJack U6";
  origin(3).daq_model = "LabJack U3";
  EXPECT_THAT(warnings(),
              ElementsAre("rig 'floor': sensor curves (w2) are of rig 'left, old'; " + again_,
                          "rig 'floor': sensor curves (w4) were measured with LabJack U3 11, not with USB-1408FS 11; " + again_,
                          "rig 'floor': sensor curves (w1, w3) were measured with LabJack U6 11, not with USB-1408FS 11; " + again_));
  std::swap(origin(0).sensor, origin(1).sensor);
  EXPECT_THAT(warnings(), Contains(HasSubstr("sensor curves (w1) were measured at other sensors (w2);"))) << "also with another DAQ";
}

TEST_F(CurveCheck, AnotherUnitOfTheSameModelNeedsAComparison) {
  RecordProperty("requirement", "SIG-8");
  serial_ = "12";
  EXPECT_EQ(warning(),
            "rig 'floor': sensor curves (w1, w2, w3, w4) were measured with USB-1408FS 11, and the device is 12, another unit of the same "
            "model; compare a known distance, or " +
                again_);
  serial_ = "";
  EXPECT_EQ(warning(), "") << "a device without a serial number";
}

TEST_F(CurveCheck, AReplayAndTheSimulatorHaveTheVoltsOfTheirCurves) {
  std::swap(origin(0), origin(1));
  origin(2).daq_model = "LabJack U6";
  for (const char* address : {"replay:x.xdf", "sim:floor"}) {
    config_.device_uri = address;
    EXPECT_EQ(warning(), "") << address;
  }
}

TEST_F(CurveCheck, StandsBehindTheWarningOfTheCop) {
  config_.cop_calibration = calibration_of({.rig = "floor", .daq_model = "LabJack U6"});
  origin(0).daq_model = "LabJack U6";
  EXPECT_THAT(warnings(),
              ElementsAre(HasSubstr("the calibration of 2026-01-31 was measured with LabJack U6"), HasSubstr("sensor curves (w1)")));
}

TEST(CalibrationCheck, HasTheWordsByWhichDoctorFindsIt) {
  RecordProperty("requirement", "COP-14");
  const std::string begin = "rig 'floor': " + std::string(core::notice_words::kCalibrationAfterRig);
  const auto has_words = [&](const std::string& warning, std::string_view words) {
    return warning.starts_with(begin) && warning.substr(0, warning.find("; ")).find(words) != std::string::npos;
  };
  const std::string other_unit = warning_of({.rig = "floor", .daq_model = "USB-1408FS", .daq_serial = "12"});
  EXPECT_TRUE(has_words(other_unit, core::notice_words::kOtherUnit)) << other_unit;
  EXPECT_TRUE(has_words(warning_of({.rig = "a-file"}), core::notice_words::kNoDaq));
  const std::string old =
      warning_of({.rig = "floor", .daq_model = "USB-1408FS"}, "mcc:usb-1408fs", "USB-1408FS", "11", "", kMeasuredNs + 181 * kDayNs);
  EXPECT_TRUE(has_words(old, core::notice_words::kOldCalibration)) << old;
  EXPECT_TRUE(has_words(warning_of({.rig = "floor", .daq_model = "LabJack U6"}), ""));
  EXPECT_TRUE(has_words(warning_of({.rig = "left", .daq_model = "USB-1408FS"}), ""));
}

TEST_F(CurveCheck, HasTheWordsByWhichDoctorFindsIt) {
  RecordProperty("requirement", "SIG-8");
  const std::string begin = "rig 'floor': " + std::string(core::notice_words::kSensorCurvesAfterRig);
  serial_ = "12";
  EXPECT_TRUE(warning().starts_with(begin));
  EXPECT_TRUE(warning().substr(0, warning().find("; ")).ends_with(core::notice_words::kOtherUnit));
  std::swap(origin(0), origin(1));
  for (const std::string& each : warnings()) EXPECT_TRUE(each.starts_with(begin)) << each;
}

class CalibrationWarningTest : public SupervisorTest {};

TEST_F(CalibrationWarningTest, StandsInTheStatusAndInTheLogWhileTheUnitIsThere) {
  RecordProperty("requirement", "COP-14");
  config_.cop_calibration = calibration_of({.rig = "floor", .daq_model = "Hand-fed device", .daq_serial = "H7"});
  open();
  device_->found.serial = "H8";
  run();
  feed(kBlock);
  ASSERT_TRUE(eventually([&] { return !supervisor_->warnings().empty(); }));
  EXPECT_THAT(supervisor_->warnings(), ElementsAre(HasSubstr("measured with Hand-fed device H7, and the device is H8, another unit")));
  EXPECT_THAT(log(), HasSubstr("the calibration of 2026-01-31 was measured with Hand-fed device H7"));
  ASSERT_TRUE(supervisor_->start_session("floor", {})) << "it stops nothing";
}

TEST_F(CalibrationWarningTest, IsAbsentForTheUnitOfTheCalibration_UntilItIsOld) {
  RecordProperty("requirement", "COP-15");
  config_.cop_calibration = calibration_of({.rig = "floor", .daq_model = "Hand-fed device", .daq_serial = "H7"});
  clock_.set_by_ns = kMeasuredNs - clock_.now_ns() - clock_.utc_minus_monotonic_ns();
  open();
  device_->found.serial = "H7";
  run();
  feed(kBlock);
  ASSERT_TRUE(eventually([&] { return rig().acquisition().device == device::DeviceState::Streaming; }));
  supervisor_->tick();
  EXPECT_THAT(supervisor_->warnings(), IsEmpty());
  clock_.set_by_ns += 181 * kDayNs;
  supervisor_->tick();
  EXPECT_THAT(supervisor_->warnings(), ElementsAre(HasSubstr("the calibration of 2026-01-31 is more than 180 days old")));
  EXPECT_THAT(log(), HasSubstr("more than 180 days old"));
  supervisor_->tick();
  EXPECT_THAT(log(), Not(HasSubstr("days old"))) << "once";
}

class WallClockTest : public SupervisorTest {};

TEST_F(WallClockTest, BehindTheNewestSession_IsReportedUntilItIsSet) {
  RecordProperty("requirement", "REC-14");
  start();
  const std::string id = record(kBlock);
  ASSERT_TRUE(stop());
  EXPECT_THAT(supervisor_->warnings(), IsEmpty());
  clock_.set_by_ns = -30 * core::kNanosecondsPerSecond;
  EXPECT_THAT(supervisor_->warnings(), IsEmpty()) << "a correction by NTP";
  clock_.set_by_ns = -2 * kDayNs;
  ASSERT_EQ(supervisor_->warnings().size(), 1U);
  EXPECT_THAT(supervisor_->warnings().front(), HasSubstr("and session " + id + " began later"));
  EXPECT_TRUE(supervisor_->warnings().front().starts_with(core::notice_words::kClockBehindBegin));
  static_cast<void>(log());
  static_cast<void>(record(kBlock));
  EXPECT_THAT(log(), HasSubstr("visits would be in the wrong order; set the clock")) << "a new session says it in the log";
  ASSERT_TRUE(stop());
  EXPECT_EQ(supervisor_->warnings().size(), 1U) << "the newest session is still the later one";
  ASSERT_TRUE(supervisor_->delete_session(id, "wrong date", false, "local"));
  EXPECT_THAT(supervisor_->warnings(), IsEmpty()) << "its date was the wrong one";
}

TEST_F(WallClockTest, DoesNotNameTheSessionOfAnErasedSubject) {
  RecordProperty("requirement", "REC-14");
  start();
  SessionRequest request;
  request.subject = "P017";
  ASSERT_TRUE(supervisor_->start_session("floor", request));
  feed(kBlock);
  ASSERT_TRUE(stop());
  clock_.set_by_ns = -86'400 * core::kNanosecondsPerSecond;
  ASSERT_EQ(supervisor_->warnings().size(), 1U);
  ASSERT_TRUE(supervisor_->erase_subject("P017", "local"));
  EXPECT_THAT(supervisor_->warnings(), IsEmpty());
}

TEST_F(WallClockTest, AfterARestart_IsReportedBeforeTheFirstSession) {
  start();
  static_cast<void>(record(kBlock));
  ASSERT_TRUE(stop());
  end();
  clock_.set_by_ns = -86'400 * core::kNanosecondsPerSecond;
  start();
  EXPECT_EQ(supervisor_->warnings().size(), 1U);
  clock_.set_by_ns = 0;
  EXPECT_THAT(supervisor_->warnings(), IsEmpty()) << "the clock was set";
}

}  // namespace
}  // namespace dts::session
