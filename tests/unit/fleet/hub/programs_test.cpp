// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/programs.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "fleet/hub/erasures.h"
#include "fleet/wire/messages.h"
#include "fleet/wire/nkey.h"
#include "unit/cli/command_checks.h"
#include "unit/fleet/hub/hub_fixture.h"

namespace dts::fleet::hub {
namespace {

using ::testing::HasSubstr;

void check_examples(std::shared_ptr<cli::CommandLine> (*make_tree)()) {
  const auto tree = make_tree();
  for (const CLI::App* command : cli::commands_of(tree->app)) {
    ASSERT_FALSE(cli::examples(*command).empty()) << cli::full_name(*command);
    for (const cli::Example& example : cli::examples(*command)) {
      std::vector<std::string> words = cli::shell_words(example.command);
      ASSERT_EQ(words.front(), tree->program.name);
      const auto fresh = make_tree();
      EXPECT_NO_THROW(fresh->app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1))) << example.command;
    }
  }
}

TEST(Programs, ExamplesOfEveryCommand_AreUnderstood) {
  check_examples(make_hub_tree);
  check_examples(make_fleet_tree);
}

class FleetProgramTest : public DatabaseTest {
 protected:
  void SetUp() override {
    DatabaseTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    config_ = folder_.path() + "/hub.toml";
    std::ofstream(config_)
        << "name = \"hub-1\"\n[nats]\nservers = [\"nats://127.0.0.1:1\"]\npublic_servers = [\"tls://hub.example:4222\"]\nkey = "
        << "\"hub.nk\"\nusers_file = \"users.conf\"\npid_file = \"none\"\n[database]\nconnection = \"" << connection_
        << "\"\n[store]\ndirectory = \"store\"\n";
  }
  int fleet(std::vector<std::string> words) {
    out_.str("");
    talk_.str("");
    words.insert(words.begin(), {"--config", config_});
    cli::Console console{.out = out_, .talk = talk_, .columns = 200};
    return run_fleet_program(words, console);
  }
  int add(const std::string& name, const std::string& key, const std::string& file) {
    return fleet({"clinic", "add", name, "--title", "Kent clinic", "--key", key, "--out", folder_.path() + "/" + file});
  }

  test::TemporaryFolder folder_;
  std::string config_;
  std::ostringstream out_;
  std::ostringstream talk_;
};

TEST_F(FleetProgramTest, ClinicAdd_WritesTheEnrolmentFile) {
  const auto key = wire::create_nkey().public_key;
  ASSERT_EQ(add("kent", key, "kent.toml"), 0) << talk_.str();
  EXPECT_THAT(content_of(folder_.path() + "/kent.toml"), HasSubstr("tls://hub.example:4222"));
  EXPECT_EQ(add("leeds", wire::create_nkey().public_key, "kent.toml"), 2);
  EXPECT_THAT(talk_.str(), HasSubstr("exists already"));
  EXPECT_EQ(add("kent", wire::create_nkey().public_key, "again.toml"), 6);
  EXPECT_THAT(talk_.str(), HasSubstr("there is a clinic of this name"));
  EXPECT_EQ(add("kent", key, "again.toml"), 6);
  EXPECT_THAT(talk_.str(), HasSubstr("dts-fleet clinic enrolment kent"));
  EXPECT_EQ(add("Kent", key, "again.toml"), 2);
  EXPECT_EQ(add("leeds", "UABC", "again.toml"), 2);
  EXPECT_THAT(talk_.str(), HasSubstr("dts-forward key"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/again.toml"));
  ASSERT_EQ(fleet({"clinic", "list"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("Kent clinic"));
}

TEST_F(FleetProgramTest, ClinicAdd_NamesTheClinicThatHasTheKey) {
  const auto key = wire::create_nkey().public_key;
  ASSERT_EQ(add("kent", key, "kent.toml"), 0) << talk_.str();
  EXPECT_EQ(add("leeds", key, "leeds.toml"), 6);
  EXPECT_THAT(talk_.str(), HasSubstr("the key belongs to clinic 'kent'"));
}

TEST_F(FleetProgramTest, AFolderThatCannotBeWritten_IsNamedWithWhatToDo) {
  const auto key = wire::create_nkey().public_key;
  EXPECT_EQ(fleet({"clinic", "add", "kent", "--title", "Kent", "--key", key, "--out", "/sys/kent.toml"}), 4);  // also for root
  EXPECT_THAT(talk_.str(), HasSubstr("cannot write /sys/kent.toml: Permission denied"));
  EXPECT_THAT(talk_.str(), HasSubstr("name a file in --out whose folder the user"));
  EXPECT_EQ(value("SELECT count(*) FROM clinic"), "0");
}

TEST_F(FleetProgramTest, Enrolment_IsWrittenAgain_OfAnActiveClinic) {
  const auto key = wire::create_nkey().public_key;
  ASSERT_EQ(add("kent", key, "kent.toml"), 0) << talk_.str();
  const std::string again = folder_.path() + "/again.toml";
  ASSERT_EQ(fleet({"clinic", "enrolment", "kent", "--out", again}), 0) << talk_.str();
  EXPECT_EQ(content_of(again), content_of(folder_.path() + "/kent.toml"));
  EXPECT_EQ(fleet({"clinic", "enrolment", "kent", "--out", again}), 2);
  EXPECT_EQ(fleet({"clinic", "enrolment", "york", "--out", folder_.path() + "/york.toml"}), 5);
  ASSERT_EQ(fleet({"clinic", "revoke", "kent"}), 0);
  EXPECT_EQ(fleet({"clinic", "enrolment", "kent", "--out", folder_.path() + "/revoked.toml"}), 6);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/revoked.toml"));
  EXPECT_EQ(add("kent2", key, "kent2.toml"), 6);
  EXPECT_THAT(talk_.str(), HasSubstr("the key belongs to clinic 'kent' (revoked)"));
  EXPECT_THAT(talk_.str(), HasSubstr("move the key file away, then run dts-forward key"));
}

TEST_F(FleetProgramTest, AUserWithoutARole_IsToldToRunItAsTheHub) {
  std::string text = content_of(config_);
  text.replace(text.find(connection_), connection_.size(), connection_ + " user=nobody_of_ours");
  std::ofstream(config_) << text;
  EXPECT_EQ(fleet({"clinic", "list"}), 3);
  EXPECT_THAT(talk_.str(), HasSubstr("role \"nobody_of_ours\" does not exist"));
  EXPECT_THAT(talk_.str(), HasSubstr("runuser -u dts-hub -- dts-fleet"));
}

TEST_F(FleetProgramTest, SessionErase_AsksFirst_AndErasesRowsAndFiles) {
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  const RecordingName name{"kent", sum_of("recording of s1")};
  const auto store = open_folder_store(folder_.path() + "/store").value();
  std::ofstream(folder_.path() + "/store/whole") << "recording of s1";
  ASSERT_TRUE(store->put(name, folder_.path() + "/store/whole"));
  v1::UploadOffer offer;
  offer.set_session_id("s1");
  offer.set_part(1);
  offer.set_bytes(15);
  ASSERT_TRUE(catalogue_->put_recording(name, offer, *store, "hub-1", 1));

  EXPECT_EQ(fleet({"session", "erase", "kent", "s1"}), 2);
  EXPECT_THAT(out_.str(), HasSubstr("session s1 of kent, protocol romberg, started 2025-11-21 14:45 (UTC): 1 recording (0.0 MB), 3 parts"));
  EXPECT_THAT(talk_.str(), HasSubstr("nothing was erased"));
  EXPECT_EQ(value("SELECT count(*) FROM session"), "1");

  EXPECT_EQ(fleet({"session", "erase", "kent", "s1", "--yes"}), 0) << talk_.str();
  EXPECT_THAT(out_.str(), HasSubstr("erased, with 1 recording\n"));
  EXPECT_EQ(value("SELECT count(*) FROM session"), "0");
  EXPECT_FALSE(store->file(name).value());
  EXPECT_THAT(value("SELECT concat_ws('|', who, what, target) FROM audit"), testing::MatchesRegex("local:.*[|]erase_session[|]kent/s1"));
  EXPECT_EQ(ErasureJournal(folder_.path() + "/store").read().value(), (std::set<SessionName>{{"kent", "s1"}}));
  EXPECT_EQ(catalogue_->put_session("kent", session_of("s1", 2)).error().code, core::ErrorCode::NotFound);

  EXPECT_EQ(fleet({"session", "erase", "kent", "s1", "--yes"}), 6);
  EXPECT_EQ(fleet({"session", "erase", "kent", "s2", "--yes"}), 5);
}

TEST_F(FleetProgramTest, Receipts_AlsoShowTheChecksumAtTheClinic) {
  auto session = session_of("s1", 1);
  session.mutable_parts(0)->set_recorded_sha256(sum_of("with its texts"));
  ASSERT_TRUE(catalogue_->put_session("kent", session));
  const RecordingName name{"kent", sum_of("recording of s1")};
  const auto store = open_folder_store(folder_.path() + "/store").value();
  std::ofstream(folder_.path() + "/store/whole") << "recording of s1";
  ASSERT_TRUE(store->put(name, folder_.path() + "/store/whole"));
  v1::UploadOffer offer;
  offer.set_session_id("s1");
  offer.set_part(1);
  offer.set_bytes(15);
  ASSERT_TRUE(catalogue_->put_recording(name, offer, *store, "hub-1", 1));
  ASSERT_EQ(fleet({"receipts", "--clinic", "kent", "--json"}), 0) << talk_.str();
  EXPECT_THAT(out_.str(), HasSubstr("\"sha256\":\"" + wire::hex_of(name.sha256) + "\",\"recorded_sha256\":\"" +
                                    wire::hex_of(sum_of("with its texts")) + "\""));
  ASSERT_EQ(fleet({"receipts"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("CLINIC'S SHA-256"));
}

TEST_F(FleetProgramTest, Users_AreWrittenWithoutANatsServer) {
  ASSERT_EQ(fleet({"users"}), 0) << talk_.str();
  EXPECT_THAT(out_.str(), HasSubstr("users.conf: written\nnats-server does not run"));
  EXPECT_THAT(content_of(folder_.path() + "/users.conf"), HasSubstr("_INBOX.*.>"));
  ASSERT_EQ(fleet({"users"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("unchanged"));
}

TEST_F(FleetProgramTest, AKeyWithTwoUsers_IsRejected) {
  const auto hub = wire::read_or_create_nkey(folder_.path() + "/hub.nk").value().public_key;
  const auto kent = wire::create_nkey().public_key;
  const auto dashboard = wire::create_nkey().public_key;
  ASSERT_EQ(add("kent", kent, "kent.toml"), 0) << talk_.str();
  std::ofstream(config_, std::ios::app) << "[[dashboard]]\nkey = \"" << dashboard << "\"\n";
  EXPECT_EQ(add("leeds", hub, "leeds.toml"), 6);
  EXPECT_THAT(talk_.str(), HasSubstr("clinic 'leeds' has the key of the hub"));
  EXPECT_EQ(add("leeds", dashboard, "leeds.toml"), 6);
  EXPECT_THAT(talk_.str(), HasSubstr("clinic 'leeds' has the key of a [[dashboard]]"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/leeds.toml"));
  EXPECT_EQ(value("SELECT count(*) FROM clinic"), "1");
  EXPECT_EQ(fleet({"users"}), 0);
  std::ofstream(config_, std::ios::app) << "[[dashboard]]\nkey = \"" << kent << "\"\n";
  EXPECT_EQ(fleet({"users"}), 6);
  EXPECT_THAT(talk_.str(), HasSubstr("clinic 'kent' has the key of a [[dashboard]]"));
}

TEST_F(FleetProgramTest, Lists_AsTablesAndAsJsonLines) {
  const auto key = wire::create_nkey().public_key;
  ASSERT_EQ(add("kent", key, "kent.toml"), 0);
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s2", 1)));
  v1::Beat beat;
  beat.add_rigs()->set_rig("floor");
  ASSERT_TRUE(catalogue_->put_beat("kent", beat, 1'000'000'000'000'000'000));
  ASSERT_EQ(fleet({"sessions", "--clinic", "kent", "--subject", "P017", "--limit", "1", "--json"}), 0);
  const auto json = out_.str();
  EXPECT_THAT(json, HasSubstr(R"("clinic":"kent","session":"s)"));
  EXPECT_THAT(json, HasSubstr(R"("started_utc":"2025-11-21T14:45:25Z","parts":1,"stored_parts":0,"revision":1})"));
  EXPECT_EQ(std::ranges::count(json, '\n'), 1);
  ASSERT_EQ(fleet({"sessions"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("STARTED (UTC)"));
  ASSERT_EQ(fleet({"sessions", "--clinic", "leeds"}), 0);
  EXPECT_EQ(out_.str(), "");
  EXPECT_THAT(talk_.str(), HasSubstr("no entries"));
  ASSERT_EQ(fleet({"rigs"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("plate model"));
  ASSERT_EQ(fleet({"clinic", "list", "--json"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr(R"("daemon":"no answer")"));
  ASSERT_EQ(fleet({"receipts", "--json"}), 0);
  EXPECT_EQ(out_.str(), "");
  ASSERT_EQ(fleet({"clinic", "revoke", "kent"}), 0);
  ASSERT_EQ(fleet({"audit"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("2 entries verified"));
  EXPECT_EQ(fleet({"clinic", "revoke", "york"}), 5);
}

TEST_F(FleetProgramTest, WrongConfiguration_IsNamed) {
  std::ofstream(config_) << "name = 3\n";
  EXPECT_EQ(fleet({"rigs"}), 2);
  EXPECT_THAT(talk_.str(), HasSubstr("hub.toml:1"));
}

}  // namespace
}  // namespace dts::fleet::hub
