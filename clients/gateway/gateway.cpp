// SPDX-License-Identifier: Apache-2.0
#include "gateway/gateway.h"

#include <systemd/sd-daemon.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <semaphore>
#include <system_error>
#include <utility>

#include "cli/exit_status.h"
#include "cli/try.h"
#include "dts/endpoints.h"
#include "gateway/archive/erasure_watch.h"
#include "gateway/archive/work_folder.h"
#include "gateway/bus/hub.h"
#include "gateway/metrics/metrics.h"
#include "gateway/routes.h"

namespace dts::gateway {
namespace {

namespace asio = boost::asio;

/// Most items on the way from the bus thread to the io thread. If there are more, the bus thread waits; libzmq then drops messages, and
/// every tab sees missing scans.
constexpr std::ptrdiff_t kMostItemsUnderWay = 4096;
constexpr std::chrono::milliseconds kLookForEnd{100};
/// How long browsers may take to answer the close frame when the gateway ends.
constexpr std::chrono::milliseconds kLongestGoodbye{500};
constexpr std::chrono::milliseconds kGoodbyeTurn{10};

/// Returns true if SIGHUP is ignored (nohup): the gateway must then outlive the terminal.
bool is_hangup_ignored() noexcept {
  struct sigaction now {};
  return ::sigaction(SIGHUP, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

client::Result<v1::SessionRecord> session_of(client::Result<v1::Response> answer) {
  if (!answer) return tl::make_unexpected(answer.error());
  return std::move(*answer->mutable_session_record());
}

FindSession find_session_through(CommandPool& commands) {
  return [&commands](const std::string& session_id, std::function<void(client::Result<v1::SessionRecord>)> found) {
    v1::Request request;
    request.mutable_show_session()->set_session_id(session_id);
    commands.submit(std::move(request),
                    [found = std::move(found)](client::Result<v1::Response> answer) { found(session_of(std::move(answer))); });
  };
}

/// All parts of the gateway, in the order of their dependencies.
class Gateway {
 public:
  Gateway(const Options& options, const client::Endpoints& endpoints, std::function<void(const std::string&)> log)
      : options_(options),
        log_(std::move(log)),
        endpoints_(endpoints),
        commands_(io_, endpoints.control),
        hub_(
            io_, &commands_, [this](std::vector<std::string> prefixes) { reader_->want(std::move(prefixes)); }, DTS_VERSION) {
    // The default action of SIGHUP would leave the temporary folder behind.
    if (!is_hangup_ignored()) signals_.add(SIGHUP);
  }
  ~Gateway() { is_ending_.store(true, std::memory_order_relaxed); }
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  client::Result<void> open();
  void run();
  [[nodiscard]] std::uint16_t port() const noexcept { return server_->port(); }

 private:
  client::Result<void> open_parts();
  [[nodiscard]] client::Result<std::filesystem::path> cache_directory();
  client::Result<void> start_reader();
  [[nodiscard]] ServerHooks hooks();
  [[nodiscard]] std::optional<Identity> admit(const HttpRequest& request);
  void enter(const LoginNote& note);
  [[nodiscard]] GatewayCounts counts() const;
  void pass(BusItem item);
  void end();
  void await_goodbyes();

  Options options_;
  std::function<void(const std::string&)> log_;
  client::Endpoints endpoints_;
  asio::io_context io_{1};
  asio::signal_set signals_{io_, SIGINT, SIGTERM};  ///< First, so that a signal during the construction also ends in an orderly way.
  asio::steady_timer patience_{io_};
  std::chrono::steady_clock::time_point leaves_at_{};
  std::optional<WorkFolder> temporary_;
  CommandPool commands_;
  Hub hub_;
  StaticFiles files_;
  std::unique_ptr<AccessControl> access_;
  std::unique_ptr<Archive> archive_;
  std::unique_ptr<Subjects> subjects_;
  ErasureWatch erasures_;
  std::unique_ptr<Routes> routes_;
  std::counting_semaphore<kMostItemsUnderWay> free_places_{kMostItemsUnderWay};
  std::atomic<bool> is_ending_ = false;  ///< Read by the bus thread, which must not wait for an io thread that has ended.
  std::unique_ptr<BusReader> reader_;
  std::unique_ptr<Server> server_;  ///< Last: its closing tabs remove their topics from the reader.
};

/// Thread: bus.
void Gateway::pass(BusItem item) {
  while (!free_places_.try_acquire_for(kLookForEnd)) {
    if (is_ending_.load(std::memory_order_relaxed)) return;
  }
  asio::post(io_, [this, item = std::move(item)] {
    free_places_.release();
    hub_.handle(item);
    if (erasures_.has_erased(hub_.status())) archive_->forget();
    access_->report_rest(false);  // called with the daemon's status every second; without a daemon, the next login or the end calls it
  });
}

std::optional<Identity> Gateway::admit(const HttpRequest& request) {
  auto identity = access_->identify(request);
  if (!identity) return identity;
  identity->holds = [this, request, user = identity->user, role = identity->role] {
    const auto now = access_->identify(request);
    return now && now->user == user && now->role == role;
  };
  return identity;
}

/// Sends the note to the daemon's audit trail. Without a daemon only the log has it.
void Gateway::enter(const LoginNote& note) {
  v1::Request request;
  request.set_on_behalf_of(note.is_refused ? "" : note.user);
  v1::NoteLoginRequest& login = *request.mutable_note_login();
  login.set_user(note.user);
  login.set_address(note.address);
  login.set_is_refused(note.is_refused);
  login.set_more(static_cast<std::uint32_t>(std::min<std::uint64_t>(note.more, std::numeric_limits<std::uint32_t>::max())));
  commands_.submit(std::move(request), [log = log_](const client::Result<v1::Response>& answer) {
    if (!answer) log("a login is not in the audit trail: " + answer.error().what);
  });
}

GatewayCounts Gateway::counts() const {
  return {.version = DTS_VERSION,
          .server = server_->statistics(),
          .dropped = hub_.dropped(),
          .refused_logins_total = access_->refused_logins_total()};
}

ServerHooks Gateway::hooks() {
  return {.handle = [this](HttpRequest request, Respond respond) { routes_->handle(std::move(request), std::move(respond)); },
          .admit = [this](const HttpRequest& request) { return admit(request); },
          .open_tab = [this](const Identity& identity, const Query& /*query*/,
                             TabConnection& connection) { return hub_.open_tab(identity, connection); }};
}

/// Returns the folder for exports: the user's choice, systemd's, or a temporary folder that is removed when the gateway ends.
client::Result<std::filesystem::path> Gateway::cache_directory() {
  if (!options_.cache_directory.empty()) return options_.cache_directory;
  const char* given = std::getenv("CACHE_DIRECTORY");
  if (given != nullptr && *given != '\0') return given;
  std::error_code failed;
  std::string name = (std::filesystem::temp_directory_path(failed) / "dts-gateway-XXXXXX").string();
  // mkdtemp: at a predictable name another user may have put a link or a folder.
  if (!failed && ::mkdtemp(name.data()) == nullptr) failed.assign(errno, std::generic_category());
  if (failed) {
    return client::fail(client::ErrorCode::Failed, "cannot make the temporary folder '" + name + "': " + failed.message(),
                        "set TMPDIR, or give --cache");
  }
  temporary_.emplace(name);
  return temporary_->path();
}

client::Result<void> Gateway::open_parts() {
  DTS_TRY_ASSIGN(auto root, web_root(options_));
  DTS_TRY_ASSIGN(files_, StaticFiles::load(root));
  DTS_TRY_ASSIGN(auto access_wanted, access_options(options_));
  access_wanted.log = log_;
  access_wanted.note = [this](const LoginNote& note) { enter(note); };
  DTS_TRY_ASSIGN(access_, AccessControl::open(io_, access_wanted));
  DTS_TRY_ASSIGN(const auto cache, cache_directory());
  DTS_TRY_ASSIGN(archive_, Archive::open(io_, {.cache_directory = cache}, find_session_through(commands_)));
  std::function<std::string()> metrics;
  if (options_.has_metrics) metrics = [this] { return metrics_text(hub_.status(), counts()); };
  subjects_ = std::make_unique<Subjects>(io_, [this](v1::Request request, std::function<void(client::Result<v1::Response>)> answered) {
    commands_.submit(std::move(request), std::move(answered));
  });
  routes_ = std::make_unique<Routes>(*access_, *archive_, *subjects_, files_, std::move(metrics));
  return {};
}

client::Result<void> Gateway::start_reader() {
  DTS_TRY_ASSIGN(reader_, BusReader::start(endpoints_.data, [this](BusItem item) { pass(std::move(item)); }));
  return {};
}

client::Result<void> Gateway::open() {
  DTS_TRY_ASSIGN(const auto wanted, server_options(options_));
  DTS_TRY(open_parts());
  DTS_TRY_ASSIGN(server_, Server::open(io_, wanted, hooks()));
  return start_reader();
}

void Gateway::run() {
  signals_.async_wait([this](const boost::system::error_code& error, int /*signal*/) {
    if (!error) end();
  });
  io_.run();
  access_->report_rest(true);
}

/// Ends the connections in an orderly way. Answers to commands in progress are dropped.
void Gateway::end() {
  sd_notify(0, "STOPPING=1");
  access_->report_rest(true);  // while commands can still be sent
  server_->stop();
  leaves_at_ = std::chrono::steady_clock::now() + kLongestGoodbye;
  await_goodbyes();
}

void Gateway::await_goodbyes() {
  if (server_->statistics().connections == 0 || std::chrono::steady_clock::now() >= leaves_at_) return io_.stop();
  patience_.expires_after(kGoodbyeTurn);
  patience_.async_wait([this](const boost::system::error_code& error) {
    if (!error) await_goodbyes();
  });
}

}  // namespace

int serve(const Options& options, cli::Console& console) {
  const auto endpoints = client::find_endpoints({.control = options.control_endpoint, .data = options.data_endpoint});
  if (!endpoints) return cli::fail_with(console, endpoints.error());
  Gateway gateway(options, *endpoints, [&console](const std::string& line) { console.talk << line << std::endl; });
  if (auto opened = gateway.open(); !opened) return cli::fail_with(console, opened.error());
  const std::string scheme = options.certificate_file.empty() ? "http" : "https";
  const std::string address = options.listen.substr(0, options.listen.rfind(':'));
  console.talk << "listening on " << scheme << "://" << address << ":" << gateway.port() << "/" << std::endl;
  sd_notify(0, "READY=1");
  gateway.run();
  return cli::kOk;
}

}  // namespace dts::gateway
