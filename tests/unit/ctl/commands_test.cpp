// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "ctl/status_view.h"
#include "dts/error.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using testing::FakeController;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::reply;

/// Answers every command as a daemon with the floor platform would.
std::vector<std::string> answer(const v1::Request& request, int) {
  return {reply(request, [&request](v1::Response& response) {
    switch (request.command_case()) {
      case v1::Request::kStatus: {
        *response.mutable_status() = testing::floor_status();
        v1::RigStatus& rig = *response.mutable_status()->mutable_rigs(0);
        rig.set_scans_total(5000);
        rig.set_lost_scans_total(12);
        rig.set_gaps_total(1);
        rig.set_clock_drift_ppm(-12.34);
        rig.set_host_time_uncertainty_ns(1'204'000);
        break;
      }
      case v1::Request::kListRigs: *response.mutable_rigs()->add_rigs() = testing::floor_status().rigs(0).rig(); break;
      case v1::Request::kStartSession:
        response.mutable_session()->set_session_id("floor-1");
        response.mutable_session()->set_rig(request.start_session().rig());
        response.mutable_session()->set_label(request.start_session().label());
        response.mutable_session()->set_duration_s(request.start_session().duration_s());
        response.mutable_session()->set_settle_s(request.start_session().settle_s());
        response.mutable_session()->set_state(v1::SESSION_STATE_STARTING);
        break;
      case v1::Request::kStopSession:
        response.mutable_error()->set_code(v1::ERROR_CODE_WRONG_STATE);
        response.mutable_error()->set_what("no session");
        break;
      case v1::Request::kMark: {
        v1::MarkResponse::At& at = *response.mutable_mark()->add_marks();
        at.set_rig("floor");
        at.set_segment(2);
        at.set_scan(345);
        break;
      }
      case v1::Request::kTare: response.mutable_tare()->add_baseline_mm(0.0125); break;
      case v1::Request::kGetDevices: {
        v1::DeviceInfo& device = *response.mutable_devices()->add_devices();
        device.set_rig("floor");
        device.set_uri("sim:floor");
        device.set_state(v1::DEVICE_STATE_STREAMING);
        break;
      }
      default: {
        v1::TestDeviceResponse::ChannelTest& sensor = *response.mutable_device_test()->add_channels();
        sensor.set_name("w1_v");
        sensor.set_is_sensor(true);
        sensor.set_gap_mm(9.5);
        sensor.set_quality(v1::QUALITY_OUT_OF_RANGE);
        response.mutable_device_test()->add_channels()->set_name("trigger");
        response.mutable_device_test()->set_serial("D1");
        response.mutable_device_test()->set_firmware("1.04");
        response.mutable_device_test()->set_scans(1);
        response.mutable_device_test()->set_measured_rate_hz(0.5);
      }
    }
  })};
}

class CommandsTest : public RunTest {
 protected:
  FakeController daemon_{control_, answer};
};

TEST_F(CommandsTest, Status_TableNamesTheRigAndItsState) {
  EXPECT_EQ(run_with({"status"}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("floor"));
  EXPECT_THAT(out(), HasSubstr("streaming"));
  EXPECT_THAT(out(), HasSubstr("100.02"));
  EXPECT_EQ(talk(), "");
}

TEST_F(CommandsTest, StatusJson_MirrorsTheSnapshotWithoutUndefinedValues) {
  EXPECT_EQ(run_bare({"--endpoint", control_, "--json", "status"}), cli::kOk) << "options may stand before the command";

  const auto rig = json().at("rigs").at(0);
  EXPECT_EQ(json().at("instance_id"), 7);
  EXPECT_EQ(rig.at("device"), "streaming");
  EXPECT_EQ(rig.at("lost_scans_total"), 12);
  EXPECT_EQ(rig.at("measured_rate_hz"), 100.02);
  EXPECT_EQ(rig.at("rig").at("streams").at(0).at("channels").at(2).at("unit"), "N");
  EXPECT_FALSE(rig.contains("device_message"));
  EXPECT_FALSE(rig.contains("tare"));
  EXPECT_FALSE(rig.contains("pipeline_us_per_scan"));
}

TEST_F(CommandsTest, RigListAndShow_DescribeTheRig) {
  EXPECT_EQ(run_with({"rig", "list"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("cop raw"));

  EXPECT_EQ(run_with({"rig", "show", "floor"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("ml_mm ap_mm load_n"));
  EXPECT_THAT(out(), HasSubstr("drift -12.3 ppm, host times within 1.20 ms\n"));
  EXPECT_THAT(out(), HasSubstr("5000, lost 12 in 1 gap, segment 0, restarts 0, reconnects 0\n"));

  EXPECT_EQ(run_with({"rig", "show", "floor", "--json"}), cli::kOk);
  EXPECT_EQ(json().at("rig").at("name"), "floor");
}

TEST_F(CommandsTest, UnknownRig_ExitsWithNotFoundAndSuggests) {
  EXPECT_EQ(run_with({"rig", "show", "flor"}), 5);
  EXPECT_EQ(out(), "");
  EXPECT_EQ(talk(), "dtsctl: no rig 'flor'\n  try: did you mean floor?\n");

  EXPECT_EQ(run_with({"rig", "show", "flor", "--json"}), 5);
  EXPECT_EQ(json(), (nlohmann::json{{"error", {{"code", "not_found"}, {"message", "no rig 'flor'"}, {"hint", "did you mean floor?"}}}}));
}

TEST(NoticeLines, TheSameOfSeveralThreads_IsOneLine) {
  v1::StatusSnapshot status;
  for (const char* notice : {"memory is not locked", "thread publish: SCHED_FIFO refused", "thread acq-floor: SCHED_FIFO refused",
                             "thread acq-floor: CPU 9 refused"}) {
    status.add_notices(notice);
  }

  EXPECT_THAT(notice_lines(status), ::testing::ElementsAre("memory is not locked", "threads publish, acq-floor: SCHED_FIFO refused",
                                                           "thread acq-floor: CPU 9 refused"));
}

TEST_F(CommandsTest, DeviceListAndTest_ShowHardware) {
  EXPECT_EQ(run_with({"device", "list"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("sim:floor"));

  EXPECT_EQ(run_with({"device", "test", "floor"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("out_of_range"));
  EXPECT_THAT(out(), ::testing::EndsWith("D1, firmware 1.04\n1 scan, 0.50 per second\n"));
}

TEST_F(CommandsTest, DeviceTestJson_GapOnlyForSensorsAndQualityInWords) {
  EXPECT_EQ(run_with({"device", "test", "floor", "--json"}), cli::kOk);

  const auto channels = json().at("channels");
  EXPECT_EQ(channels.at(0).at("gap_mm"), 9.5);
  EXPECT_EQ(channels.at(0).at("quality"), nlohmann::json::array({"out_of_range"}));
  EXPECT_FALSE(channels.at(1).contains("gap_mm"));
  EXPECT_EQ(channels.at(1).at("quality"), nlohmann::json::array());
}

TEST_F(CommandsTest, SessionStart_PrintsOnlyTheIdAndForPeopleHowToStop) {
  EXPECT_EQ(run_with({"session", "start", "--rig", "floor"}), cli::kOk);
  EXPECT_EQ(out(), "floor-1\n");
  EXPECT_EQ(talk(), "");

  console_.is_talk_terminal = true;
  EXPECT_EQ(run_with({"session", "start", "--rig", "floor"}), cli::kOk);
  EXPECT_EQ(out(), "floor-1\n");
  EXPECT_THAT(talk(), HasSubstr("dtsctl session stop --rig floor"));
}

TEST_F(CommandsTest, SessionStartJson_HasTheIdAndWhatWasAskedFor) {
  EXPECT_EQ(run_with({"session", "start", "--rig", "floor", "--label", "eyes closed", "--duration", "25", "--settle", "5", "--json"}),
            cli::kOk);

  EXPECT_EQ(json().at("session_id"), "floor-1");
  EXPECT_EQ(json().at("state"), "starting");
  EXPECT_EQ(json().at("label"), "eyes closed");
  EXPECT_EQ(json().at("duration_s"), 25.0);
  EXPECT_EQ(json().at("settle_s"), 5.0);
  EXPECT_EQ(run_with({"session", "start", "--rig", "floor", "--json"}), cli::kOk);
  EXPECT_FALSE(json().contains("duration_s"));
}

TEST_F(CommandsTest, DaemonRefuses_ReasonAndItsExitStatus) {
  EXPECT_EQ(run_with({"session", "stop"}), 6);

  EXPECT_EQ(out(), "");
  EXPECT_THAT(talk(), HasSubstr("no session"));
}

TEST_F(CommandsTest, Mark_TextMayBeTheNameOfACommand) {
  for (const std::string text : {"status", "tare", "eyes closed"}) {
    EXPECT_EQ(run_with({"mark", text}), cli::kOk) << text;
    EXPECT_EQ(out(), "floor: segment 2, scan 345\n");
    EXPECT_EQ(talk(),
              "dtsctl: no session is running on rig 'floor': this marker is not recorded\n  try: dtsctl session start --rig floor\n");
  }
}

TEST_F(RunTest, KeyForADaemonWithoutNetwork_IsNotMade) {
  const FakeController daemon(control_, [](const v1::Request& request, int) {
    return std::vector{
        reply(request, [](v1::Response& response) { response.mutable_keys()->set_server_public_key(std::string(40, 'x')); })};
  });
  const std::string file = directory_.path() / "ward-3.key";

  EXPECT_EQ(run_with({"key", "new", "ward-3", "--role", "viewer", "--out", file}), 6);

  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_THAT(talk(), HasSubstr("keys have no use yet"));
  EXPECT_EQ(daemon.requests(), 1) << "only asked: the daemon knows no key either";
}

TEST_F(RunTest, MarkOfSeveralRigs_OneRecordsItIsEnough) {
  v1::SessionState state = v1::SESSION_STATE_UNSPECIFIED;
  const FakeController daemon(control_, [&state](const v1::Request& request, int) {
    return std::vector{reply(request, [&](v1::Response& response) {
      if (request.has_mark()) {
        for (const char* rig : {"attic", "floor"}) response.mutable_mark()->add_marks()->set_rig(rig);
        return;
      }
      *response.mutable_status() = testing::floor_status();
      response.mutable_status()->mutable_rigs(0)->mutable_session()->set_state(state);
    })};
  });

  EXPECT_EQ(run_with({"mark", "step"}), cli::kOk);
  EXPECT_EQ(talk(), "dtsctl: no session is running: this marker is not recorded\n  try: dtsctl session start --rig RIG\n");
  for (const auto recording : {v1::SESSION_STATE_RUNNING, v1::SESSION_STATE_SETTLING}) {
    state = recording;
    EXPECT_EQ(run_with({"mark", "step"}), cli::kOk);
    EXPECT_EQ(talk(), "");
  }
}

TEST_F(CommandsTest, MarkAndTareJson_AreDocuments) {
  EXPECT_EQ(run_with({"mark", "x", "--json"}), cli::kOk);
  EXPECT_EQ(json().at("marks").at(0).at("scan"), 345);

  EXPECT_EQ(run_with({"tare", "--rig", "floor", "--json"}), cli::kOk);
  EXPECT_EQ(json().at("baseline_mm"), nlohmann::json::array({0.0125}));
}

TEST_F(RunTest, NobodyThere_ExitsWithUnreachableAndSaysWhere) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"status"}, {"watch", "floor/cop"}, {"top"}, {"calibrate", "cop", "--rig", "floor"}}) {
    EXPECT_EQ(run_with(words), 3) << words.front();
    EXPECT_THAT(talk(), HasSubstr(directory_.path().string()));
    EXPECT_THAT(talk(), HasSubstr("try:"));
  }
}

TEST_F(RunTest, HostileTextFromTheDaemon_DoesNotDriveTheTerminal) {
  const FakeController daemon(control_, [](const v1::Request& request, int) {
    return std::vector{reply(request, [](v1::Response& response) {
      *response.mutable_status() = testing::floor_status();
      response.mutable_status()->mutable_rigs(0)->set_device_message("\x1b]0;owned\x07");
      response.mutable_status()->add_notices("\x1b[2J");
    })};
  });

  EXPECT_EQ(run_with({"status"}), cli::kOk);

  EXPECT_THAT(out(), Not(HasSubstr("\x1b")));
}

TEST(ExitStatus, EveryCode_HasItsNumber) {
  using client::ErrorCode;
  EXPECT_EQ(cli::exit_status(ErrorCode::InvalidArgument), 2);
  EXPECT_EQ(cli::exit_status(ErrorCode::Unreachable), 3);
  EXPECT_EQ(cli::exit_status(ErrorCode::NotAllowed), 4);
  EXPECT_EQ(cli::exit_status(ErrorCode::NotFound), 5);
  EXPECT_EQ(cli::exit_status(ErrorCode::WrongState), 6);
  EXPECT_EQ(cli::exit_status(ErrorCode::DataDamaged), 7);
  for (const auto code : {ErrorCode::Failed, ErrorCode::Timeout, ErrorCode::DeviceGone, ErrorCode::Unsupported, ErrorCode::LimitExceeded,
                          ErrorCode::Internal}) {
    EXPECT_EQ(cli::exit_status(code), 1);
  }
}

}  // namespace
}  // namespace dts::ctl
