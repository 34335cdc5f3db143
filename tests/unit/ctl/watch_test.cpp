// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
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
  /// Runs a command in a thread while `publish` acts as the daemon; returns the exit status.
  int play(std::vector<std::string> arguments, const std::string& subscription, const std::function<void(FakePublisher&)>& publish) {
    int status = -1;
    FakePublisher daemon(data_);
    std::jthread command([&] { status = run_with(std::move(arguments)); });
    EXPECT_TRUE(daemon.wait_for_subscription(subscription));
    publish(daemon);
    command.join();
    return status;
  }
};

TEST_F(WatchTest, TopicThatNobodyPublishesBeyondTheTimeout_IsNotFoundAndSaysWhy) {
  const int status = play({"watch", "floor/copp", "--timeout", "0.5", "--jsonl"}, "floor/copp",
                          [](FakePublisher& daemon) { daemon.send("dtsd/status", floor_status()); });

  EXPECT_EQ(status, 5);
  EXPECT_THAT(talk(), HasSubstr("did you mean floor/cop?"));
}

TEST_F(WatchTest, SilenceBetweenEvents_IsNotToldAgainAndAgain) {
  const int status = play({"watch", "floor/marker", "--count", "2", "--jsonl"}, "floor/marker", [](FakePublisher& daemon) {
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

TEST_F(WatchTest, CountWithCsv_IsOfTheRowsOfItsStream) {
  const int status = play({"watch", "floor/", "--count", "3", "--csv"}, "floor/", [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status());
    daemon.send("floor/cop", block(1, 0, 2, 1));
    for (int event = 0; event < 5; ++event) daemon.send("floor/marker", testing::marker("not in the table"));
    daemon.send("floor/cop", block(1, 2, 2, 2));
  });

  EXPECT_EQ(status, cli::kOk);
  EXPECT_EQ(std::ranges::count(out(), '\n'), 1 + 3) << out();
}

TEST_F(WatchTest, CsvOfATopicWithoutAStream_IsRefusedWithTheOtherFormat) {
  EXPECT_EQ(run_with({"watch", "dtsd/status", "--csv"}), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("no stream begins with 'dtsd/status'"));

  const int status = play({"watch", "floor/marker", "--count", "3", "--csv"}, "floor/marker", [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status());
    daemon.send("floor/marker", testing::marker("one"));
  });

  EXPECT_EQ(status, cli::kUsage);
  EXPECT_EQ(out(), "");
  EXPECT_THAT(talk(), HasSubstr("no stream begins with 'floor/marker'"));
  EXPECT_THAT(talk(), HasSubstr("dtsctl watch floor/marker --jsonl"));
}

TEST_F(WatchTest, UserWhoPressesQ_EndsWatchAndTopOnATerminal) {
  console_.is_quit_asked = [] { return true; };
  console_.can_redraw = true;
  EXPECT_EQ(play({"watch", "floor/cop"}, "floor/cop", [](FakePublisher&) {}), cli::kOk);
  EXPECT_EQ(play({"top"}, "dtsd/status", [](FakePublisher&) {}), cli::kOk);
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

TEST_F(WatchTest, OutputFails_WatchAndTopEndQuietly) {
  out_.setstate(std::ios::badbit);
  const auto publish = [](FakePublisher& daemon) {
    daemon.send("dtsd/status", floor_status());
    daemon.send("floor/cop", block(1, 0, 1, 1));
  };

  EXPECT_EQ(play({"watch", "floor/cop", "--jsonl"}, "floor/cop", publish), cli::kOk);
  EXPECT_EQ(talk(), "");
  EXPECT_EQ(play({"top"}, "dtsd/status", publish), cli::kOk);
  EXPECT_EQ(talk(), "");
}

TEST_F(WatchTest, ReaderLeavesWhileNothingComes_WatchAndTopEndQuietly) {
  console_.is_out_closed = [] { return true; };

  EXPECT_EQ(play({"watch", "floor/cop", "--jsonl"}, "floor/cop", [](FakePublisher&) {}), cli::kOk);
  EXPECT_EQ(play({"top"}, "dtsd/status", [](FakePublisher&) {}), cli::kOk);
}

TEST(Silence, IsExplainedByTheStatus) {
  RecordProperty("requirement", "UI-9");
  const v1::StatusSnapshot well = floor_status();
  v1::StatusSnapshot gone = floor_status();
  gone.mutable_rigs(0)->set_device(v1::DEVICE_STATE_GONE);
  v1::StatusSnapshot pulled = gone;
  pulled.mutable_rigs(0)->set_device_message("cable pulled");
  const v1::StatusSnapshot empty;
  struct Case {
    const v1::StatusSnapshot* status;
    std::vector<std::string> topics;
    ErrorCode code;
    std::string what;
    std::string hint;
    bool is_of_events = false;
  };
  const std::vector<Case> cases{
      {nullptr,
       {"floor/cop"},
       ErrorCode::Unreachable,
       "no data from the daemon at ipc:///x/data.sock",
       "check that dtsd runs: dtsctl status; check the address: --data URI"},
      {&gone,
       {"floor/cop"},
       ErrorCode::DeviceGone,
       "rig 'floor' sends no scans: its device does not stream",
       "dtsctl device list; dtsctl doctor"},
      {&pulled, {"floor/"}, ErrorCode::DeviceGone, "rig 'floor' sends no scans: cable pulled", "dtsctl device list; dtsctl doctor"},
      {&gone, {"floor/gap"}, ErrorCode::Timeout, "no event yet; the daemon is OK", "wait: events occur only when something happens", true},
      {&well,
       {"floor/marker", "x"},
       ErrorCode::Timeout,
       "no event yet; the daemon is OK",
       "wait: events occur only when something happens",
       true},
      {&well,
       {"attic/", "chair/"},
       ErrorCode::NotFound,
       "no topic begins with 'attic/', 'chair/'",
       "the published streams are: floor/cop floor/raw"},
      {&well, {"floor/copp"}, ErrorCode::NotFound, "no topic begins with 'floor/copp'", "did you mean floor/cop?"},
      {&well, {"floor/reahc"}, ErrorCode::NotFound, "no topic begins with 'floor/reahc'", "did you mean floor/reach?"},
      {&empty, {"floor/cop"}, ErrorCode::NotFound, "no topic begins with 'floor/cop'", "add a [[rig]] to the daemon's configuration"},
      {&well, {""}, ErrorCode::Timeout, "no data, although the daemon reports a streaming device", "dtsctl status; dtsctl doctor"},
      {&well,
       {"floor/marker", "floor/raw"},
       ErrorCode::Timeout,
       "no data, although the daemon reports a streaming device",
       "dtsctl status; dtsctl doctor"}};
  for (const Case& given : cases) {
    SCOPED_TRACE(given.what + ::testing::PrintToString(given.topics));
    const client::Error error = explain_silence(given.status, given.topics, "ipc:///x/data.sock");
    EXPECT_EQ(error.code, given.code);
    EXPECT_EQ(error.what, given.what);
    EXPECT_EQ(error.hint, given.hint);
    EXPECT_EQ(asks_for_events_only(given.status, given.topics), given.is_of_events);
  }
}

}  // namespace
}  // namespace dts::ctl
