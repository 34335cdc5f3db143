// SPDX-License-Identifier: Apache-2.0
// With a real nats-server.
#include "fleet/link/link.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <thread>

#include "core/descriptor.h"
#include "fleet/wire/nkey.h"
#include "fleet/wire/subjects.h"
#include "support/nats_server.h"

namespace dts::fleet::link {
namespace {

using namespace std::chrono_literals;

bool becomes(const std::function<bool()>& condition) {
  for (int tries = 0; tries < 2000; ++tries) {
    if (condition()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

std::string quoted(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += "\"" + text + "\",";
  return "[" + list + "]";
}

std::string user(const std::string& key, const wire::Permissions& permissions) {
  return "{nkey: " + key + ", permissions: {publish: {allow: " + quoted(permissions.publish) +
         "}, subscribe: {allow: " + quoted(permissions.subscribe) + "}, allow_responses: {max: 1, ttl: \"30s\"}}}\n";
}

std::string users(const std::string& list) { return "authorization { users = [\n" + list + "] }\n"; }

class LinkTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::NatsServer::program()) GTEST_SKIP() << "nats-server is not installed";
  }
  static std::unique_ptr<Link> connect(LinkOptions options, int port) {
    if (options.servers.empty()) options.servers = {"nats://127.0.0.1:" + std::to_string(port)};
    auto link = Link::open(options, core::Log());
    EXPECT_TRUE(link) << (link ? "" : core::to_string(link.error()));
    return link ? std::move(*link) : nullptr;
  }
};

TEST_F(LinkTest, ARequestGetsItsAnswer) {
  const test::NatsServer server;
  const auto hub = connect({.name = "hub"}, server.port());
  const auto clinic = connect({.name = "clinic"}, server.port());
  ASSERT_TRUE(becomes([&] { return hub->is_connected() && clinic->is_connected(); }));
  const auto questions = hub->subscribe("dts.v1.*.beat", "hubs");
  ASSERT_TRUE(questions);
  std::thread answers([&] {
    const auto letter = (*questions)->next(20s);
    EXPECT_TRUE(letter && hub->publish({.subject = letter->reply, .data = letter->data + " too"}));
  });
  // The subscription may be on its way: without a listener the server answers at once.
  core::Result<std::string> answer = core::fail(core::ErrorCode::Unreachable, "");
  EXPECT_TRUE(becomes([&] {
    answer = clinic->request("dts.v1.kent.beat", std::string("a\0b", 3), 20s);
    return answer || answer.error().code != core::ErrorCode::Unreachable;
  }));
  answers.join();
  ASSERT_TRUE(answer) << core::to_string(answer.error());
  EXPECT_EQ(*answer, std::string("a\0b too", 7));
}

TEST_F(LinkTest, ItConnectsAgainToAServerThatWasKilled) {
  test::NatsServer server;
  const auto link = connect({.name = "kent"}, server.port());
  ASSERT_TRUE(becomes([&] { return link->is_connected(); }));
  const auto letters = link->subscribe("a.b");
  ASSERT_TRUE(letters);
  server.kill();
  ASSERT_TRUE(becomes([&] { return !link->is_connected(); }));
  EXPECT_EQ(link->publish({.subject = "a.b"}).error().code, core::ErrorCode::Unreachable);
  EXPECT_TRUE(becomes([&] { return !link->problem().empty(); }));
  server.start();
  ASSERT_TRUE(becomes([&] { return link->is_connected() && link->connections() == 2; }));
  EXPECT_EQ(link->problem(), "");
  ASSERT_TRUE(link->publish({.subject = "a.b", .data = "again"}));
  const auto letter = (*letters)->next(20s);
  ASSERT_TRUE(letter);
  EXPECT_EQ(letter->data, "again");
}

TEST_F(LinkTest, ItWaitsForAServerThatStartsLater) {
  test::NatsServer server;
  server.kill();
  const auto link = connect({.name = "kent"}, server.port());
  EXPECT_FALSE(link->is_connected());
  server.start();
  EXPECT_TRUE(becomes([&] { return link->is_connected(); }));
}

TEST_F(LinkTest, AKeyOpensItsSubjectsOnly) {
  const wire::NKey kent = wire::create_nkey();
  const wire::NKey hub_key = wire::create_nkey();
  const test::NatsServer server(
      users(user(kent.public_key, wire::clinic_permissions("kent")) + user(hub_key.public_key, wire::hub_permissions())));
  const auto hub = connect({.name = "hub", .seed = hub_key.seed, .inbox_prefix = std::string(wire::kHubInboxPrefix)}, server.port());
  const auto clinic = connect({.name = "kent", .seed = kent.seed, .inbox_prefix = wire::inbox_prefix("kent")}, server.port());
  ASSERT_TRUE(becomes([&] { return hub->is_connected() && clinic->is_connected(); }));
  const auto beats = hub->subscribe(wire::of_all_clinics(wire::Matter::Beat));
  ASSERT_TRUE(beats);
  const std::string inbox = clinic->new_inbox();
  EXPECT_TRUE(wire::is_inbox_of("kent", inbox)) << inbox;
  const auto replies = clinic->subscribe(inbox);
  ASSERT_TRUE(replies);
  std::optional<Letter> letter;
  ASSERT_TRUE(becomes([&] {
    EXPECT_TRUE(clinic->publish({.subject = "dts.v1.essex.beat", .reply = inbox, .data = "forged"}));
    EXPECT_TRUE(clinic->publish({.subject = "dts.v1.kent.beat", .reply = inbox, .data = "own"}));
    letter = (*beats)->next(100ms);
    return letter.has_value();
  }));
  EXPECT_EQ(letter->subject, "dts.v1.kent.beat");
  ASSERT_TRUE(hub->publish({.subject = letter->reply, .data = "seen"}));
  std::optional<Letter> reply;
  // The first ones may say that nobody listened yet.
  ASSERT_TRUE(becomes([&] { return (reply = (*replies)->next(100ms)) && !reply->has_no_listener; })) << server.log_text();
  EXPECT_EQ(reply->data, "seen");
  EXPECT_TRUE(becomes([&] { return server.log_text().find("dts.v1.essex.beat") != std::string::npos; }))
      << "the refusal is in the server's log";
}

TEST_F(LinkTest, ARemovedKeyIsRejectedUntilItIsThereAgain) {
  const wire::NKey kent = wire::create_nkey();
  const wire::NKey other = wire::create_nkey();
  test::NatsServer server(users(user(kent.public_key, wire::clinic_permissions("kent")) + user(other.public_key, wire::hub_permissions())));
  const auto link = connect({.name = "kent", .seed = kent.seed, .rejection = "ask the centre"}, server.port());
  ASSERT_TRUE(becomes([&] { return link->is_connected(); }));
  EXPECT_FALSE(link->is_rejected());
  server.reload(users(user(other.public_key, wire::hub_permissions())));
  EXPECT_TRUE(becomes([&] { return link->is_rejected(); }));
  EXPECT_FALSE(link->is_connected());
  EXPECT_EQ(link->problem(), "the server rejects the key (Authorization Violation): ask the centre");
  server.reload(users(user(kent.public_key, wire::clinic_permissions("kent")) + user(other.public_key, wire::hub_permissions())));
  EXPECT_TRUE(becomes([&] { return link->is_connected(); })) << "it tries again by itself";
  EXPECT_FALSE(link->is_rejected());
}

TEST_F(LinkTest, SilentServer_HoldsUpNoCaller) {
  test::NatsServer server;
  const auto link = connect({.name = "kent"}, server.port());
  ASSERT_TRUE(becomes([&] { return link->is_connected(); }));
  ::kill(server.pid(), SIGSTOP);  // its TCP acknowledges what its buffers hold; then the line takes nothing more
  const std::string data(512 * 1024, 'x');
  core::Status published;
  for (int letters = 0; published && letters < 1000; ++letters) published = link->publish({.subject = "a.b", .data = data});
  EXPECT_EQ(published.error().code, core::ErrorCode::Timeout);
  EXPECT_FALSE(link->has_room());
  EXPECT_TRUE(becomes([&] { return !link->is_connected(); }));
  EXPECT_NE(link->problem().find("silent"), std::string::npos) << link->problem();
  EXPECT_EQ(link->publish({.subject = "a.b"}).error().code, core::ErrorCode::Unreachable);
  ::kill(server.pid(), SIGCONT);
  ASSERT_TRUE(becomes([&] { return link->is_connected(); })) << link->problem();
  EXPECT_TRUE(link->has_room());
}

TEST_F(LinkTest, SilentServerWithNothingToSend_IsNoticed) {
  test::NatsServer server;
  const auto link = connect({.name = "kent"}, server.port());
  ASSERT_TRUE(becomes([&] { return link->is_connected(); }));
  ::kill(server.pid(), SIGSTOP);
  EXPECT_TRUE(becomes([&] { return !link->is_connected(); }));
  ::kill(server.pid(), SIGCONT);
  EXPECT_TRUE(becomes([&] { return link->is_connected(); })) << link->problem();
}

TEST_F(LinkTest, LinkToASilentServer_EndsBeforeItIsConnected) {
  test::NatsServer server;
  ::kill(server.pid(), SIGSTOP);  // the kernel accepts the connection; nobody says INFO
  const auto link = connect({.name = "kent"}, server.port());
  EXPECT_FALSE(link->is_connected());
  EXPECT_EQ(link->connections(), 0U);
}

TEST_F(LinkTest, MessageAboveTheLimitOfTheServer_Fails) {
  constexpr std::size_t kLimit = 600'000;
  const test::NatsServer server("max_payload: " + std::to_string(kLimit) + "\n");
  const auto link = connect({.name = "kent"}, server.port());
  ASSERT_TRUE(becomes([&] { return link->is_connected(); }));
  EXPECT_EQ(link->publish({.subject = "a.b", .data = std::string(kLimit + 1, 'x')}).error().code, core::ErrorCode::LimitExceeded);
  EXPECT_TRUE(link->publish({.subject = "a.b", .data = std::string(kLimit, 'x')}));
  EXPECT_EQ(link->publish({.subject = "a b"}).error().code, core::ErrorCode::InvalidArgument);
  EXPECT_EQ(link->publish({.subject = "a", .reply = "x\r\nPING"}).error().code, core::ErrorCode::InvalidArgument);
  EXPECT_TRUE(link->is_connected());
}

TEST_F(LinkTest, ServerWithALimitBelowAChunk_IsNoConnection) {
  const test::NatsServer server("max_payload: 500000\n");
  const auto link = connect({.name = "kent"}, server.port());
  EXPECT_TRUE(becomes([&] { return link->problem().find("max_payload") != std::string::npos; })) << link->problem();
  EXPECT_EQ(link->connections(), 0U);
  EXPECT_EQ(link->publish({.subject = "a.b", .data = std::string(500'001, 'x')}).error().code, core::ErrorCode::Unreachable);
}

TEST_F(LinkTest, RequestWithoutAListener_FailsAtOnce) {
  const test::NatsServer server;
  const auto link = connect({.name = "kent"}, server.port());
  ASSERT_TRUE(becomes([&] { return link->is_connected(); }));
  const auto answer = link->request("a.b", "x", 1h);
  EXPECT_EQ(answer.error().code, core::ErrorCode::Unreachable);
  const auto answers = link->subscribe("inbox.1");
  ASSERT_TRUE(answers);
  ASSERT_TRUE(link->publish({.subject = "a.b", .reply = "inbox.1", .data = "x"}));
  const auto letter = (*answers)->next(1h);
  ASSERT_TRUE(letter);
  EXPECT_TRUE(letter->has_no_listener);
}

TEST_F(LinkTest, LettersBeforeTheEnd_Arrive) {
  const test::NatsServer server;
  const auto reader = connect({.name = "reader"}, server.port());
  ASSERT_TRUE(becomes([&] { return reader->is_connected(); }));
  const auto letters = reader->subscribe("a.b");
  ASSERT_TRUE(letters);
  ASSERT_TRUE(becomes([&] { return reader->publish({.subject = "a.b", .data = "there"}) && (*letters)->next(100ms); }));
  auto writer = connect({.name = "writer"}, server.port());
  ASSERT_TRUE(becomes([&] { return writer->is_connected(); }));
  for (int count = 0; count < 20; ++count) ASSERT_TRUE(writer->publish({.subject = "a.b", .data = std::string(100'000, 'x')}));
  writer.reset();
  for (int count = 0; count < 20; ++count) {
    std::optional<Letter> letter;
    ASSERT_TRUE(becomes([&] { return (letter = (*letters)->next(100ms)).has_value(); })) << count;
    EXPECT_EQ(letter->data.size(), 100'000U);
  }
}

/// Not nats-server: sends `greeting`, waits for the client's first bytes, and then sends `endless` again and again.
class StrangeServer {
 public:
  StrangeServer(std::string greeting, std::string endless) : greeting_(std::move(greeting)), endless_(std::move(endless)) {
    sockaddr_in address{.sin_family = AF_INET, .sin_port = 0, .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}, .sin_zero = {}};
    socklen_t length = sizeof(address);
    EXPECT_EQ(::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), length), 0);
    EXPECT_EQ(::listen(listener_.get(), 8), 0);
    EXPECT_EQ(::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &length), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }
  [[nodiscard]] LinkOptions options() const { return {.servers = {"nats://127.0.0.1:" + std::to_string(port_)}, .name = "kent"}; }

 private:
  static bool is_ready(int descriptor) {
    pollfd polled{.fd = descriptor, .events = POLLIN, .revents = 0};
    return ::poll(&polled, 1, 10) > 0;
  }
  void serve(const std::stop_token& stop) const {
    while (!stop.stop_requested()) {
      if (!is_ready(listener_.get())) continue;
      const core::Descriptor client(::accept(listener_.get(), nullptr, nullptr));
      (void)::send(client.get(), greeting_.data(), greeting_.size(), MSG_NOSIGNAL);
      while (!stop.stop_requested() && !is_ready(client.get())) continue;
      for (std::size_t at = 0; !stop.stop_requested();) {
        const auto sent = ::send(client.get(), endless_.data() + at, endless_.size() - at, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent < 0 && errno != EAGAIN) break;
        if (sent > 0) at = (at + static_cast<std::size_t>(sent)) % endless_.size();
      }
    }
  }

  std::string greeting_;
  std::string endless_;
  core::Descriptor listener_{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  int port_ = 0;
  std::jthread thread_{};
};

constexpr const char* kInfo = "INFO {\"max_payload\":1048576}\r\n";

TEST(LinkToAStrangeServer, ThatSendsWithoutAnEnd_DoesNotWaitForEver) {
  const StrangeServer server(kInfo, "+OK\r\n");
  const auto link = Link::open(server.options(), core::Log()).value();
  EXPECT_TRUE(becomes([&] { return link->problem().find("does not answer") != std::string::npos; })) << link->problem();
}

TEST(LinkToAStrangeServer, ThatDoesNotBeginWithInfo_IsNoConnection) {
  const StrangeServer server(std::string("+OK\r\n") + kInfo, "PONG\r\n");
  const auto link = Link::open(server.options(), core::Log()).value();
  EXPECT_TRUE(becomes([&] { return link->problem().find("INFO") != std::string::npos; })) << link->problem();
  EXPECT_EQ(link->connections(), 0U);
}

class LinkTlsTest : public LinkTest {
 protected:
  /// Makes an authority and a certificate for `host`; returns the server's settings.
  std::string certify(const std::string& host) {
    const std::string folder = folder_.path();
    const auto run = [](const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; };
    EXPECT_TRUE(run("openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=authority -keyout " + folder + "/ca.key -out " + folder +
                    "/ca.pem"));
    EXPECT_TRUE(
        run("openssl req -newkey rsa:2048 -nodes -subj /CN=server -keyout " + folder + "/server.key -out " + folder + "/server.csr"));
    std::ofstream(folder + "/names") << "subjectAltName=" << host << '\n';
    EXPECT_TRUE(run("openssl x509 -req -days 2 -in " + folder + "/server.csr -CA " + folder + "/ca.pem -CAkey " + folder +
                    "/ca.key -CAcreateserial -extfile " + folder + "/names -out " + folder + "/server.pem"));
    std::ostringstream pem;
    pem << std::ifstream(folder + "/ca.pem").rdbuf();
    authority_ = pem.str();
    return "tls { cert_file: \"" + folder + "/server.pem\", key_file: \"" + folder + "/server.key\" }\n";
  }
  std::string authority_;

 private:
  test::TemporaryFolder folder_{};
};

TEST_F(LinkTlsTest, TheServerMustHaveACertificateOfItsNameFromTheAuthority) {
  const test::NatsServer server(certify("IP:127.0.0.1"));
  const std::string address = "tls://127.0.0.1:" + std::to_string(server.port());
  const auto link = connect({.servers = {address}, .ca_pem = authority_, .name = "kent"}, server.port());
  ASSERT_TRUE(becomes([&] { return link->is_connected(); })) << link->problem();
  const std::string known = authority_;
  certify("IP:127.0.0.1");  // of another authority
  const auto stranger = connect({.servers = {address}, .ca_pem = authority_, .name = "kent"}, server.port());
  EXPECT_FALSE(becomes([&, tries = 0]() mutable { return stranger->is_connected() || ++tries > 100; }) && stranger->is_connected());
}

TEST_F(LinkTlsTest, ACertificateOfAnotherNameIsRejected) {
  const test::NatsServer server(certify("DNS:centre.example.org"));
  const auto link =
      connect({.servers = {"tls://127.0.0.1:" + std::to_string(server.port())}, .ca_pem = authority_, .name = "kent"}, server.port());
  EXPECT_FALSE(becomes([&, tries = 0]() mutable { return link->is_connected() || ++tries > 100; }) && link->is_connected());
}

TEST(LinkOptionsTest, WithoutTlsOnlyThisMachineIsPossible) {
  for (const char* const server : {"nats://192.0.2.1:4222", "nats://127.0.0.1.example.org:4222", "127.0.0.1:4222", ""}) {
    EXPECT_EQ(Link::open({.servers = {server}, .name = "kent"}, core::Log()).error().code, core::ErrorCode::InvalidArgument) << server;
  }
  EXPECT_EQ(Link::open({.name = "kent"}, core::Log()).error().code, core::ErrorCode::InvalidArgument);
  const auto without_authority = Link::open({.servers = {"tls://192.0.2.1:4222"}, .name = "kent"}, core::Log());
  ASSERT_FALSE(without_authority);
  EXPECT_NE(without_authority.error().what.find("authority"), std::string::npos);
}

}  // namespace
}  // namespace dts::fleet::link
