// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/serve.h"

#include <systemd/sd-daemon.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <csignal>
#include <functional>
#include <memory>
#include <utility>

#include "cli/exit_status.h"
#include "cli/try.h"
#include "core/log.h"
#include "files/whole_file.h"
#include "fleet/desk/live.h"
#include "fleet/desk/query_pool.h"
#include "fleet/desk/routes.h"
#include "fleet/wire/nkey.h"
#include "fleet/wire/subjects.h"
#include "gateway/http/server.h"

namespace dts::fleet::desk {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::milliseconds kLongestGoodbye{500};
constexpr std::chrono::seconds kReportPause{1};
constexpr std::size_t kMostCaBytes = 1024 * 1024;

/// All parts of the program, in the order of their dependencies.
class Centre {
 public:
  Centre(const Options& options, std::function<void(const std::string&)> log)
      : log_(std::move(log)), queries_(io_, options.database, core::Log::to_stderr(core::LogLevel::Info)) {}
  ~Centre() = default;
  Centre(const Centre&) = delete;
  Centre& operator=(const Centre&) = delete;
  Centre(Centre&&) = delete;
  Centre& operator=(Centre&&) = delete;

  /// First `open_live`, then `open`.
  core::Status open_live(const Options& options);
  client::Result<void> open(const gateway::Options& options);
  void run();
  [[nodiscard]] std::uint16_t port() const noexcept { return server_->port(); }

 private:
  [[nodiscard]] gateway::ServerHooks hooks();
  [[nodiscard]] std::optional<gateway::Identity> admit(const gateway::HttpRequest& request);
  void report_logins();
  void end();

  std::function<void(const std::string&)> log_;
  asio::io_context io_{1};
  asio::signal_set signals_{io_, SIGINT, SIGTERM};
  asio::steady_timer reports_{io_};
  asio::steady_timer patience_{io_};
  QueryPool queries_;
  gateway::StaticFiles files_;
  std::unique_ptr<gateway::AccessControl> access_;
  std::unique_ptr<Routes> routes_;
  std::unique_ptr<link::Link> link_;
  std::unique_ptr<Live> live_;
  std::unique_ptr<gateway::Server> server_;  ///< Last: its closing tabs leave their views.
};

core::Result<std::string> read_ca(const std::string& file) {
  if (file.empty()) return std::string();
  auto text = files::read_whole_file(file, kMostCaBytes);
  if (text) return text;
  return core::fail(core::ErrorCode::InvalidArgument, "cannot read '" + file + "': " + text.error().what,
                    "name the certificates of the authority in nats-ca");
}

core::Status Centre::open_live(const Options& options) {
  auto key = wire::read_nkey(options.nats_key_file);
  if (!key && key.error().code == core::ErrorCode::NotFound) key.error().hint = "dts-fleet-gateway key --nats-key " + options.nats_key_file;
  if (!key) return tl::make_unexpected(key.error());
  DTS_TRY_ASSIGN(const std::string ca_pem, read_ca(options.nats_ca_file));
  DTS_TRY_ASSIGN(link_, link::Link::open({.servers = options.nats_servers,
                                          .ca_pem = ca_pem,
                                          .name = "dts-fleet-gateway",
                                          .seed = key->seed,
                                          .inbox_prefix = wire::dashboard_inbox_prefix(key->public_key),
                                          .rejection = "add it below [[dashboard]] in hub.toml, then restart dts-hub"},
                                         core::Log::to_stderr(core::LogLevel::Info)));
  live_ = std::make_unique<Live>(io_, *link_, queries_, DTS_VERSION);
  return {};
}

client::Result<void> Centre::open(const gateway::Options& options) {
  DTS_TRY_ASSIGN(const auto wanted, server_options(options));
  DTS_TRY_ASSIGN(const auto root, web_root(options));
  DTS_TRY_ASSIGN(files_, gateway::StaticFiles::load(root));
  DTS_TRY_ASSIGN(auto access_wanted, access_options(options));
  access_wanted.log = log_;
  access_wanted.is_fleet = true;
  DTS_TRY_ASSIGN(access_, gateway::AccessControl::open(io_, access_wanted));
  routes_ = std::make_unique<Routes>(*access_, files_, queries_, DTS_VERSION);
  DTS_TRY_ASSIGN(server_, gateway::Server::open(io_, wanted, hooks()));
  return {};
}

std::optional<gateway::Identity> Centre::admit(const gateway::HttpRequest& request) {
  auto identity = access_->identify(request);
  if (!identity) return identity;
  identity->holds = [this, request, user = identity->user, role = identity->role] {
    const auto now = access_->identify(request);
    return now && now->user == user && now->role == role;
  };
  return identity;
}

gateway::ServerHooks Centre::hooks() {
  return {
      .handle = [this](gateway::HttpRequest request, gateway::Respond respond) { routes_->handle(std::move(request), std::move(respond)); },
      .admit = [this](const gateway::HttpRequest& request) { return admit(request); },
      .open_tab =
          [this](const gateway::Identity& identity, const gateway::Query& query, gateway::TabConnection& connection) {
            const auto clinic = query.find("clinic");
            return live_->open_tab(identity, clinic == query.end() ? std::string() : clinic->second, connection);
          }};
}

void Centre::report_logins() {
  access_->report_rest(false);
  reports_.expires_after(kReportPause);
  reports_.async_wait([this](const boost::system::error_code& error) {
    if (!error) report_logins();
  });
}

void Centre::run() {
  signals_.async_wait([this](const boost::system::error_code& error, int /*signal*/) {
    if (!error) end();
  });
  report_logins();
  io_.run();
  access_->report_rest(true);
}

/// Browsers have half a second to close their connections.
void Centre::end() {
  sd_notify(0, "STOPPING=1");
  server_->stop();
  patience_.expires_after(kLongestGoodbye);
  patience_.async_wait([this](const boost::system::error_code& /*error*/) { io_.stop(); });
}

}  // namespace

int serve(const Options& options, cli::Console& console) {
  const gateway::Options& wanted = options.server;
  Centre centre(options, [&console](const std::string& line) { console.talk << line << std::endl; });
  if (auto opened = centre.open_live(options); !opened) return cli::fail_with(console, opened.error());
  if (auto opened = centre.open(wanted); !opened) return cli::fail_with(console, opened.error());
  const std::string scheme = wanted.certificate_file.empty() ? "http" : "https";
  const std::string address = wanted.listen.substr(0, wanted.listen.rfind(':'));
  console.talk << "listening on " << scheme << "://" << address << ":" << centre.port() << "/" << std::endl;
  sd_notify(0, "READY=1");
  centre.run();
  return cli::kOk;
}

}  // namespace dts::fleet::desk
