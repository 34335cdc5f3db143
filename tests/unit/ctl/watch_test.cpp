// SPDX-License-Identifier: Apache-2.0
#include <thread>

#include "ctl/silence.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using client::ErrorCode;
using testing::block;
using testing::FakePublisher;
using testing::floor_status;
using ::testing::HasSubstr;

class WatchTest : public RunTest {
 protected:
  /// Runs `watch` in a thread while `publish` acts as the daemon; returns the exit status.
  int watch(std::vector<std::string> arguments, const std::string& subscription, const std::function<void(FakePublisher&)>& publish) {
    arguments.insert(arguments.begin(), "watch");
    int status = -1;
    FakePublisher daemon(data_);
    std::jthread command([&] { status = run_with(std::move(arguments)); });
    EXPECT_TRUE(daemon.wait_for_subscription(subscription));
    publish(daemon);
    command.join();
    return status;
  }
  std::vector<nlohmann::json> lines() const {
    std::vector<nlohmann::json> parsed;
    std::istringstream text(out());
    for (std::string line; std::getline(text, line);) parsed.push_back(nlohmann::json::parse(line));
    return parsed;
  }
};

TEST_F(WatchTest, CountInTheMiddleOfABlock_ExactlySoManyScansArePrintedWithWhatWasLost) {
  const int status = watch({"floor/cop", "--count", "5", "--jsonl"}, "floor/cop", [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status());
    for (std::uint64_t number = 0; number < 3; ++number) daemon.send("floor/cop", block(1, 100 * number, 3, 9 * number + 1));
  });

  EXPECT_EQ(status, cli::kOk);
  ASSERT_EQ(lines().size(), 2U);
  EXPECT_EQ(lines()[0].at("values").size(), 3U);
  EXPECT_EQ(lines()[1].at("values").size(), 2U);
  EXPECT_EQ(lines()[1].at("first_scan"), 100);
  EXPECT_EQ(lines()[0].at("lost_scans"), 0);
  EXPECT_EQ(lines()[1].at("lost_scans"), 97);
}

TEST_F(WatchTest, Csv_IsOfOneStreamWithALinePerScan) {
  const int status = watch({"floor/", "--count", "4", "--csv"}, "floor/", [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status());
    daemon.send("floor/cop", block(1, 0, 2, 1));
    daemon.send("floor/raw", block(1, 0, 1, 1, 1));
    daemon.send("floor/cop", block(1, 2, 1, 2));
  });

  EXPECT_EQ(status, cli::kOk);
  std::istringstream text(out());
  std::vector<std::string> rows;
  for (std::string row; std::getline(text, row);) rows.push_back(row);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[0], "segment,scan,ml_mm,ap_mm,load_n");
  EXPECT_THAT(rows[1], ::testing::StartsWith("1,0,"));
  EXPECT_THAT(rows[3], ::testing::StartsWith("1,2,"));
  EXPECT_THAT(talk(), HasSubstr("floor/raw is left out"));
}

TEST_F(WatchTest, WithoutATopic_EverythingButTheStatusAndEventsCountAsOneEach) {
  const int status = watch({"--count", "3", "--jsonl"}, "", [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status());
    daemon.send("floor/marker", testing::marker("one"));
    daemon.send("floor/cop", block(1, 0, 1, 1));
    daemon.send("floor/marker", testing::marker("two"));
  });

  EXPECT_EQ(status, cli::kOk);
  ASSERT_EQ(lines().size(), 3U);
  EXPECT_EQ(lines()[2].at("event").at("text"), "two");
}

TEST_F(WatchTest, StatusAskedFor_IsShown) {
  const int status = watch({"dtsd/status", "--count", "1", "--jsonl"}, "dtsd/status",
                           [](FakePublisher& daemon) { daemon.send("dtsd/status", floor_status()); });

  EXPECT_EQ(status, cli::kOk);
  EXPECT_EQ(lines().at(0).at("event").at("rigs").at(0).at("device"), "streaming");
}

TEST_F(WatchTest, DaemonRestarts_IsToldBesideTheData) {
  const int status = watch({"floor/raw", "--count", "2", "--jsonl"}, "floor/raw", [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status(7));
    daemon.send("floor/raw", block(1, 0, 1, 1, 1, 7));
    daemon.send("dtsd/status", floor_status(8));
    daemon.send("floor/raw", block(1, 0, 1, 1, 1, 8));
  });

  EXPECT_EQ(status, cli::kOk);
  EXPECT_EQ(lines().size(), 2U);
  EXPECT_THAT(talk(), HasSubstr("restarted"));
}

TEST_F(WatchTest, WithoutJson_LinesForPeople) {
  watch({"floor/cop", "--count", "1"}, "floor/cop", [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status());
    daemon.send("floor/cop", block(1, 0, 1, 1));
  });

  EXPECT_THAT(out(), HasSubstr("floor/cop  scan 0  ml"));
}

TEST_F(WatchTest, SilentBeyondTheTimeout_FailsAndSaysWhy) {
  const int status = watch({"floor/copp", "--timeout", "0.5", "--jsonl"}, "floor/copp",
                           [](FakePublisher& daemon) { daemon.send("dtsd/status", floor_status()); });

  EXPECT_EQ(status, cli::kFailed);
  EXPECT_THAT(talk(), HasSubstr("did you mean floor/cop?"));
}

TEST_F(WatchTest, SilenceBetweenEvents_IsNotToldAgainAndAgain) {
  const int status = watch({"floor/marker", "--count", "2", "--jsonl"}, "floor/marker", [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status());
    daemon.send("floor/marker", testing::marker("one"));
    v1::StatusSnapshot status_now = floor_status();
    for (int second = 1; second <= 4; ++second) {  // longer than `watch` listens before it explains a silence
      std::this_thread::sleep_for(std::chrono::milliseconds(850));
      status_now.set_host_time_ns(status_now.host_time_ns() + 1'000'000'000);
      daemon.send("dtsd/status", status_now);
    }
    daemon.send("floor/marker", testing::marker("two"));
  });

  EXPECT_EQ(status, cli::kOk);
  EXPECT_EQ(talk(), "");
}

TEST_F(WatchTest, NotEvenAStatusWithinTheTimeout_Unreachable) {
  const int status = watch({"floor/cop", "--timeout", "0.2"}, "floor/cop", [](FakePublisher&) {});

  EXPECT_EQ(status, 3);
}

TEST_F(WatchTest, DaemonEndsWhileItIsWatched_IsSaid) {
  int status = -1;
  std::jthread command;
  {
    FakePublisher daemon(data_);
    command = std::jthread([&] { status = run_with({"watch", "floor/cop", "--timeout", "0.5"}); });
    EXPECT_TRUE(daemon.wait_for_subscription("floor/cop"));
    daemon.send("dtsd/status", floor_status());
    daemon.send("floor/cop", block(1, 0, 1, 1));
  }
  command.join();

  EXPECT_EQ(status, 3);
  EXPECT_THAT(talk(), HasSubstr("no daemon at " + data_));
}

TEST_F(WatchTest, OutputFails_EndsQuietly) {
  out_.setstate(std::ios::badbit);

  const int status = watch({"floor/cop", "--jsonl"}, "floor/cop", [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status());
    daemon.send("floor/cop", block(1, 0, 1, 1));
  });

  EXPECT_EQ(status, cli::kOk);
  EXPECT_EQ(talk(), "");
}

TEST_F(WatchTest, ReaderLeavesWhileNothingComes_EndsQuietly) {
  console_.is_out_closed = [] { return true; };

  EXPECT_EQ(watch({"floor/cop", "--jsonl"}, "floor/cop", [](FakePublisher&) {}), cli::kOk);
}

TEST(Silence, IsExplainedByTheStatus) {
  const v1::StatusSnapshot well = floor_status();
  v1::StatusSnapshot gone = floor_status();
  gone.mutable_rigs(0)->set_device(v1::DEVICE_STATE_GONE);
  gone.mutable_rigs(0)->set_device_message("cable pulled");
  for (const auto& [status, topic, code, says] : {std::tuple<const v1::StatusSnapshot*, const char*, ErrorCode, const char*>(
                                                      nullptr, "floor/cop", ErrorCode::Unreachable, "ipc:///x/data.sock"),
                                                  {&gone, "floor/cop", ErrorCode::DeviceGone, "cable pulled"},
                                                  {&well, "floor/marker", ErrorCode::Timeout, "only when something happens"},
                                                  {&well, "attic/", ErrorCode::NotFound, "floor/cop floor/raw"},
                                                  {&well, "", ErrorCode::Timeout, ""}}) {
    const client::Error error = explain_silence(status, {topic}, "ipc:///x/data.sock");
    EXPECT_EQ(error.code, code) << topic;
    EXPECT_THAT(error.what + "\n" + error.hint, HasSubstr(says)) << topic;
  }
}

}  // namespace
}  // namespace dts::ctl
