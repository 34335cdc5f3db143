// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "gateway/access/access_control.h"
#include "gateway/access/password.h"
#include "gateway/access/user_file.h"
#include "unit/gateway/answered_test.h"
#include "unit/gateway/read_response.h"

namespace dts::gateway {

class AccessControlTest : public AnsweredTest {
 protected:
  static constexpr const char* kPassword = "correct horse battery";
  /// Looks like one; `is_password` of the options knows better than to spend a tenth of a second on it.
  static constexpr const char* kHash = "$argon2id$v=19$m=65536,t=2,p=1$c29tZXNhbHRzb21lc2FsdA$RdescudvJCsgt3ub+b+ded4qt7Rr5Vw4kbj4UO/vbBE";

  AccessControlTest() {
    EXPECT_TRUE(add_user(options_.users_file, {"anna", v1::ROLE_OPERATOR, kHash}).has_value());
    open();
  }
  void open() {
    access_.reset();
    auto opened = AccessControl::open(io_, options_);
    ASSERT_TRUE(opened.has_value()) << opened.error().what;
    access_ = std::move(*opened);
  }
  static HttpRequest request(const std::string& method, const std::string& path, const std::string& body = "") {
    return {.method = method,
            .path = path,
            .headers = {{"content-type", "application/json"}},
            .body = body,
            .remote_address = "192.0.2.7",
            .is_same_origin = true};
  }
  static HttpRequest login(const std::string& user, const std::string& password, const std::string& from = "192.0.2.7") {
    HttpRequest asked = request("POST", "/api/login", nlohmann::json{{"user", user}, {"password", password}}.dump());
    asked.remote_address = from;
    return asked;
  }
  static HttpRequest with_cookie(const HttpResponse& answer) {
    const std::string cookie = header_of(answer, "Set-Cookie");
    HttpRequest asked = request("GET", "/api/me");
    asked.headers["cookie"] = "theme=dark; " + cookie.substr(0, cookie.find(';'));
    return asked;
  }
  void begin(HttpRequest asked) { access_->log_in(std::move(asked), keep()); }
  HttpResponse log_in(HttpRequest asked) {
    begin(std::move(asked));
    return wait_for(1).front();
  }
  HttpResponse describe_user(const HttpRequest& asked) {
    HttpResponse told;
    access_->describe_user(asked, [&told](HttpResponse answer) { told = std::move(answer); });
    return told;
  }
  [[nodiscard]] bool is_known(const HttpRequest& asked) const { return access_->identify(asked).has_value(); }

  testing::TemporaryDirectory directory_;
  std::chrono::steady_clock::time_point now_{std::chrono::hours{1000}};
  std::vector<std::string> log_;
  std::vector<LoginNote> notes_;
  AccessOptions options_{
      .users_file = (directory_.path() / "users").string(),
      .now = [this] { return now_; },
      .is_password = [](const std::string& hash, const Secret& password) { return hash == kHash && password.text() == kPassword; },
      .log = [this](const std::string& line) { log_.push_back(line); },
      .note = [this](const LoginNote& note) { notes_.push_back(note); }};
  std::unique_ptr<AccessControl> access_;
};

}  // namespace dts::gateway
