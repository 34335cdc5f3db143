// SPDX-License-Identifier: Apache-2.0
// dts-forward from its command line: key, status, and what a script may ask.
#include "fleet/forward/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/clock.h"
#include "fleet/forward/status_words.h"
#include "fleet/forward/store.h"
#include "fleet/wire/messages.h"
#include "support/temporary_folder.h"
#include "unit/fleet/forward/fake_clinic.h"

namespace dts::fleet::forward {
namespace {

using testing::HasSubstr;

class ProgramTest : public testing::Test {
 protected:
  ProgramTest() {
    std::ofstream(folder_.path() + "/kent.toml") << "clinic = \"kent\"\nservers = [\"nats://127.0.0.1:1\"]\n";
    std::ofstream(config_) << "enrolment = \"kent.toml\"\nkey = \"kent.nk\"\nstate = \"" << folder_.path() << "\"\n";
  }
  int run_with(std::vector<std::string> words) {
    out_.str({});
    talk_.str({});
    words.insert(words.end(), {"--config", config_});
    cli::Console console{.out = out_, .talk = talk_};
    return run(words, console);
  }
  /// A store with one recording that waits.
  std::unique_ptr<Store> store_with_file() {
    auto store = Store::open(folder_.path()).value();
    FakeClinic clinic;
    auto& session = clinic.add("s-1", 1'000'000'000);
    FakeClinic::add_part(session, "/s-1.xdf", sha256_, 5'000'000);
    EXPECT_TRUE(store->put_session(session, session, {}, 2'000'000'000));
    return store;
  }

  test::TemporaryFolder folder_;
  std::string config_ = folder_.path() + "/forward.toml";
  std::string sha256_ = std::string(64, 'a');
  std::ostringstream out_;
  std::ostringstream talk_;
};

TEST_F(ProgramTest, Key_IsMadeOnce) {
  ASSERT_EQ(run_with({"key"}), 0);
  const std::string key = out_.str();
  EXPECT_THAT(key, testing::StartsWith("U"));
  ASSERT_EQ(run_with({"key"}), 0);
  EXPECT_EQ(out_.str(), key);
}

TEST_F(ProgramTest, Run_WithoutAKeyFails) {
  EXPECT_EQ(run_with({"run"}), 5);
  EXPECT_THAT(talk_.str(), HasSubstr("kent.nk"));
  EXPECT_THAT(talk_.str(), HasSubstr("dts-forward key"));
}

TEST_F(ProgramTest, Run_WithoutTheStateFolder_NamesItAndItsOwner) {
  ASSERT_EQ(run_with({"key"}), 0);
  std::ofstream(config_) << "enrolment = \"kent.toml\"\nkey = \"kent.nk\"\nstate = \"" << folder_.path() << "/none/state\"\n";
  EXPECT_EQ(run_with({"run"}), 5);
  EXPECT_THAT(talk_.str(), HasSubstr("/none/state"));
  EXPECT_THAT(talk_.str(), HasSubstr("install -d -o dts-forward"));
}

TEST_F(ProgramTest, StatusBeforeTheFirstRun_SaysSo) {
  EXPECT_EQ(run_with({"status"}), 5);
  EXPECT_THAT(talk_.str(), HasSubstr("has not run yet"));
}

TEST_F(ProgramTest, StatusOfAChecksum_Is0OnlyWithAReceipt) {
  auto store = store_with_file();
  EXPECT_EQ(run_with({"status", sha256_}), 6);
  EXPECT_THAT(talk_.str(), HasSubstr("there is no receipt for part 1 of session s-1: it waits to be sent"));
  EXPECT_EQ(run_with({"status", std::string(64, 'b')}), 5);
  EXPECT_EQ(run_with({"status", "abc"}), 2);
  const auto file = *store->next_file(2'000'000'000).value();
  ASSERT_TRUE(store->hold(file, "its SHA-256 differs"));
  EXPECT_EQ(run_with({"status", sha256_}), 6);
  EXPECT_THAT(talk_.str(), HasSubstr("its SHA-256 differs"));
  v1::Receipt receipt;
  receipt.set_stored_utc_ns(1'000'000'000);
  receipt.set_hub("hub-1");
  ASSERT_TRUE(store->set_stored(file, receipt));
  EXPECT_EQ(run_with({"status", sha256_}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("the centre (hub-1) has given a receipt for part 1 of session s-1 at 1970-01-01T00:00:01"));
  ASSERT_EQ(run_with({"status", sha256_, "--json"}), 0);
  EXPECT_EQ(nlohmann::json::parse(out_.str()).at("state"), "stored");
}

TEST_F(ProgramTest, Status_ShowsBacklogProgressAndTimeToGo) {
  auto store = store_with_file();
  EXPECT_EQ(run_with({"status"}), 1);
  EXPECT_THAT(out_.str(), HasSubstr("dts-forward does not run"));
  const core::SystemClock clock;
  const std::int64_t now = clock.now_ns() + clock.utc_minus_monotonic_ns();
  ASSERT_TRUE(store->set_words({{words::kUpdated, std::to_string(now)},
                                {words::kUploadSession, "s-1"},
                                {words::kUploadPart, "1"},
                                {words::kUploadBytes, "5000000"},
                                {words::kUploadHave, "1000000"},
                                {words::kUploadRate, "100000.0"},
                                {words::kHub, "hub-1"},
                                {words::kBeat, std::to_string(now)},
                                {words::kClockOffset, "3000000"},
                                {words::kViewers, "ann"}}));
  ASSERT_EQ(run_with({"status"}), 0);
  for (const char* line : {"state           fine", "1 recording, 5.0 MB", "s-1, part 1: 1.0 MB of 5.0 MB", "time to go      40.0 s",
                           "last receipt    never", "hub-1, answered", "3 ms ahead of the centre's", "watching now    ann"}) {
    EXPECT_THAT(out_.str(), HasSubstr(line));
  }
  ASSERT_EQ(run_with({"status", "--json"}), 0);
  const auto json = nlohmann::json::parse(out_.str());
  EXPECT_EQ(json.at("backlog_bytes"), 5'000'000);
  EXPECT_EQ(json.at("to_go_s"), 40.0);
  EXPECT_EQ(json.at("sending").at("have"), 1'000'000);
  EXPECT_FALSE(json.contains("problem"));
  ASSERT_TRUE(store->set_words({{words::kLinkProblem, "the connection is lost"}}));
  ASSERT_EQ(run_with({"status", "--json"}), 0);
  EXPECT_EQ(nlohmann::json::parse(out_.str()).at("problem"), "the connection is lost");
  EXPECT_FALSE(nlohmann::json::parse(out_.str()).contains("to_go_s")) << "nothing goes";
}

TEST_F(ProgramTest, OfferAgain_MakesReceiptsInvalid) {
  EXPECT_EQ(run_with({"offer-again"}), 5);
  auto store = store_with_file();
  v1::Receipt receipt;
  receipt.set_stored_utc_ns(1'000'000'000);
  ASSERT_TRUE(store->set_stored(*store->next_file(2'000'000'000).value(), receipt));
  EXPECT_EQ(run_with({"status", sha256_}), 0);
  EXPECT_EQ(run_with({"offer-again"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("offers all recordings"));
  EXPECT_EQ(run_with({"status", sha256_}), 6);
}

TEST_F(ProgramTest, WrongConfiguration_IsReportedWithItsPlace) {
  std::ofstream(config_) << "enrolment = \"kent.toml\"\nkey = 3\n";
  EXPECT_EQ(run_with({"run"}), 2);
  EXPECT_THAT(talk_.str(), HasSubstr("forward.toml:2:7"));
}

}  // namespace
}  // namespace dts::fleet::forward
