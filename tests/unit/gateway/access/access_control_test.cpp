// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/access_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <vector>

#include "gateway/access/password.h"
#include "gateway/access/user_file.h"
#include "gateway/access/visitor.h"
#include "unit/gateway/access/access_fixture.h"

namespace dts::gateway {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST_F(AccessControlTest, RightPassword_GivesACookieThatTellsWhoSomebodyIs) {
  const HttpResponse answer = log_in(login("anna", kPassword));

  EXPECT_EQ(answer.status, 200U);
  EXPECT_EQ(json_of(answer), (nlohmann::json{{"user", "anna"}, {"role", "operator"}, {"can_log_in", true}, {"fleet", false}}));
  const std::string cookie = header_of(answer, "Set-Cookie");
  EXPECT_THAT(cookie, StartsWith("dts_token="));
  for (const char* attribute : {"; HttpOnly", "; SameSite=Strict", "; Path=/", "; Max-Age=43200"})
    EXPECT_THAT(cookie, HasSubstr(attribute));
  EXPECT_THAT(cookie, Not(HasSubstr("Secure")));
  EXPECT_EQ(header_of(answer, "Cache-Control"), "no-store");
  const auto identity = access_->identify(with_cookie(answer));
  ASSERT_TRUE(identity.has_value());
  EXPECT_EQ(identity->user, "anna");
  EXPECT_EQ(identity->role, v1::ROLE_OPERATOR);
  EXPECT_EQ(json_of(describe_user(with_cookie(answer)))["role"], "operator");
  HttpRequest over_tls = login("anna", kPassword);
  over_tls.is_secure = true;
  EXPECT_THAT(header_of(log_in(std::move(over_tls)), "Set-Cookie"), HasSubstr("; Secure"));
}

TEST_F(AccessControlTest, WrongNameAndWrongPassword_LookTheSame) {
  const HttpResponse wrong_password = log_in(login("anna", "incorrect horse"));
  const HttpResponse wrong_name = log_in(login("nobody", kPassword));

  EXPECT_EQ(wrong_password.status, 401U);
  EXPECT_EQ(header_of(wrong_password, "Set-Cookie"), "");
  EXPECT_EQ(wrong_name.status, wrong_password.status);
  EXPECT_EQ(wrong_name.headers, wrong_password.headers);
  EXPECT_EQ(std::get<std::string>(wrong_name.body), std::get<std::string>(wrong_password.body));
}

TEST_F(AccessControlTest, WrongName_TakesAsLongAsAWrongPassword) {
  const std::string real_hash = hash_password(Secret(kPassword)).value();
  const auto cpu_s = [] {  // of this thread: what it waits for a core does not count
    timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  };
  const auto time = [&cpu_s](const std::string& hash) {
    const double begin_s = cpu_s();
    EXPECT_FALSE(is_password(hash, Secret("incorrect horse")));
    return cpu_s() - begin_s;
  };
  double of_password_s = time(real_hash);
  double of_name_s = time("");
  for (int round = 0; round < 1; ++round) {  // the least of some: a busy machine only ever adds
    of_password_s = std::min(of_password_s, time(real_hash));
    of_name_s = std::min(of_name_s, time(""));
  }

  EXPECT_GT(of_name_s, of_password_s / 4.0);
  EXPECT_LT(of_name_s, of_password_s * 4.0);

  options_.is_password = AccessOptions().is_password;
  open();
  ASSERT_TRUE(add_user(options_.users_file, {"real", v1::ROLE_VIEWER, real_hash}).has_value());
  EXPECT_EQ(log_in(login("real", kPassword)).status, 200U);
  EXPECT_EQ(log_in(login("anna", kPassword)).status, 401U) << "of another hash";
}

TEST_F(AccessControlTest, WhatIsNoLogin_IsRefused) {
  for (const char* body :
       {"", "{}", "[]", "{\"user\":\"anna\"}", "{\"user\":\"anna\",\"password\":1}", "{\"user\":\"anna\",\"password\":\"x\"",
        "{\"user\":\"anna\",\"password\":\"correct horse battery\",\"role\":\"engineer\"}"}) {
    EXPECT_EQ(log_in(request("POST", "/api/login", body)).status, 400U) << body;
  }
}

TEST_F(AccessControlTest, FromAnotherPage_IsRefused) {
  HttpRequest foreign = login("anna", kPassword);
  foreign.is_same_origin = false;
  HttpRequest form = login("anna", kPassword);
  form.headers["content-type"] = "application/x-www-form-urlencoded";
  HttpRequest with_charset = login("anna", kPassword);
  with_charset.headers["content-type"] = "application/json; charset=utf-8";

  EXPECT_EQ(log_in(std::move(foreign)).status, 403U);
  EXPECT_EQ(log_in(std::move(form)).status, 415U);
  EXPECT_EQ(log_in(std::move(with_charset)).status, 200U);
}

TEST_F(AccessControlTest, FifthFailure_MakesTheNameWaitAtThatAddressOnly) {
  RecordProperty("requirement", "SEC-5");
  for (int count = 0; count < 5; ++count) begin(login("anna", "incorrect horse"));
  for (const HttpResponse& answer : wait_for(5)) EXPECT_EQ(answer.status, 401U);

  const HttpResponse early = log_in(login("anna", kPassword));
  EXPECT_EQ(early.status, 429U);
  EXPECT_EQ(header_of(early, "Retry-After"), "1");
  EXPECT_EQ(log_in(login("anna", kPassword, "198.51.100.1")).status, 200U) << "she sits elsewhere";
  EXPECT_EQ(log_in(login("bert", "incorrect horse")).status, 401U) << "a colleague behind the same router need not wait";
  now_ += seconds{1};
  EXPECT_EQ(log_in(login("anna", kPassword)).status, 200U);
}

TEST_F(AccessControlTest, TwentiethFailure_MakesTheNameWaitFromAnywhereAndTheAddressWhateverTheName) {
  for (int count = 0; count < 20; ++count) {
    EXPECT_EQ(log_in(login("anna", "incorrect horse", "192.0.2." + std::to_string(100 + count))).status, 401U) << count;
    EXPECT_EQ(log_in(login("nobody" + std::to_string(count), "incorrect horse")).status, 401U) << count;
  }

  EXPECT_EQ(log_in(login("anna", kPassword, "198.51.100.1")).status, 429U);
  EXPECT_EQ(log_in(login("nobody", "incorrect horse")).status, 429U);
  EXPECT_EQ(log_in(login("nobody", "incorrect horse", "198.51.100.1")).status, 401U) << "others need not wait";
  now_ += seconds{1};
  EXPECT_EQ(log_in(login("anna", kPassword, "198.51.100.1")).status, 200U);
}

TEST_F(AccessControlTest, ManyAttemptsAtATime_AreNotAllTheFirst) {
  for (int count = 0; count < 12; ++count) begin(login("anna", "incorrect horse"));

  const auto answers = wait_for(12);
  const auto refused = std::ranges::count(answers, 401U, &HttpResponse::status);
  const auto waiting = std::ranges::count(answers, 429U, &HttpResponse::status);
  EXPECT_EQ(refused, 5);
  EXPECT_EQ(waiting, 7);
}

TEST_F(AccessControlTest, MoreThanSixteenWaiting_AreSentAway) {
  for (int count = 0; count < 18; ++count) begin(login("anna", kPassword, "192.0.2." + std::to_string(count)));

  ASSERT_EQ(answers_.size(), 1U) << "one is compared, sixteen wait, one is told at once";
  EXPECT_EQ(answers_.front().status, 429U);
  EXPECT_NE(header_of(answers_.front(), "Retry-After"), "");
}

TEST_F(AccessControlTest, Logout_ForgetsTheToken) {
  HttpRequest known = with_cookie(log_in(login("anna", kPassword)));
  HttpRequest foreign = known;
  foreign.is_same_origin = false;
  std::vector<HttpResponse> told;
  const auto respond = [&told](HttpResponse answer) { told.push_back(std::move(answer)); };

  access_->log_out(foreign, respond);
  EXPECT_EQ(told.back().status, 403U);
  EXPECT_TRUE(is_known(known));
  access_->log_out(known, respond);

  EXPECT_EQ(told.back().status, 200U);
  EXPECT_EQ(json_of(told.back())["role"], "none");
  EXPECT_THAT(header_of(told.back(), "Set-Cookie"), StartsWith("dts_token=; Path=/; Max-Age=0"));
  EXPECT_FALSE(is_known(known));
}

TEST_F(AccessControlTest, TokenEndsWithTime) {
  const HttpRequest known = with_cookie(log_in(login("anna", kPassword)));

  now_ += hours{2} - seconds{1};
  EXPECT_TRUE(is_known(known));
  now_ += hours{2};
  EXPECT_FALSE(is_known(known));
}

TEST_F(AccessControlTest, UserWhoIsRemovedOrChanged_IsLoggedOutAtOnce) {
  const HttpRequest known = with_cookie(log_in(login("anna", kPassword)));
  ASSERT_TRUE(add_user(options_.users_file, {"bert", v1::ROLE_VIEWER, kHash}).has_value());
  EXPECT_TRUE(is_known(known)) << "others may come and go";
  EXPECT_EQ(log_in(login("bert", kPassword)).status, 200U);

  ASSERT_TRUE(remove_user(options_.users_file, "anna").has_value());

  EXPECT_FALSE(is_known(known));
  EXPECT_EQ(log_in(login("anna", kPassword)).status, 401U);
  ASSERT_TRUE(add_user(options_.users_file, {"anna", v1::ROLE_VIEWER, kHash}).has_value());
  EXPECT_FALSE(is_known(known)) << "with another role";
  EXPECT_EQ(json_of(log_in(login("anna", kPassword)))["role"], "viewer");
}

TEST_F(AccessControlTest, UserWhoIsRemovedWhileTheirPasswordIsCompared_IsNotLetIn) {
  begin(login("anna", kPassword));
  ASSERT_TRUE(remove_user(options_.users_file, "anna").has_value());

  EXPECT_EQ(wait_for(1).front().status, 401U);
}

TEST_F(AccessControlTest, WhileTheUsersCannotBeRead_NobodyIsLetIn) {
  const HttpRequest known = with_cookie(log_in(login("anna", kPassword)));

  fs::permissions(options_.users_file, fs::perms(0644));
  EXPECT_FALSE(is_known(known));
  EXPECT_EQ(log_in(login("anna", kPassword)).status, 503U);
  fs::permissions(options_.users_file, fs::perms(0640));

  EXPECT_TRUE(is_known(known));
}

TEST_F(AccessControlTest, LocalRole_IsForWhoeverIsAtThisMachineAndCameWithoutAProxy) {
  options_.local_role = v1::ROLE_ENGINEER;
  open();
  HttpRequest asked = request("GET", "/api/me");

  for (const char* address : {"127.0.0.1", "127.8.9.10", "::1"}) {
    asked.remote_address = address;
    ASSERT_TRUE(is_known(asked)) << address;
    EXPECT_EQ(access_->identify(asked)->user, "local");
    EXPECT_EQ(access_->identify(asked)->role, v1::ROLE_ENGINEER);
  }
  for (const char* address : {"", "192.0.2.7", "128.0.0.1", "127.0.0.1.example", "127.1", "::2", "::ffff:192.0.2.7", "localhost"}) {
    asked.remote_address = address;
    EXPECT_FALSE(is_known(asked)) << address;
  }
  for (const char* header : {"x-forwarded-for", "forwarded", "x-real-ip", "via"}) {
    asked = request("GET", "/api/me");
    asked.remote_address = "127.0.0.1";
    asked.headers[header] = "";
    EXPECT_FALSE(is_known(asked)) << header;
  }
}

TEST_F(AccessControlTest, SameMachine_IsAlsoWhoAsksFromTheAddressThatIsAskedAt) {
  HttpRequest asked = request("GET", "/metrics");
  asked.local_address = "192.0.2.1";
  EXPECT_FALSE(is_same_machine(asked));

  asked.remote_address = asked.local_address;
  EXPECT_TRUE(is_same_machine(asked));
  EXPECT_FALSE(is_local(asked));
  asked.headers["via"] = "1.1 proxy";
  EXPECT_FALSE(is_same_machine(asked));

  asked = request("GET", "/metrics");
  asked.remote_address.clear();
  EXPECT_FALSE(is_same_machine(asked)) << "two addresses that are not known are not the same";
}

TEST_F(AccessControlTest, LoginWinsOverTheLocalRole) {
  options_.local_role = v1::ROLE_ENGINEER;
  open();
  HttpRequest known = with_cookie(log_in(login("anna", kPassword)));
  known.remote_address = "127.0.0.1";

  EXPECT_EQ(access_->identify(known)->user, "anna");
  now_ += hours{3};
  EXPECT_EQ(access_->identify(known)->user, "local");
}

TEST_F(AccessControlTest, WithoutAUsersFile_NobodyCanLogIn) {
  options_.users_file.clear();
  open();

  EXPECT_EQ(log_in(login("anna", kPassword)).status, 403U);
  EXPECT_EQ(json_of(describe_user(request("GET", "/api/me"))),
            (nlohmann::json{{"user", ""}, {"role", "none"}, {"can_log_in", false}, {"fleet", false}}));
}

TEST_F(AccessControlTest, UsersFileThatIsNone_IsRefusedWithItsLine) {
  std::ofstream(options_.users_file, std::ios::app) << "bert\n";

  const auto opened = AccessControl::open(io_, options_);

  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, client::ErrorCode::InvalidArgument);
  EXPECT_THAT(opened.error().what, HasSubstr(options_.users_file + ":2:"));
}

TEST_F(AccessControlTest, GoneWhileAPasswordIsCompared_TellsNobody) {
  begin(login("anna", kPassword));

  access_.reset();
  io_.poll();

  EXPECT_TRUE(answers_.empty());
}

TEST(BootTime, GoesOn) {
  const auto first = time_since_boot();
  EXPECT_GT(first.time_since_epoch(), seconds{0});
  EXPECT_GE(time_since_boot(), first);
}

}  // namespace
}  // namespace dts::gateway
