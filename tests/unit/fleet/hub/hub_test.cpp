// SPDX-License-Identifier: Apache-2.0
// The program dts-hub with a real nats-server and a real PostgreSQL.
#include "fleet/hub/hub.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <chrono>
#include <functional>
#include <iostream>
#include <thread>
#include <vector>

#include "fleet/link/link.h"
#include "fleet/wire/messages.h"
#include "fleet/wire/nkey.h"
#include "fleet/wire/subjects.h"
#include "support/nats_server.h"
#include "support/s3_server.h"
#include "unit/fleet/hub/hub_fixture.h"

namespace dts::fleet::hub {
namespace {

using namespace std::chrono_literals;
using wire::Matter;

bool comes_true(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

class HubTest : public DatabaseTest {
 protected:
  void SetUp() override {
    if (!test::NatsServer::program()) GTEST_SKIP() << "nats-server is not installed";
    DatabaseTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    nats_ = std::make_unique<test::NatsServer>();
    config_ = folder_.path() + "/hub.toml";
    std::ofstream(config_) << "name = \"hub-1\"\n[nats]\nservers = [\"nats://127.0.0.1:" << nats_->port()
                           << "\"]\nkey = \"hub.nk\"\nusers_file = \"" << nats_->folder() << "/users.conf\"\npid_file = \""
                           << nats_->folder() << "/pid\"\n[database]\nconnection = \"" << connection_
                           << "\"\n[store]\ndirectory = \"store\"\n[metrics]\nlisten = "
                           << "\"127.0.0.1:" << metrics_port_ << "\"\n";
    ASSERT_EQ(fleet({"users"}), 0);
    nats_->start(nats_settings());
  }
  void TearDown() override {
    if (hub_ > 0) {
      ::kill(hub_, SIGKILL);
      ::waitpid(hub_, nullptr, 0);
    }
  }

  [[nodiscard]] pid_t spawn(const char* name, std::vector<std::string> words) const {
    const pid_t child = ::fork();
    if (child != 0) return child;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const std::string log = folder_.path() + "/log";
    if (std::freopen(log.c_str(), "a", stderr) == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr) ::_exit(126);
    std::string program = name;
    std::vector<char*> arguments = {program.data()};
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(DTS_HUB_PROGRAM, arguments.data());
    ::_exit(127);
  }
  [[nodiscard]] int fleet(std::vector<std::string> words) const {
    words.insert(words.begin(), {"--config", config_});
    int status = 0;
    const pid_t child = spawn("dts-fleet", std::move(words));
    return ::waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void start_hub() { hub_ = spawn("dts-hub", {"run", "--config", config_}); }
  [[nodiscard]] int end_hub(int signal) {
    int status = 0;
    ::kill(hub_, signal);
    ::waitpid(hub_, &status, 0);
    hub_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  /// Adds a clinic and connects as it.
  std::unique_ptr<link::Link> add_clinic(const std::string& name) {
    const auto key = wire::create_nkey();
    EXPECT_EQ(
        fleet({"clinic", "add", name, "--title", "A clinic", "--key", key.public_key, "--out", folder_.path() + "/" + name + ".toml"}), 0);
    keys_[name] = key;
    return connect(name);
  }
  std::unique_ptr<link::Link> connect(const std::string& name) {
    std::unique_ptr<link::Link> link;
    EXPECT_TRUE(comes_true([&] {
      if (!link || link->is_rejected()) link = open_link(name);
      return link->is_connected();
    }));
    return link;
  }
  std::unique_ptr<link::Link> open_link(const std::string& name) {
    return link::Link::open({.servers = {"nats://127.0.0.1:" + std::to_string(nats_->port())},
                             .name = name,
                             .seed = keys_[name].seed,
                             .inbox_prefix = wire::inbox_prefix(name)},
                            core::Log())
        .value();
  }
  /// Sends a request until it is answered.
  template <class Answer, class Request>
  static Answer ask(link::Link& link, const wire::Subject& subject, const Request& request) {
    Answer answer;
    EXPECT_TRUE(comes_true([&] {
      const auto reply = link.request(wire::to_text(subject), request.SerializeAsString(), 2s);
      return reply && answer.ParseFromString(*reply);
    })) << wire::to_text(subject);
    return answer;
  }
  static v1::UploadAnswer upload(link::Link& link, const std::string& clinic, const std::string& bytes, const std::string& session) {
    v1::UploadOffer offer;
    offer.set_sha256(sum_of(bytes));
    offer.set_bytes(bytes.size());
    offer.set_session_id(session);
    offer.set_part(1);
    auto answer = ask<v1::UploadAnswer>(link, {.clinic = clinic, .matter = Matter::Open}, offer);
    const std::string worker = answer.upload().worker();
    while (answer.has_upload() && answer.upload().have() < bytes.size()) {
      v1::UploadChunk chunk;
      chunk.set_sha256(sum_of(bytes));
      chunk.set_offset(answer.upload().have());
      chunk.set_data(bytes.substr(answer.upload().have(), 100'000));
      answer = ask<v1::UploadAnswer>(link, {.clinic = clinic, .matter = Matter::Chunk, .worker = worker}, chunk);
    }
    if (!answer.has_upload()) return answer;
    v1::UploadCommit commit;
    commit.set_sha256(sum_of(bytes));
    return ask<v1::UploadAnswer>(link, {.clinic = clinic, .matter = Matter::Commit, .worker = worker}, commit);
  }
  /// Returns the body of GET /metrics; empty: nobody answers.
  [[nodiscard]] std::string metrics(const std::string& path = "/metrics") const {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(metrics_port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    std::string answer;
    if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
      const std::string request = "GET " + path + " HTTP/1.1\r\nHost: x\r\n\r\n";
      EXPECT_EQ(::send(socket, request.data(), request.size(), MSG_NOSIGNAL), static_cast<ssize_t>(request.size()));
      std::array<char, 4096> buffer{};
      for (ssize_t got = 0; (got = ::recv(socket, buffer.data(), buffer.size(), 0)) > 0;)
        answer.append(buffer.data(), static_cast<std::size_t>(got));
    }
    ::close(socket);
    return answer;
  }
  [[nodiscard]] std::string log_text() const { return content_of(folder_.path() + "/log"); }

  [[nodiscard]] std::string nats_settings() const { return "include ./users.conf\npid_file: \"" + nats_->folder() + "/pid\"\n"; }
  test::TemporaryFolder folder_;
  std::unique_ptr<test::NatsServer> nats_;
  std::string config_;
  std::map<std::string, wire::NKey> keys_;
  int metrics_port_ = 20'000 + ::getpid() % 20'000;
  pid_t hub_ = 0;
};

TEST_F(HubTest, ServesAClinic_FromItsEnrolmentToItsRevocation) {
  start_hub();
  const auto kent = add_clinic("kent");
  EXPECT_TRUE(std::filesystem::exists(folder_.path() + "/store/erased"));  // before the first erasure
  EXPECT_NE(content_of(folder_.path() + "/kent.toml").find("clinic = 'kent'"), std::string::npos)
      << content_of(folder_.path() + "/kent.toml");

  v1::Beat beat;
  beat.set_utc_ns(1);
  beat.mutable_backlog()->set_files(3);
  const auto beaten = ask<v1::BeatAnswer>(*kent, {.clinic = "kent", .matter = Matter::Beat}, beat);
  EXPECT_EQ(beaten.hub(), "hub-1");
  EXPECT_EQ(beaten.audit_head().size(), 32U);  // of add_clinic
  EXPECT_EQ(ask<v1::FactsAnswer>(*kent, {.clinic = "kent", .matter = Matter::Facts}, session_of("s1", 4)).revision(), 4U);
  auto wrong = session_of("s2", 1);
  wrong.set_state("finished");
  EXPECT_TRUE(ask<v1::FactsAnswer>(*kent, {.clinic = "kent", .matter = Matter::Facts}, wrong).has_refusal());

  std::string bytes(1'000'000, 'x');
  EXPECT_TRUE(upload(*kent, "kent", bytes, "s3").has_stored());
  EXPECT_EQ(end_hub(SIGKILL), -SIGKILL);
  start_hub();
  EXPECT_TRUE(upload(*kent, "kent", bytes, "s3").has_stored());
  v1::EraseSession erase;
  erase.set_session_id("s3");
  EXPECT_EQ(ask<v1::EraseAnswer>(*kent, {.clinic = "kent", .matter = Matter::Erase}, erase).files(), 1U);
  EXPECT_TRUE(upload(*kent, "kent", bytes, "s3").has_refusal());

  EXPECT_TRUE(comes_true([&] { return metrics().find("dts_hub_clinic_backlog_files{clinic=\"kent\"} 3\n") != std::string::npos; }));
  EXPECT_NE(metrics().find("\ndts_hub_database_up 1\n"), std::string::npos);
  EXPECT_EQ(metrics("/").rfind("HTTP/1.1 404", 0), 0U);

  const auto begun = std::chrono::steady_clock::now();
  EXPECT_EQ(fleet({"clinic", "revoke", "kent"}), 0);
  EXPECT_TRUE(comes_true([&] { return !kent->is_connected(); }));
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
  std::cout << "a revoked clinic was cut off after " << taken.count() << " s\n";
  EXPECT_TRUE(comes_true([&] { return kent->is_rejected(); }));
  nats_->start(nats_settings());
  const auto again = open_link("kent");
  EXPECT_TRUE(comes_true([&] { return again->is_rejected(); }));

  const std::string status = content_of("/proc/" + std::to_string(hub_) + "/status");
  std::cout << "dts-hub: " << status.substr(status.find("VmHWM"), 24) << "\n";
  EXPECT_EQ(end_hub(SIGTERM), 0) << log_text();
}

TEST_F(HubTest, LettersWithAForeignReplySubject_AreIgnored) {
  start_hub();
  const auto kent = add_clinic("kent");
  const auto leeds = add_clinic("leeds");
  const auto inbox = leeds->subscribe(wire::inbox_prefix("leeds") + ".>");
  ASSERT_TRUE(inbox);
  v1::Beat beat;
  ask<v1::BeatAnswer>(*leeds, {.clinic = "leeds", .matter = Matter::Beat}, beat);  // both directions work
  while ((*inbox)->next(0ms)) {
  }
  const std::string subject = wire::to_text({.clinic = "kent", .matter = Matter::Beat});
  ASSERT_TRUE(kent->publish({.subject = subject, .reply = wire::inbox_prefix("leeds") + ".x", .data = beat.SerializeAsString()}));
  EXPECT_TRUE(comes_true([&] { return metrics().find("\ndts_hub_rejected_letters_total 1\n") != std::string::npos; })) << metrics();
  while (const auto letter = (*inbox)->next(0ms)) EXPECT_NE(letter->subject, wire::inbox_prefix("leeds") + ".x");
  EXPECT_EQ(value("SELECT count(*) FROM beat WHERE clinic = 'kent'"), "0");
}

TEST_F(HubTest, ClinicThatFloods_IsAskedToWait_AndOthersAreServed) {
  RecordProperty("requirement", "FLEET-4");
  std::ofstream(config_, std::ios::app) << "[quota]\nmessages_per_s = 2\nsessions = 3\n";
  start_hub();
  const auto kent = add_clinic("kent");
  const auto leeds = add_clinic("leeds");
  int later = 0;
  for (int number = 0; number < 200; ++number) {
    const auto answer = ask<v1::FactsAnswer>(*kent, {.clinic = "kent", .matter = Matter::Facts}, session_of("s1", 1));
    EXPECT_FALSE(answer.has_refusal());
    later += answer.has_later() && answer.later().wait_s() == 1 ? 1 : 0;
  }
  EXPECT_GT(later, 0);
  EXPECT_EQ(ask<v1::FactsAnswer>(*leeds, {.clinic = "leeds", .matter = Matter::Facts}, session_of("s1", 1)).revision(), 1U);
  const std::string text = metrics();
  EXPECT_NE(text.find("dts_hub_clinic_slowed_messages_total{clinic=\"kent\"} " + std::to_string(later) + "\n"), std::string::npos) << text;
  EXPECT_NE(text.find("dts_hub_clinic_slowed_messages_total{clinic=\"leeds\"} 0\n"), std::string::npos);
  EXPECT_NE(text.find("dts_hub_clinic_quota_ratio{clinic=\"kent\"} 0.333"), std::string::npos) << text;
  EXPECT_NE(text.find("\ndts_hub_left_recordings 0\n"), std::string::npos);
  EXPECT_NE(log_text().find("clinic kent sends more messages"), std::string::npos) << log_text();
}

TEST_F(HubTest, AClinicWithTheKeyOfADashboard_DoesNotStopTheOthers) {
  const auto dashboard = wire::create_nkey().public_key;
  std::ofstream(config_, std::ios::app) << "[[dashboard]]\nkey = \"" << dashboard << "\"\n";
  start_hub();
  ASSERT_TRUE(comes_true([&] { return metrics().find("\ndts_hub_database_up 1\n") != std::string::npos; }));
  ASSERT_TRUE(catalogue_->add_clinic({.id = "leeds", .title = "", .nkey = dashboard}, "local:anna", 1));  // by way of an older dts-fleet
  const auto kent = add_clinic("kent");
  EXPECT_TRUE(upload(*kent, "kent", "recording", "s1").has_stored());
  EXPECT_NE(log_text().find("clinic 'leeds' has the key of a [[dashboard]]"), std::string::npos) << log_text();
}

TEST_F(HubTest, OlderDatabase_DoesNotBringBackAnErasedSession) {
  RecordProperty("requirement", "FLEET-3");
  start_hub();
  const auto kent = add_clinic("kent");
  EXPECT_TRUE(upload(*kent, "kent", "recording of s1", "s1").has_stored());
  v1::EraseSession erase;
  erase.set_session_id("s1");
  EXPECT_EQ(ask<v1::EraseAnswer>(*kent, {.clinic = "kent", .matter = Matter::Erase}, erase).files(), 1U);
  EXPECT_EQ(end_hub(SIGKILL), -SIGKILL);
  ASSERT_TRUE(database_->run("DELETE FROM erased"));
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  start_hub();
  EXPECT_TRUE(comes_true([&] { return value("SELECT count(*) FROM session") == "0"; }));
  EXPECT_EQ(value("SELECT count(*) FROM erased"), "1");
}

TEST_F(HubTest, OlderDatabase_UnderARunningHub_DoesNotBringBackAnErasedSession) {
  start_hub();
  const auto kent = add_clinic("kent");
  v1::EraseSession erase;
  erase.set_session_id("s1");
  ASSERT_FALSE(ask<v1::EraseAnswer>(*kent, {.clinic = "kent", .matter = Matter::Erase}, erase).has_refusal());
  ASSERT_TRUE(database_->run("DELETE FROM erased"));
  ASSERT_TRUE(catalogue_->put_session("kent", session_of("s1", 1)));
  // All connections end before a database can be replaced.
  ASSERT_TRUE(
      database_->run("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE application_name LIKE 'dts-hub%' "
                     "AND datname = current_database()"));
  EXPECT_TRUE(comes_true([&] { return value("SELECT count(*) FROM session") == "0"; }));
  EXPECT_EQ(value("SELECT count(*) FROM erased"), "1");
}

TEST_F(HubTest, SilentS3_DoesNotDelayARevocation) {
  const test::S3Server s3;
  const auto settings = s3.settings();
  s3.set_fault("* silence");
  std::ofstream(config_, std::ios::app) << "[store.s3]\nendpoint = \"" << settings.endpoint << "\"\nbucket = \"" << settings.bucket
                                        << "\"\nregion = \"" << settings.region << "\"\ncredentials = \"" << settings.credentials_file
                                        << "\"\n";
  ASSERT_TRUE(database_->run("INSERT INTO erased_file VALUES ('kent', sha256('a'))"));
  start_hub();
  const auto kent = add_clinic("kent");
  ASSERT_TRUE(comes_true([&] { return s3.requests().find(wire::hex_of(sum_of("a"))) != std::string::npos; }));
  EXPECT_EQ(fleet({"clinic", "revoke", "kent"}), 0);
  EXPECT_TRUE(comes_true([&] { return !kent->is_connected(); }));
  EXPECT_EQ(log_text().find("HEAD "), std::string::npos) << log_text();  // the hub still waits for S3
}

TEST_F(HubTest, Servers_MayStartLater_AndEndInBetween) {
  nats_->kill();
  server().stop(SIGINT);
  start_hub();
  std::this_thread::sleep_for(10ms);
  nats_->start(nats_settings());
  server().start();
  const auto kent = add_clinic("kent");
  EXPECT_TRUE(upload(*kent, "kent", "first", "s1").has_stored());
  server().stop(SIGINT);
  const auto later = upload(*kent, "kent", "second", "s2");
  EXPECT_TRUE(later.has_later()) << later.ShortDebugString();
  server().start();
  EXPECT_TRUE(comes_true([&] { return upload(*kent, "kent", "second", "s2").has_stored(); }));
  nats_->kill();
  nats_->start(nats_settings());
  EXPECT_TRUE(upload(*kent, "kent", "third", "s3").has_stored());
  EXPECT_EQ(end_hub(SIGTERM), 0);
}

TEST_F(HubTest, Rebuild_EntersStoredRecordings) {
  const std::string folder = folder_.path() + "/store/objects/kent";
  std::filesystem::create_directories(folder);
  const std::string recording = content_of(std::string(DTS_SOURCE_DIR) + "/tests/fuzz/corpus/xdf/closed.xdf");
  ASSERT_FALSE(recording.empty());
  std::ofstream(folder + "/" + wire::hex_of(sum_of(recording)), std::ios::binary) << recording;
  std::ofstream(folder + "/" + wire::hex_of(sum_of("x")), std::ios::binary) << "y";
  const auto rebuild = [&] {
    int status = 0;
    const pid_t child = spawn("dts-hub", {"rebuild", "--config", config_});
    return ::waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  EXPECT_EQ(rebuild(), 7);  // the second file is damaged
  EXPECT_EQ(value("SELECT concat_ws('|', clinic, session, part, bytes) FROM receipt"),
            "kent|20261121T144525Z-floor-1|1|" + std::to_string(recording.size()));
  EXPECT_EQ(value("SELECT concat_ws('|', id, revision, rig, state) FROM session"), "20261121T144525Z-floor-1|0|floor|unknown");
  EXPECT_EQ(catalogue_->put_session("kent", session_of("20261121T144525Z-floor-1", 1)), 1U);
  EXPECT_EQ(rebuild(), 7);
  EXPECT_EQ(value("SELECT count(*) FROM receipt"), "1");
}

}  // namespace
}  // namespace dts::fleet::hub
