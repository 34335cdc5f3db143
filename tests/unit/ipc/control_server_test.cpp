// SPDX-License-Identifier: Apache-2.0
// The control loop over real sockets, in its own time: what is answered, counted, limited, remembered and published.
#include "ipc/control_server.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>

#include "unit/access/key_fixture.h"
#include "unit/ipc/message_text.h"
#include "unit/ipc/turn_socket.h"
#include "unit/session/recordings_fixture.h"

namespace dts::ipc {
namespace {

/// Passes a little whenever somebody looks, so that the loop ends; the rest of the time passes by hand.
class LookedAtClock final : public core::Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_ += 200'000; }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override { now_ns_ = deadline_ns; }
  void advance_s(double seconds) { now_ns_ += static_cast<std::int64_t>(seconds * 1e9); }

 private:
  mutable std::atomic<std::int64_t> now_ns_{1'000'000'000};
};

class ControlTest : public session::RecordingsTest {
 protected:
  ControlTest() {
    recordings_ = session::Recordings::open(storage_, clock_, core::Log()).value();
    supervisor_ = std::make_unique<session::Supervisor>(clock_, core::Log(), nullptr,
                                                        session::SessionServices{.recordings = *recordings_, .worker = worker_});
    EXPECT_TRUE(supervisor_->add(session::Rig::create(session::floor_config("sim:floor?seed=3"), clock_, bell_).value()));
    keys_ = access::KeyStore::open(folder_.string() + "-keys").value();
    EXPECT_TRUE(keys_->add(access::key_for("eve", v1::ROLE_VIEWER, eve_)));
    EXPECT_TRUE(keys_->add(access::key_for("ina", v1::ROLE_ENGINEER, ina_)));
    auto data = std::make_unique<TurnSocket>();
    data_ = data.get();
    publisher_ = std::make_unique<PublishThread>(std::move(data), bell_, supervisor_->rigs(), time_, 7);
    static_cast<void>(publisher_->start({}));
    handler_ = std::make_unique<CommandHandler>(*supervisor_, time_, Identity{.instance_id = 7, .version = "v"}, std::vector<std::string>{},
                                                KeyCommands{keys_.get(), time_, std::nullopt});
    server_ = std::make_unique<ControlServer>(
        ControlSocket::bind(context_, "ipc://" + folder_.string() + "/c").value(), access::Gate(keys_.get()), *supervisor_, *handler_,
        *publisher_, time_, core::Log(std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log_))));
  }
  ~ControlTest() override {
    data_->end();
    publisher_->stop();
    server_.reset();
    std::filesystem::remove_all(folder_.string() + "-keys");
  }

  zmq::socket_t client() {
    zmq::socket_t socket(clients_, zmq::socket_type::dealer);
    socket.set(zmq::sockopt::linger, 0);
    socket.connect("ipc://" + folder_.string() + "/c");
    return socket;
  }
  static void send(zmq::socket_t& socket, const std::vector<std::string>& frames) {
    for (const std::string& frame : frames) {
      socket.send(zmq::buffer(frame), &frame == &frames.back() ? zmq::send_flags::none : zmq::send_flags::sndmore);
    }
  }
  static std::string request(const std::string& text) { return message_of<v1::Request>(text).SerializeAsString(); }
  /// Serves until an answer arrives; returns it as text, behind the frames before it.
  std::string answer(zmq::socket_t& socket) {
    std::string out;
    zmq::message_t frame;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!socket.recv(frame, zmq::recv_flags::dontwait)) {
      if (std::chrono::steady_clock::now() > deadline) return "no answer";
      server_->serve(1);
    }
    for (; frame.more(); static_cast<void>(socket.recv(frame))) out += "'" + frame.to_string() + "' ";
    v1::Response response;
    EXPECT_TRUE(response.ParseFromString(frame.to_string()));
    return out + text(response);
  }
  std::string ask(zmq::socket_t& socket, const std::string& request_text) {
    send(socket, {request(request_text)});
    return answer(socket);
  }
  /// Asks as dts-relay does for the client with this key; its ticket is "T".
  std::string ask_as(zmq::socket_t& relay, const access::KeyPair& key, const std::string& request_text) {
    send(relay, {"T", key.public_key, request(request_text)});
    const std::string got = answer(relay);
    EXPECT_TRUE(got.starts_with("'T' ")) << got;
    return got.substr(4);
  }
  /// Lets the loop take at least one tick.
  void tick() {
    time_.advance_s(0.05);
    server_->serve(1);
  }
  [[nodiscard]] std::uint64_t rejected() { return handler_->status().rejected_requests_total(); }
  [[nodiscard]] std::vector<std::string> entries() {
    std::vector<std::string> out;
    const std::vector<record::AuditEntry> all = recordings_->catalogue().audit(1000).value();
    for (const record::AuditEntry& entry : all) out.push_back(entry.who + " " + entry.what + " " + entry.target + " " + entry.result);
    return out;
  }

  LookedAtClock time_;
  std::ostringstream log_;
  const access::KeyPair eve_ = access::new_pair();
  const access::KeyPair ina_ = access::new_pair();
  zmq::context_t context_{1};
  zmq::context_t clients_{1};
  std::unique_ptr<access::KeyStore> keys_;
  TurnSocket* data_ = nullptr;
  std::unique_ptr<PublishThread> publisher_;
  std::unique_ptr<CommandHandler> handler_;
  std::unique_ptr<ControlServer> server_;
};

TEST_F(ControlTest, WhatIsNoRequest_IsAnsweredCountedAndOneLineOfTheLogASecond) {
  const std::string status = request("request_id: 'q' status {}");
  const std::string id64 = std::string(64, 'i');
  const std::string hint = "\" hint: \"compare the versions of client and daemon: dtsctl doctor\" }";
  const std::string frames =
      "error { code: ERROR_CODE_INVALID_ARGUMENT what: \"a request must be one frame, or an empty frame and then one frame" + hint;
  const std::string id = "error { code: ERROR_CODE_INVALID_ARGUMENT what: \"request_id must have 1..64 bytes" + hint;
  const struct {
    std::vector<std::string> frames;
    std::string answer;
    bool is_rejected;
  } rows[]{
      {{status}, "request_id: \"q\" status {", false},
      {{"", status}, "'' request_id: \"q\" status {", false},
      {{"x", status}, frames, true},
      {{"", "", status}, frames, true},
      {{"a", "b", "c", "d", status}, frames, true},
      {{"ticket", std::string(39, 'k'), status}, frames, true},
      {{"ticket", std::string(41, 'k'), status}, frames, true},
      {{"\xff"}, "error { code: ERROR_CODE_INVALID_ARGUMENT what: \"the message is not a dts.v1.Request" + hint, true},
      {{""}, id, true},
      {{request("status {}")}, id, true},
      {{request("request_id: '" + id64 + "' status {}")}, "request_id: \"" + id64 + "\" status {", false},
      {{request("request_id: '" + id64 + "i' status {}")}, id, true},
      {{request("request_id: 'q'")},
       "request_id: \"q\" error { code: ERROR_CODE_INVALID_ARGUMENT what: \"the request contains no command",
       false},
  };
  zmq::socket_t local = client();
  std::uint64_t count = 0;
  for (const auto& row : rows) {
    send(local, row.frames);
    const std::string got = answer(local);
    EXPECT_EQ(got.substr(0, row.answer.size()), row.answer);
    EXPECT_EQ(rejected(), count += row.is_rejected ? 1 : 0) << row.answer;
    tick();
    EXPECT_EQ(std::ranges::count(log_.str(), '\n'), count == 0 ? 0 : 1);
  }
  time_.advance_s(1);
  tick();
  const std::string log = log_.str();
  EXPECT_EQ(std::ranges::count(log, '\n'), 2) << log;
  const auto number = [&](std::size_t line_at) { return std::stoi(log.substr(log.find("rejected ", line_at) + 9)); };
  EXPECT_EQ(number(0) + number(log.find('\n')), static_cast<int>(count)) << log;
  EXPECT_TRUE(log.ends_with(", the last by local\n"));
}

TEST_F(ControlTest, CommandWithAnIdOfBefore_IsNotExecutedAgain) {
  RecordProperty("requirement", "PUB-7");
  zmq::socket_t local = client();
  zmq::socket_t other = client();
  zmq::socket_t relay = client();
  const std::string add = "request_id: 'once' add_key { name: 'anna' role: ROLE_VIEWER public_key: '" + std::string(40, 'a') + "' }";
  const std::string added = ask(local, add);
  EXPECT_TRUE(added.starts_with("request_id: \"once\" keys {")) << added;
  EXPECT_EQ(ask(other, add), added) << "a second execution would be refused";
  const std::string revoke = "request_id: 'once' revoke_key { name: 'anna' }";
  EXPECT_TRUE(ask(other, revoke).starts_with("error { code: ERROR_CODE_INVALID_ARGUMENT what: \"request_id was used for another request"));
  EXPECT_EQ(rejected(), 1U);
  EXPECT_TRUE(ask_as(relay, ina_, revoke).starts_with("request_id: \"once\" keys {")) << "the ids of other senders are their own";
  for (const char* look : {"status", "list_rigs"}) {
    EXPECT_TRUE(ask(local, "request_id: 'once' " + std::string(look) + " {}")
                    .starts_with("request_id: \"once\" " + std::string(look == std::string("status") ? "status" : "rigs")));
  }
  EXPECT_EQ(entries(), (std::vector<std::string>{"local key_new anna:viewer ok", "key:ina key_revoke anna ok"}));
}

TEST_F(ControlTest, EveryCommandThatChangesSomething_IsRemembered) {
  zmq::socket_t local = client();
  for (const std::string command : {"start_session", "stop_session", "mark", "trial", "resume_session", "add_key", "revoke_key",
                                    "note_login", "correct_session", "delete_session", "erase_subject", "tare"}) {
    const std::string id = "request_id: '" + command + "' ";
    static_cast<void>(ask(local, id + command + " {}"));
    EXPECT_TRUE(ask(local, id + command + " {} on_behalf_of: 'x'")
                    .starts_with("error { code: ERROR_CODE_INVALID_ARGUMENT what: \"request_id was used"))
        << command;
  }
}

TEST_F(ControlTest, KeyOfARelayedCommand_MayWhatItsRoleMayNow) {
  zmq::socket_t relay = client();
  zmq::socket_t local = client();
  const std::string refused =
      "request_id: \"q\" error { code: ERROR_CODE_NOT_ALLOWED what: \"this command needs the role operator; key:eve has viewer\"";
  EXPECT_EQ(ask_as(relay, eve_, "request_id: 'q' mark { text: 'x' }").substr(0, refused.size()), refused);
  EXPECT_EQ(entries(), (std::vector<std::string>{"key:eve mark  not_allowed"}));
  EXPECT_TRUE(ask_as(relay, ina_, "request_id: 'q' list_keys {}").starts_with("request_id: \"q\" keys {"));

  EXPECT_TRUE(ask(local, "request_id: 'r' revoke_key { name: 'ina' }").starts_with("request_id: \"r\" keys {"));
  const std::string revoked =
      "request_id: \"q\" error { code: ERROR_CODE_NOT_ALLOWED what: \"this command needs the role engineer; revoked key";
  EXPECT_EQ(ask_as(relay, ina_, "request_id: 'q' list_keys {}").substr(0, revoked.size()), revoked) << "at the next command";
  EXPECT_NE(ask_as(relay, access::new_pair(), "request_id: 'q' status {}").find("revoked key has none"), std::string::npos);
}

/// What a client on another machine sends cannot change or hide its key, which is a frame of its own.
TEST_F(ControlTest, KeyOfARelayedCommand_CountsForWhatIsNoRequest) {
  zmq::socket_t relay = client();
  send(relay, {"T", eve_.public_key, "\xff"});
  EXPECT_TRUE(answer(relay).starts_with("'T' error { code: ERROR_CODE_INVALID_ARGUMENT what: \"the message is not a dts.v1.Request"));
  tick();
  EXPECT_TRUE(log_.str().ends_with(", the last by key:eve\n")) << log_.str();
}

TEST_F(ControlTest, FailedCommands_FillTheAuditTrailNoFurtherThanTwenty) {
  zmq::socket_t local = client();
  for (int turn = 0; turn < 25; ++turn) static_cast<void>(ask(local, "request_id: 'q" + std::to_string(turn) + "' mark {}"));
  EXPECT_EQ(entries().size(), 20U);
  static_cast<void>(ask(local, "request_id: 'q' note_login { address: '::1' }"));
  EXPECT_EQ(entries().size(), 21U) << "what succeeds is always noted";
}

TEST_F(ControlTest, StatusLeavesOnceASecond_AndAfterEveryChange) {
  tick();
  EXPECT_EQ(data_->turn(), "dtsd/status=v ");
  tick();
  EXPECT_EQ(data_->turn(), "");
  time_.advance_s(0.9);
  tick();
  EXPECT_EQ(data_->turn(), "dtsd/status=v ");
  zmq::socket_t local = client();
  EXPECT_NE(ask(local, "request_id: 'q' start_session { rig: 'floor' protocol: 'free' }").find("SESSION_STATE_STARTING"),
            std::string::npos);
  tick();
  EXPECT_EQ(data_->turn(), "floor/session dtsd/status=v ");
  tick();
  EXPECT_EQ(data_->turn(true), "dtsd/status=v floor/session ") << "both are retained";

  // The rig's threads do not run: the recording is never closed.
  send(local, {request("request_id: 's' stop_session {}")});
  for (int turn = 0; turn < 3; ++turn) tick();
  zmq::message_t none;
  EXPECT_FALSE(local.recv(none, zmq::recv_flags::dontwait));
  time_.advance_s(11);
  EXPECT_TRUE(answer(local).starts_with("request_id: \"s\" error { code: ERROR_CODE_TIMEOUT what: \"the recording of session"));
}

/// The clock of the device stands still: a tare is never complete.
class SilentControlTest : public ControlTest {
 protected:
  SilentControlTest() {
    supervisor_->start();
    EXPECT_TRUE(eventually([&] { return supervisor_->states().at(0).acquisition.device == device::DeviceState::Streaming; }));
  }
  ~SilentControlTest() override { supervisor_->stop(); }
};

TEST_F(SilentControlTest, PendingCommand_IsAnsweredToTheNewestAsker_AndWithdrawnAfterTenSeconds) {
  zmq::socket_t first = client();
  zmq::socket_t second = client();
  zmq::socket_t third = client();
  zmq::message_t none;
  const std::string tare = request("request_id: 't' tare { rig: 'floor' }");
  send(first, {tare});
  EXPECT_TRUE(ask(third, "request_id: 'q' status {}").starts_with("request_id: \"q\" status {")) << "the thread does not wait";
  for (int turn = 0; turn < 20; ++turn) tick();
  send(second, {"", tare});
  for (int turn = 0; turn < 20; ++turn) tick();
  EXPECT_TRUE(ask(third, "request_id: 't' mark { text: 'x' }")
                  .starts_with("error { code: ERROR_CODE_INVALID_ARGUMENT what: \"request_id was used for another"));
  time_.advance_s(7.5);
  tick();
  EXPECT_FALSE(second.recv(none, zmq::recv_flags::dontwait));
  time_.advance_s(1);
  const std::string timeout =
      "request_id: \"t\" error { code: ERROR_CODE_TIMEOUT what: \"the tare did not finish within 10 s\" hint: \"see dtsctl status\" }";
  EXPECT_EQ(answer(second), "'' " + timeout);
  EXPECT_FALSE(first.recv(none, zmq::recv_flags::dontwait));
  EXPECT_EQ(entries().back(), "local tare floor timeout");
  send(first, {tare});
  EXPECT_EQ(answer(first), timeout) << "remembered";

  for (int number = 0; number < 64; ++number) send(first, {request("request_id: 'n" + std::to_string(number) + "' tare { rig: 'floor' }")});
  send(first, {request("request_id: 'n64' tare { rig: 'floor' }")});
  EXPECT_TRUE(answer(first).starts_with("error { code: ERROR_CODE_INVALID_ARGUMENT what: \"too many commands wait for their answers"));
  time_.advance_s(11);
  for (int number = 0; number < 64; ++number)
    EXPECT_TRUE(answer(first).starts_with("request_id: \"n" + std::to_string(number) + "\" error")) << number;
}

}  // namespace
}  // namespace dts::ipc
