// SPDX-License-Identifier: Apache-2.0
// Who may do what, seen from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dts/v1/gateway.pb.h"
#include "gateway/access/password.h"
#include "gateway/access/user_file.h"
#include "gateway/gateway_process.h"
#include "gateway/raw_client.h"

namespace dts::test {
namespace {

constexpr const char* kPassword = "correct horse battery";

/// Sends a command over a WebSocket; nothing when there is no answer.
std::optional<v1::Response> response_to(RawClient& tab, const v1::Request& command) {
  v1::FromBrowser message;
  *message.mutable_request() = command;
  tab.send(frame(kFin | kBinary, message.SerializeAsString()));
  while (const auto got = read_frame(tab)) {
    v1::FromGateway answer;
    if (got->opcode == kBinary && answer.ParseFromString(got->payload) && answer.has_response()) return answer.response();
  }
  return std::nullopt;
}

v1::Request start_command() {
  v1::Request command;
  command.set_request_id("attack-1");
  command.mutable_start_session()->set_rig("floor");
  command.mutable_start_session()->set_protocol("free");
  return command;
}

class GatewayRoles : public testing::Test {
 protected:
  /// A gateway that wants a login, and its users.
  std::vector<std::string> with_users() {
    const std::string file = daemon_.directory() / "users";
    const std::string hash = gateway::hash_password(gateway::Secret(kPassword)).value();
    EXPECT_TRUE(gateway::add_user(file, {"viola", v1::ROLE_VIEWER, hash}).has_value());
    EXPECT_TRUE(gateway::add_user(file, {"otto", v1::ROLE_OPERATOR, hash}).has_value());
    return {"--users", file};
  }
  /// The cookie of a login, as a header; empty: refused.
  static std::string log_in(std::uint16_t port, const std::string& user, const std::string& password) {
    const std::string body = R"({"user":")" + user + R"(","password":")" + password + "\"}";
    RawClient client(port);
    client.send(request(port, "POST /api/login",
                        "Origin: http://127.0.0.1:" + std::to_string(port) +
                            "\r\nContent-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n",
                        body));
    const std::string answer = client.read_answer();
    const std::size_t at = answer.find("dts_token=");
    if (status_of(answer) != "200" || at == std::string::npos) return {};
    return "Cookie: " + answer.substr(at, answer.find(';', at) - at) + "\r\n";
  }
  static std::string status_of_get(std::uint16_t port, const std::string& path, const std::string& headers) {
    RawClient client(port);
    client.send(request(port, "GET " + path, headers));
    return status_of(client.read_answer());
  }

  DaemonProcess daemon_;
};

TEST_F(GatewayRoles, WithoutAToken_ThereIsOnlyTheLoginPage) {
  const GatewayProcess gateway(daemon_, with_users());
  ASSERT_NE(gateway.port(), 0) << gateway.log();
  const std::string cookie = log_in(gateway.port(), "viola", kPassword);
  ASSERT_FALSE(cookie.empty());
  std::string wrong = cookie;
  wrong[wrong.size() - 4] = wrong[wrong.size() - 4] == 'A' ? 'B' : 'A';

  for (const std::string& forged :
       {std::string(), wrong, std::string("Cookie: dts_token=\r\n"), std::string("Cookie: dts_token=operator\r\n"),
        std::string("Cookie: user=otto; role=engineer\r\n"), "Cookie: dts_token=" + std::string(4000, 'A') + "\r\n",
        std::string("X-Forwarded-For: 127.0.0.1\r\n"), std::string("X-Forwarded-User: otto\r\n")}) {
    EXPECT_EQ(status_of_get(gateway.port(), "/ws", upgrade_headers(gateway.port()) + forged), "401") << forged;
    EXPECT_EQ(status_of_get(gateway.port(), "/api/sessions/x/report", forged), "401") << forged;
  }
  EXPECT_EQ(status_of_get(gateway.port(), "/", {}), "200");
  EXPECT_EQ(status_of_get(gateway.port(), "/ws", upgrade_headers(gateway.port()) + cookie), "101");
  EXPECT_EQ(log_in(gateway.port(), "viola", "wrong wrong wrong"), "");
}

TEST_F(GatewayRoles, AViewerCannotStart_WhateverTheRequestSays) {
  RecordProperty("requirement", "SEC-6");
  const GatewayProcess gateway(daemon_, with_users());
  ASSERT_NE(gateway.port(), 0) << gateway.log();
  auto viewer = open_websocket(gateway.port(), log_in(gateway.port(), "viola", kPassword));
  auto operator_tab = open_websocket(gateway.port(), log_in(gateway.port(), "otto", kPassword));
  ASSERT_TRUE(viewer && operator_tab);
  auto unknown_field = start_command();
  unknown_field.GetReflection()->MutableUnknownFields(&unknown_field)->AddVarint(1000, v1::ROLE_ENGINEER);

  const auto refused = response_to(*viewer, start_command());
  const auto refused_again = response_to(*viewer, unknown_field);
  const bool was_idle = daemon_.ctl({"session", "list", "--json"}).out.find("\"running\"") == std::string::npos;
  const auto accepted = response_to(*operator_tab, start_command());

  ASSERT_TRUE(refused && refused_again && accepted);
  EXPECT_EQ(refused->error().code(), v1::ERROR_CODE_NOT_ALLOWED);
  EXPECT_EQ(refused_again->error().code(), v1::ERROR_CODE_NOT_ALLOWED);
  EXPECT_TRUE(was_idle);
  EXPECT_FALSE(accepted->has_error()) << accepted->error().what();
}

TEST_F(GatewayRoles, ARepeatIsExecutedOnce_AndTheTrailSaysForWhom) {
  auto options = with_users();
  options.insert(options.end(), {"--local-role", "operator"});
  const GatewayProcess gateway(daemon_, options);
  ASSERT_NE(gateway.port(), 0) << gateway.log();
  auto tab = open_websocket(gateway.port());
  auto reopened = open_websocket(gateway.port());
  auto ottos = open_websocket(gateway.port(), log_in(gateway.port(), "otto", kPassword));
  ASSERT_TRUE(tab && reopened && ottos);
  v1::Request claims_to_be_viola = start_command();
  claims_to_be_viola.set_on_behalf_of("viola");

  const auto first = response_to(*tab, start_command());
  const auto repeat = response_to(*reopened, claims_to_be_viola);
  const auto of_otto = response_to(*ottos, start_command());
  auto control = daemon_.control();
  const auto audit = control.audit();

  ASSERT_TRUE(first && repeat && of_otto && audit);
  EXPECT_FALSE(first->has_error()) << first->error().what();
  EXPECT_EQ(repeat->SerializeAsString(), first->SerializeAsString());
  EXPECT_EQ(of_otto->error().code(), v1::ERROR_CODE_WRONG_STATE) << "a command of somebody else, whatever its id";
  std::vector<std::string> trail;
  for (const v1::AuditEntry& entry : audit->entries()) {
    if (entry.what() == "start_session") trail.push_back(entry.who() + " " + entry.result());
  }
  EXPECT_EQ(trail, (std::vector<std::string>{"local ok", "local:otto wrong_state"}));
}

TEST_F(GatewayRoles, LoginsAndRefusedOnes_AreInTheAuditTrailWithTheirAddress) {
  const GatewayProcess gateway(daemon_, with_users());
  ASSERT_NE(gateway.port(), 0) << gateway.log();
  ASSERT_FALSE(log_in(gateway.port(), "otto", kPassword).empty());
  ASSERT_TRUE(log_in(gateway.port(), "viola", "a guess").empty());

  std::vector<std::string> entries;
  EXPECT_TRUE(eventually([&] {
    entries.clear();
    const auto audit = daemon_.control().audit(10);
    for (const v1::AuditEntry& entry : audit->entries()) {
      if (entry.what() == "login") entries.push_back(entry.who() + " " + entry.what() + " " + entry.target() + " " + entry.result());
    }
    return entries.size() >= 2;
  }));
  EXPECT_THAT(entries,
              testing::UnorderedElementsAre("local:otto login otto from 127.0.0.1 ok", "local login viola from 127.0.0.1 refused"));
  EXPECT_THAT(gateway.log(), testing::HasSubstr("login: otto (operator) from 127.0.0.1"));
  RawClient monitor(gateway.port());
  monitor.send(request(gateway.port(), "GET /metrics"));
  EXPECT_THAT(monitor.read_answer(), testing::HasSubstr("\ndts_gateway_refused_logins_total 1\n"));
}

}  // namespace
}  // namespace dts::test
