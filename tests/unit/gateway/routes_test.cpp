// SPDX-License-Identifier: Apache-2.0
#include "gateway/routes.h"

#include <gmock/gmock.h>

#include <fstream>
#include <optional>

#include "gateway/options.h"
#include "unit/gateway/access/access_fixture.h"

namespace dts::gateway {
namespace {

using ::testing::HasSubstr;

class RoutesTest : public AccessControlTest {
 protected:
  RoutesTest() {
    std::filesystem::create_directory(directory_.path() / "web");
    std::ofstream(directory_.path() / "web/index.html") << "the dashboard";
    files_ = StaticFiles::load((directory_.path() / "web").string()).value();
    archive_ = Archive::open(io_, {.cache_directory = directory_.path() / "cache"}, [](const std::string&, const auto& found) {
                 found(client::fail(client::ErrorCode::NotFound, "no such session"));
               }).value();
  }
  HttpResponse answer(const HttpRequest& asked, bool has_metrics = true) {
    const Routes routes(*access_, *archive_, *files_,
                        has_metrics ? [] { return std::string("dts_up 1"); } : std::function<std::string()>());
    routes.handle(asked, keep());
    return wait_for(1).front();
  }

  std::optional<StaticFiles> files_;
  std::unique_ptr<Archive> archive_;
};

TEST_F(RoutesTest, EveryPath_IsForItsPartAndForWhoMay) {
  const HttpRequest anna = with_cookie(answer(login("anna", kPassword)));
  const auto status = [&](const std::string& method, const std::string& path, bool is_anna) {
    HttpRequest asked = request(method, path);
    if (is_anna) asked.headers = anna.headers;
    return answer(asked).status;
  };
  for (const bool is_anna : {false, true}) {
    EXPECT_EQ(status("GET", "/", is_anna), 200U);
    EXPECT_EQ(status("HEAD", "/api/me", is_anna), 200U);
    EXPECT_EQ(status("GET", "/api/login", is_anna), 404U);
    EXPECT_EQ(status("GET", "/api/logout", is_anna), 404U);
    EXPECT_EQ(status("POST", "/api/me", is_anna), 405U);
    EXPECT_EQ(status("DELETE", "/api/sessions/s1/report", is_anna), 405U);
    EXPECT_EQ(status("GET", "/api/sessions/s1/report/", is_anna), is_anna ? 404U : 401U);
    EXPECT_EQ(status("GET", "/metrics", is_anna), is_anna ? 200U : 401U);
  }
  EXPECT_EQ(header_of(answer(request("POST", "/")), "Allow"), "GET, HEAD");
  EXPECT_EQ(text_of(answer(request("GET", "/"))), "the dashboard");
  HttpRequest out = anna;
  out.method = "POST";
  out.path = "/api/logout";
  EXPECT_EQ(answer(out).status, 200U);
  EXPECT_FALSE(is_known(anna));
}

TEST_F(RoutesTest, Metrics_AreForAMonitorOfThisMachineUnlessThereAreNone) {
  HttpRequest monitor = request("GET", "/metrics");
  monitor.remote_address = "127.0.0.1";

  EXPECT_EQ(text_of(answer(monitor)), "dts_up 1");
  EXPECT_EQ(header_of(answer(monitor), "Cache-Control"), "no-store");
  EXPECT_EQ(answer(monitor, false).status, 404U);
}

TEST(Options, Roles_AreThoseThatExistAndSomebodyCanUseTheGateway) {
  EXPECT_EQ(access_options({})->local_role, v1::ROLE_OPERATOR);
  EXPECT_EQ(access_options({.users_file = "users"})->local_role, v1::ROLE_UNSPECIFIED);
  EXPECT_EQ(access_options({.local_role = "viewer"})->local_role, v1::ROLE_VIEWER);
  EXPECT_EQ(access_options({.local_role = "admin"}).error(),
            (client::Error{client::ErrorCode::InvalidArgument, "there is no role 'admin'", "viewer, operator, engineer or none"}));
  EXPECT_THAT(access_options({.local_role = "none"}).error().what, HasSubstr("nobody could use this"));
}

TEST(Options, Listen_IsLoopbackOrHasTlsAndUsers) {
  for (const char* wrong : {"nowhere", "127.0.0.1", "::1:80", "[127.0.0.1]:80", "127.0.0.1:65536", "127.0.0.1:80x", "[]:80", ":80"}) {
    EXPECT_EQ(server_options({.listen = wrong}).error(),
              (client::Error{client::ErrorCode::InvalidArgument, std::string("cannot listen on '") + wrong + "'",
                             "write 127.0.0.1:8080 or [::1]:8080"}));
  }
  EXPECT_EQ(server_options({.listen = "[::1]:65535"})->address, "::1");
  EXPECT_EQ(server_options({.listen = "[::1]:65535"})->port, 65535U);
  EXPECT_THAT(server_options({.listen = "127.0.0.1:0", .key_file = "k"}).error().what, HasSubstr("TLS needs a certificate and its key"));
  EXPECT_FALSE(server_options({.listen = "0.0.0.0:80", .certificate_file = "c", .key_file = "k"}));
  EXPECT_FALSE(server_options({.listen = "0.0.0.0:80", .users_file = "u"}));
  EXPECT_TRUE(server_options({.listen = "0.0.0.0:80", .certificate_file = "c", .key_file = "k", .users_file = "u"}));
}

}  // namespace
}  // namespace dts::gateway
