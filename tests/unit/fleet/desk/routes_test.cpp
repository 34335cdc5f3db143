// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/routes.h"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace dts::fleet::desk {
namespace {

using gateway::HttpRequest;
using gateway::HttpResponse;

/// Routes whose PostgreSQL does not exist.
class RoutesTest : public ::testing::Test {
 protected:
  RoutesTest() { open(v1::ROLE_VIEWER); }
  void open(v1::Role local_role) {
    access_ = *gateway::AccessControl::open(io_, {.local_role = local_role, .is_fleet = true});
    routes_.emplace(*access_, files_, queries_, "1.2.0");
  }
  HttpResponse get(const std::string& path, const gateway::Query& query = {}, const std::string& method = "GET") {
    std::optional<HttpResponse> answer;
    routes_->handle({.method = method, .path = path, .query = query, .remote_address = "127.0.0.1"},
                    [&](HttpResponse response) { answer = std::move(response); });
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!answer && std::chrono::steady_clock::now() < deadline) {
      io_.restart();
      io_.run_for(std::chrono::milliseconds(5));
    }
    EXPECT_TRUE(answer.has_value()) << path;
    return answer.value_or(HttpResponse{});
  }
  static nlohmann::json json_of(const HttpResponse& answer) { return nlohmann::json::parse(std::get<std::string>(answer.body)); }

  boost::asio::io_context io_;
  gateway::StaticFiles files_;
  QueryPool queries_{io_, "host=/nowhere dbname=none", core::Log()};
  std::unique_ptr<gateway::AccessControl> access_{};
  std::optional<Routes> routes_{};
};

TEST_F(RoutesTest, Me_SaysThatThisIsAFleet) { EXPECT_EQ(json_of(get("/api/me"))["fleet"], true); }

TEST_F(RoutesTest, WithoutRole_NoPage) {
  open(v1::ROLE_UNSPECIFIED);

  EXPECT_EQ(get("/api/fleet/clinics").status, 401U);
  EXPECT_EQ(get("/api/me").status, 200U);
}

TEST_F(RoutesTest, OtherMethodsAndPaths_AreRejected) {
  EXPECT_EQ(get("/api/fleet/clinics", {}, "POST").status, 405U);
  for (const char* path : {"/api/fleet", "/api/fleet/", "/api/fleet/clinics/", "/api/fleet/clinics/Kent", "/api/fleet/clinics/a/b",
                           "/api/sessions/x/report"}) {
    EXPECT_EQ(get(path).status, 404U) << path;
  }
}

TEST_F(RoutesTest, DatabaseThatDoesNotAnswer_IsNamedWithWhatToDo) {
  for (const char* path : {"/api/fleet/clinics", "/api/fleet/clinics/kent", "/api/fleet/sessions", "/api/fleet/measures"}) {
    const HttpResponse answer = get(path);
    EXPECT_EQ(answer.status, 503U) << path;
    EXPECT_EQ(json_of(answer)["what"], "the database of the centre does not answer");
    EXPECT_EQ(json_of(answer)["hint"], "check PostgreSQL on the computer of the centre");
  }
}

TEST_F(RoutesTest, CountThatFailed_IsNotRepeatedAtOnce) {
  EXPECT_EQ(get("/api/fleet/measures").status, 503U);
  std::optional<HttpResponse> answer;
  routes_->handle({.method = "GET", .path = "/api/fleet/measures", .query = {}, .remote_address = "127.0.0.1"},
                  [&](HttpResponse response) { answer = std::move(response); });
  ASSERT_TRUE(answer);  // without waiting for PostgreSQL
  EXPECT_EQ(answer->status, 503U);
}

TEST_F(RoutesTest, WrongQueries_AreRejectedBeforePostgreSqlSeesThem) {
  const std::vector<std::pair<std::string, gateway::Query>> wrong{{"sessions", {{"clinic", "Kent"}}},
                                                                  {"sessions", {{"limit", "0"}}},
                                                                  {"sessions", {{"limit", "201"}}},
                                                                  {"sessions", {{"limit", "ten"}}},
                                                                  {"sessions", {{"since", "-1"}}},
                                                                  {"sessions", {{"since", "9223372036854775807"}}},
                                                                  {"sessions", {{"before", "yesterday"}}},
                                                                  {"sessions", {{"subject", std::string(201, 'x')}}},
                                                                  {"trend", {}},
                                                                  {"trend", {{"measure", "MVELO"}, {"clinic", "a b"}}}};
  for (const auto& [page, query] : wrong) EXPECT_EQ(get("/api/fleet/" + page, query).status, 400U) << page;
}

TEST(SessionFilterTest, ReadsAllParameters) {
  const auto filter = session_filter({{"clinic", "kent"},
                                      {"rig", "floor"},
                                      {"protocol", "romberg"},
                                      {"subject", "P 1"},
                                      {"since", "1700000000000"},
                                      {"before", "1700000000000000,kent,A"},
                                      {"limit", "20"}});

  ASSERT_TRUE(filter);
  EXPECT_EQ(filter->clinic, "kent");
  EXPECT_EQ(filter->rig, "floor");
  EXPECT_EQ(filter->protocol, "romberg");
  EXPECT_EQ(filter->subject, "P 1");
  EXPECT_EQ(filter->since_ms, 1700000000000);
  EXPECT_EQ(filter->before, (SessionKey{1700000000000000, "kent", "A"}));
  EXPECT_EQ(filter->limit, 20);
}

}  // namespace
}  // namespace dts::fleet::desk
