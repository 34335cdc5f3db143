// SPDX-License-Identifier: Apache-2.0
#include "gateway/routes.h"

#include <fstream>
#include <optional>

#include "gateway/options.h"
#include "unit/gateway/access/access_fixture.h"

namespace dts::gateway {
namespace {

class RoutesTest : public AccessControlTest {
 protected:
  RoutesTest() {
    std::filesystem::create_directory(directory_.path() / "web");
    std::ofstream(directory_.path() / "web/index.html") << "the dashboard";
    files_ = StaticFiles::load((directory_.path() / "web").string()).value();
    archive_ = Archive::open(io_, {.cache_directory = directory_.path() / "cache"}, [](const std::string&, const auto& found) {
                 found(client::fail(client::ErrorCode::NotFound, "no such session"));
               }).value();
    subjects_ = std::make_unique<Subjects>(io_, [](const v1::Request& /*request*/, const auto& answered) {
      answered(client::fail(client::ErrorCode::NotFound, "no session has this subject ID"));
    });
  }
  HttpResponse answer(const HttpRequest& asked, bool has_metrics = true) {
    const Routes routes(*access_, *archive_, *subjects_, *files_,
                        has_metrics ? [] { return std::string("dts_up 1"); } : std::function<std::string()>());
    routes.handle(asked, keep());
    return wait_for(1).front();
  }

  std::optional<StaticFiles> files_;
  std::unique_ptr<Archive> archive_;
  std::unique_ptr<Subjects> subjects_;
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
    EXPECT_EQ(status("GET", "/api/subjects/P017", is_anna), is_anna ? 404U : 401U);
    EXPECT_EQ(status("GET", "/metrics", is_anna), is_anna ? 200U : 401U);
  }
  EXPECT_EQ(header_of(answer(request("POST", "/")), "Allow"), "GET, HEAD");
  for (const auto& [asked, what, hint] :
       {std::tuple(request("POST", "/api/me"), "this path accepts only GET and HEAD", ""),
        {request("GET", "/api/nothing"), "nothing at this path", ""},
        {request("GET", "/api/sessions/s1/report"), "not logged in", "log in first"},
        {request("GET", "/metrics"), "not logged in", "log in, or read the metrics from the gateway's own machine"}}) {
    EXPECT_EQ(json_of(answer(asked)), (nlohmann::json{{"what", what}, {"hint", hint}}));
  }
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
            (client::Error{client::ErrorCode::InvalidArgument, "unknown role 'admin'", "viewer, operator, engineer or none"}));
  EXPECT_EQ(access_options({.local_role = "none"}).error(),
            (client::Error{client::ErrorCode::InvalidArgument, "no user could log in: no users file and no local role",
                           "give --users or --local-role"}));
  EXPECT_EQ(access_options({.users_file = "users"})->users_file, "users");
}

TEST(Options, Listen_IsLoopbackOrHasTlsAndUsers) {
  for (const char* wrong : {"nowhere", "127.0.0.1", "::1:80", "[127.0.0.1]:80", "127.0.0.1:65536", "127.0.0.1:80x", "[]:80", ":80"}) {
    EXPECT_EQ(server_options({.listen = wrong}).error(),
              (client::Error{client::ErrorCode::InvalidArgument, std::string("cannot listen on '") + wrong + "'",
                             "write 127.0.0.1:8080 or [::1]:8080"}));
  }
  EXPECT_EQ(server_options({.listen = "[::1]:65535"})->address, "::1");
  EXPECT_EQ(server_options({.listen = "[::1]:65535"})->port, 65535U);
  for (const Options& half :
       {Options{.listen = "127.0.0.1:0", .key_file = "k"}, Options{.listen = "127.0.0.1:0", .certificate_file = "c"}}) {
    EXPECT_EQ(server_options(half).error(), (client::Error{client::ErrorCode::InvalidArgument, "TLS requires a certificate and its key",
                                                           "give --tls-certificate and --tls-key"}));
  }
  for (const Options& open :
       {Options{.listen = "0.0.0.0:80", .certificate_file = "c", .key_file = "k"}, Options{.listen = "0.0.0.0:80", .users_file = "u"}}) {
    EXPECT_EQ(server_options(open).error(), (client::Error{client::ErrorCode::InvalidArgument,
                                                           "'0.0.0.0:80' can be reached from other machines: this requires TLS and users",
                                                           "give --tls-certificate, --tls-key and --users, or listen on 127.0.0.1"}));
  }
  const auto complete =
      server_options({.listen = "0.0.0.0:80", .certificate_file = "c", .key_file = "k", .host_names = {"ward"}, .users_file = "u"});
  ASSERT_TRUE(complete);
  EXPECT_EQ(std::tie(complete->address, complete->certificate_file, complete->key_file, complete->host_names),
            std::tuple("0.0.0.0", "c", "k", std::vector<std::string>{"ward"}));
}

TEST(Options, WebRoot_IsAFolderWithAnIndex) {
  const testing::TemporaryDirectory directory;
  const std::string root = directory.path().string();
  EXPECT_EQ(web_root({.web_root = root}).error(),
            (client::Error{client::ErrorCode::InvalidArgument, "the dashboard's files are not in " + root,
                           "build the target 'dashboard' (needs node), or give --web-root"}));
  std::ofstream(directory.path() / "index.html") << "the dashboard";
  EXPECT_EQ(web_root({.web_root = root}), root);
}

}  // namespace
}  // namespace dts::gateway
