// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/forwarder.h"

#include <malloc.h>
#include <sched.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "core/clock.h"
#include "core/join.h"
#include "core/thread.h"
#include "core/token_bucket.h"
#include "dts/subscriber.h"
#include "fleet/forward/beat.h"
#include "fleet/forward/desk.h"
#include "fleet/forward/event_mask.h"
#include "fleet/forward/outbox.h"
#include "fleet/forward/status_words.h"
#include "fleet/forward/uploader.h"
#include "fleet/forward/viewers.h"
#include "fleet/wire/messages.h"
#include "fleet/wire/nkey.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::forward {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kTurn{100};  // longest delay before a signal is handled
constexpr std::chrono::seconds kBeatPeriod{10};
constexpr std::chrono::seconds kBeatAgain{2};  // after one without an answer
constexpr milliseconds kBeatTimeout{3000};
constexpr std::chrono::seconds kFreshStatus{5};
constexpr std::chrono::minutes kLookAtAll{10};
constexpr std::chrono::seconds kTryDaemonAgain{5};
constexpr std::chrono::seconds kLookAgain{2};  // the catalogue may change a little later than the event
constexpr std::chrono::seconds kWords{2};
constexpr std::chrono::seconds kPauseAfterBug{10};
constexpr milliseconds kReceive{20};

/// What the threads pass to each other.
class Board {
 public:
  /// dtsd's newest status, if it is fresh.
  [[nodiscard]] std::shared_ptr<const v1::StatusSnapshot> status() const {
    const std::lock_guard lock(mutex_);
    return steady_clock::now() - status_at_ < kFreshStatus ? status_ : nullptr;
  }
  void set_status(std::shared_ptr<const v1::StatusSnapshot> status) {
    const std::lock_guard lock(mutex_);
    status_ = std::move(status);
    status_at_ = steady_clock::now();
  }
  /// Something has happened at dtsd: the desk looks at once. `is_all`: at all sessions.
  void wake_desk(bool is_all) {
    const std::lock_guard lock(mutex_);
    is_look_due_ = true;
    is_all_due_ = is_all_due_ || is_all;
    changed_.notify_all();
  }
  /// Something can be sent.
  void wake_all() {
    const std::lock_guard lock(mutex_);
    ++changes_;
    changed_.notify_all();
  }
  struct Due {
    bool look = false;
    bool all = false;
  };
  /// Waits until a look is due or something has changed, but no longer than `timeout`.
  [[nodiscard]] Due wait_for_look(milliseconds timeout, std::uint64_t& seen) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [this, &seen] { return is_look_due_ || changes_ != seen; });
    seen = changes_;
    return {.look = std::exchange(is_look_due_, false), .all = std::exchange(is_all_due_, false)};
  }
  void wait_for_change(milliseconds timeout, std::uint64_t& seen) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [this, &seen] { return changes_ != seen; });
    seen = changes_;
  }
  void set_word(const std::string& name, std::string value) {
    const std::lock_guard lock(mutex_);
    words_[name] = std::move(value);
  }
  [[nodiscard]] std::map<std::string, std::string> words() const {
    const std::lock_guard lock(mutex_);
    return words_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const v1::StatusSnapshot> status_;
  steady_clock::time_point status_at_{};
  bool is_look_due_ = true;
  bool is_all_due_ = true;
  std::uint64_t changes_ = 0;
  std::map<std::string, std::string> words_;
};

/// The parts and their threads.
class Forwarder {
 public:
  Forwarder(const Settings& settings, client::Endpoints endpoints, std::unique_ptr<Store> store, std::unique_ptr<Uplink> bulk,
            std::unique_ptr<Uplink> talk, link::LinkOptions live, core::Log log)
      : settings_(settings),
        endpoints_(std::move(endpoints)),
        log_(std::move(log)),
        store_(std::move(store)),
        bulk_(std::move(bulk)),
        talk_(std::move(talk)),
        live_options_(std::move(live)),
        uploader_({.clinic = settings.clinic, .rules = settings.rules, .limits = settings.upload}, *bulk_, *store_, clock_, log_) {}

  void run();

 private:
  using Work = void (Forwarder::*)(const std::stop_token& stop);

  [[nodiscard]] std::int64_t utc_ns() const noexcept { return clock_.now_ns() + clock_.utc_minus_monotonic_ns(); }
  [[nodiscard]] std::jthread start(const char* name, Work work);
  void watch(const std::stop_token& stop);
  void desk(const std::stop_token& stop);
  void upload(const std::stop_token& stop);
  void live(const std::stop_token& stop);
  void send_beat(const std::stop_token& stop);
  void handle_status(const v1::StatusSnapshot& status, std::set<std::string>& rigs);
  [[nodiscard]] core::Status look(Outbox& outbox, bool is_all, const std::stop_token& stop);
  void show_words();
  void serve_viewers(Viewers& viewers, Mailbox& requests, milliseconds timeout);
  void send_live(Uplink& uplink, const client::Message& message);
  void send_live(Uplink& uplink, const std::string& topic, std::string data);
  void send_status(Uplink& uplink, v1::StatusSnapshot status);

  const Settings& settings_;
  client::Endpoints endpoints_;
  core::Log log_;
  core::SystemClock clock_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<Uplink> bulk_;
  std::unique_ptr<Uplink> talk_;
  link::LinkOptions live_options_;
  core::TokenBucket complaints_{0.1, 5.0};  ///< Of wrong requests. Thread: live.
  Uploader uploader_;
  Board board_;
  std::atomic<bool> is_desk_retry_due_ = false;
  bool is_centre_silent_ = false;  ///< The last beat was not answered. Thread: watch, as the next three.
  std::string logged_silence_;
  std::uint64_t erasures_ = 0;
  std::uint64_t instance_ = 0;
};

/// Lets everything else on the machine come first.
void become_idle(const core::Log& log) {
  // From linux/ioprio.h, which is not C++ in each version: a parameter is named `class`.
  constexpr int kWhoProcess = 1;
  constexpr int kIdle = 3 << 13;
  const sched_param parameters{};
  if (::sched_setscheduler(0, SCHED_IDLE, &parameters) != 0)
    log.warning("the upload cannot run with SCHED_IDLE: it may slow down other work");
  if (::syscall(SYS_ioprio_set, kWhoProcess, 0, kIdle) != 0) {
    log.warning("the upload cannot read with the lowest I/O priority: it may slow down other work");
  }
}

/// Starts a thread that works until the end. An exception (no memory, a bug) ends only the present work.
std::jthread Forwarder::start(const char* name, Work work) {
  return std::jthread([this, name, work](const std::stop_token& stop) {
    (void)core::configure_this_thread(name, {});
    while (!stop.stop_requested()) {
      try {
        (this->*work)(stop);
      } catch (const std::exception& error) {
        log_.error(std::string(name) + ": " + error.what() + ". It starts again in 10 s");
      }
      for (steady_clock::time_point until = steady_clock::now() + kPauseAfterBug; !stop.stop_requested() && steady_clock::now() < until;) {
        std::this_thread::sleep_for(kTurn);
      }
    }
  });
}

void Forwarder::handle_status(const v1::StatusSnapshot& status, std::set<std::string>& rigs) {
  const bool is_known = board_.status() != nullptr;
  board_.set_status(std::make_shared<v1::StatusSnapshot>(status));
  uploader_.set_session_running(is_session_running(status));
  const bool is_other = instance_ != status.instance_id() || erasures_ != status.erasures_total();
  instance_ = status.instance_id();
  erasures_ = status.erasures_total();
  if (is_other || !is_known) board_.wake_desk(true);
  rigs.clear();
  for (const v1::RigStatus& rig : status.rigs()) rigs.insert(rig.rig().name());
}

void Forwarder::send_beat(const std::stop_token& stop) {
  const auto backlog = store_->backlog();
  const auto status = board_.status();
  const std::int64_t sent_at = utc_ns();
  const v1::Beat beat = beat_of(status.get(), backlog ? *backlog : v1::Backlog(), DTS_VERSION, sent_at);
  const auto answered =
      ask(*talk_, wire::to_text({.clinic = settings_.clinic, .matter = wire::Matter::Beat}), beat.SerializeAsString(), kBeatTimeout, stop);
  if (!stop.stop_requested()) board_.set_word(words::kBeatProblem, answered ? "" : answered.error().what);
  if (!answered) {
    is_centre_silent_ = true;
    // The link itself reports that it is lost.
    if (!stop.stop_requested() && talk_->is_connected() && std::exchange(logged_silence_, answered.error().what) != answered.error().what)
      log_.warning(answered.error().what);
    return;
  }
  if (!std::exchange(logged_silence_, {}).empty()) log_.info("the centre answers again");
  if (std::exchange(is_centre_silent_, false)) {
    uploader_.retry();
    is_desk_retry_due_ = true;
    board_.wake_all();
  }
  const auto answer = wire::decode_beat_answer(*answered);
  if (!answer) return log_.warning("answer to a beat: " + core::to_string(answer.error()));
  const std::int64_t now = utc_ns();
  board_.set_word(words::kHub, answer->hub());
  board_.set_word(words::kBeat, std::to_string(now));
  board_.set_word(words::kClockOffset, std::to_string(sent_at / 2 + now / 2 - answer->utc_ns()));
  if (!answer->audit_head().empty()) board_.set_word(words::kAuditHead, wire::hex_of(answer->audit_head()));
}

void Forwarder::watch(const std::stop_token& stop) {
  auto subscriber = client::Subscriber::open({.endpoint = endpoints_.data, .topics = {"dtsd/status"}});
  if (!subscriber) return log_.error("dtsd's data socket: " + subscriber.error().what);
  std::set<std::string> subscribed;
  auto beat_at = steady_clock::now();
  while (!stop.stop_requested()) {
    const auto message = subscriber->receive(kTurn);
    if (!message) return log_.error("dtsd's data socket: " + message.error().what);
    if (*message) {
      if (const auto* status = std::get_if<client::Status>(&**message)) {
        std::set<std::string> rigs;
        handle_status(*status->snapshot, rigs);
        if (rigs != subscribed) {
          subscribed = rigs;
          std::vector<std::string> topics{"dtsd/status"};
          for (const std::string& rig : rigs) topics.push_back(rig + "/session");
          if (auto changed = subscriber->set_topics(topics); !changed) return log_.error("dtsd's data socket: " + changed.error().what);
        }
      } else if (std::holds_alternative<client::Event>(**message)) {
        board_.wake_desk(false);
      }
    }
    if (const auto now = steady_clock::now(); now >= beat_at) {
      send_beat(stop);
      beat_at = now + (is_centre_silent_ ? kBeatAgain : kBeatPeriod);
    }
  }
}

core::Status Forwarder::look(Outbox& outbox, bool is_all, const std::stop_token& stop) {
  auto looked = is_all ? outbox.look_at_all(utc_ns(), stop) : outbox.look(utc_ns(), stop);
  ::malloc_trim(0);  // a list of 10,000 sessions needs some 20 MB for a moment
  return looked;
}

void Forwarder::desk(const std::stop_token& stop) {
  auto clinic = open_clinic(endpoints_.control);
  if (!clinic) return log_.error(core::to_string(clinic.error()));
  Outbox outbox(**clinic, *store_, settings_.rules, log_);
  Desk desk(settings_.clinic, *talk_, *store_, log_);
  std::uint64_t seen = 0;
  auto all_at = steady_clock::now();
  auto again_at = steady_clock::time_point::max();
  bool is_all = true;
  while (!stop.stop_requested()) {
    const Board::Due due = board_.wait_for_look(kTurn, seen);
    const auto now = steady_clock::now();
    is_all = is_all || due.all || now >= all_at;
    if ((due.look || now >= all_at || now >= again_at) && !stop.stop_requested()) {
      again_at = steady_clock::time_point::max();
      if (is_all) all_at = now + kLookAtAll;
      const auto looked = look(outbox, is_all, stop);
      board_.set_word(words::kOutboxProblem, looked ? "" : looked.error().what);
      if (looked) {
        is_all = false;
        if (due.look) again_at = now + kLookAgain;
      } else {
        again_at = now + kTryDaemonAgain;
      }
      board_.wake_all();
    }
    if (is_desk_retry_due_.exchange(false)) desk.retry();
    desk.serve(steady_clock::now(), stop);
    board_.set_word(words::kDeskProblem, desk.problem());
  }
}

void Forwarder::upload(const std::stop_token& stop) {
  become_idle(log_);
  std::uint64_t seen = 0;
  while (!stop.stop_requested()) {
    if (uploader_.work(stop)) {
      board_.wake_all();  // a checksum is known: the facts must be sent
    } else {
      board_.wait_for_change(kTurn, seen);
    }
  }
}

void Forwarder::send_live(Uplink& uplink, const client::Message& message) {
  std::string topic;
  std::string data;
  if (const auto* block = std::get_if<client::Block>(&message)) {
    topic = block->topic;
    data = block->body->SerializeAsString();
  } else if (const auto* event = std::get_if<client::Event>(&message)) {
    topic = event->topic;
    v1::Event masked = *event->body;
    mask_event(masked, settings_.rules);
    data = masked.SerializeAsString();
  } else if (const auto* status = std::get_if<client::Status>(&message)) {
    return send_status(uplink, *status->snapshot);
  } else {
    return;
  }
  send_live(uplink, topic, std::move(data));
}

void Forwarder::send_live(Uplink& uplink, const std::string& topic, std::string data) {
  if (!uplink.has_room()) return;  // the block's sequence shows a loss
  const std::string subject = wire::to_text({.clinic = settings_.clinic, .matter = wire::Matter::Live, .topic = topic});
  (void)uplink.publish({.subject = subject, .data = std::move(data)});
}

void Forwarder::send_status(Uplink& uplink, v1::StatusSnapshot status) {
  mask_status(status, settings_.rules);
  send_live(uplink, std::string(kStatusTopic), status.SerializeAsString());
}

void Forwarder::serve_viewers(Viewers& viewers, Mailbox& requests, milliseconds timeout) {
  for (auto letter = requests.next(timeout); letter; letter = requests.next(milliseconds(0))) {
    const auto request = wire::decode_live_request(letter->data);
    if (!request || !wire::is_inbox_of_dashboard(letter->reply)) {
      if (complaints_.take(steady_clock::now())) log_.warning("a request to watch is not valid");
      continue;
    }
    const auto status = board_.status();
    const v1::LiveAnswer answer = viewers.handle(*request, status.get(), steady_clock::now());
    (void)talk_->publish({.subject = letter->reply, .data = answer.SerializeAsString()});  // the viewer asks again
    if (answer.has_lease_s() && status) send_status(*talk_, *status);                      // a new viewer needs it before anything else
  }
  viewers.expire(steady_clock::now());
  board_.set_word(words::kViewers, core::join(viewers.names(), ", "));
}

void Forwarder::live(const std::stop_token& stop) {
  Viewers viewers(settings_.is_live_allowed, log_);
  const std::string subject = wire::to_text({.clinic = settings_.clinic, .matter = wire::Matter::DownLive});
  std::optional<client::Subscriber> subscriber;
  std::unique_ptr<Uplink> uplink;
  std::vector<std::string> topics;
  const auto requests = talk_->listen(subject);
  if (!requests) return log_.error("requests to watch: " + requests.error().what);
  while (!stop.stop_requested()) {
    serve_viewers(viewers, **requests, subscriber ? milliseconds(0) : kTurn);
    if (const auto wanted = viewers.topics(); wanted != topics) {
      topics = wanted;
      if (topics.empty()) {
        subscriber.reset();
        uplink.reset();
      } else if (subscriber) {
        if (!subscriber->set_topics(topics)) subscriber.reset();
      }
      if (!topics.empty() && !subscriber) {
        auto opened = client::Subscriber::open({.endpoint = endpoints_.data, .topics = topics});
        if (!opened) return log_.error("dtsd's data socket: " + opened.error().what);
        subscriber.emplace(std::move(*opened));
      }
      if (!topics.empty() && !uplink) {
        auto opened = open_uplink(live_options_, log_);
        if (!opened) return log_.error("live data: " + opened.error().what);
        uplink = std::move(*opened);
      }
    }
    if (!subscriber) continue;
    const auto message = subscriber->receive(kReceive);
    if (!message) return log_.error("dtsd's data socket: " + message.error().what);
    if (*message) send_live(*uplink, **message);
  }
}

/// Stores what `dts-forward status` shows.
void Forwarder::show_words() {
  auto shown = board_.words();
  const UploadProgress progress = uploader_.progress();
  shown[words::kUpdated] = std::to_string(utc_ns());
  shown[words::kLinkProblem] = bulk_->problem();
  shown[words::kUploadSession] = progress.session;
  shown[words::kUploadPart] = std::to_string(progress.part);
  shown[words::kUploadBytes] = std::to_string(progress.bytes);
  shown[words::kUploadHave] = std::to_string(progress.have);
  shown[words::kUploadRate] = std::to_string(progress.bytes_per_s);
  shown[words::kUploadProblem] = progress.problem;
  if (auto stored = store_->set_words(shown); !stored) log_.error(core::to_string(stored.error()));
}

/// Returns true if SIGTERM or SIGINT arrives within `timeout`.
bool is_end_requested(milliseconds timeout) {
  sigset_t wanted;
  sigemptyset(&wanted);
  for (const int signal : {SIGTERM, SIGINT}) sigaddset(&wanted, signal);
  const timespec wait{.tv_sec = timeout.count() / 1000, .tv_nsec = timeout.count() % 1000 * 1'000'000};
  return ::sigtimedwait(&wanted, nullptr, &wait) > 0;
}

void Forwarder::run() {
  std::vector<std::jthread> threads;
  threads.push_back(start("watch", &Forwarder::watch));
  threads.push_back(start("desk", &Forwarder::desk));
  threads.push_back(start("upload", &Forwarder::upload));
  threads.push_back(start("live", &Forwarder::live));
  sd_notify(0, "READY=1");
  log_.info("clinic " + settings_.clinic + " forwards to " + core::join(settings_.servers, ", "));
  auto words_at = steady_clock::now();
  while (!is_end_requested(kTurn)) {
    if (steady_clock::now() < words_at) continue;
    words_at = steady_clock::now() + kWords;
    show_words();
  }
  sd_notify(0, "STOPPING=1");
  log_.info("stopping");
  for (std::jthread& thread : threads) thread.request_stop();
}

/// Opens the store. A damaged one is made again: the centre's answers restore what it has. It is kept for its erasures, which nothing
/// restores.
core::Result<std::unique_ptr<Store>> open_store(const std::string& folder, const core::Log& log) {
  auto store = Store::open(folder);
  if (store || store.error().code != core::ErrorCode::DataDamaged) return store;
  DTS_TRY_ASSIGN(const std::string aside, Store::set_aside(folder));
  log.error(core::to_string(store.error()) + ". dts-forward kept it as " + aside +
            " and makes a new one, which does not know which sessions the centre must still erase");
  return Store::open(folder);
}

core::Status make_folder(const std::string& folder) {
  if (::mkdir(folder.c_str(), 0750) == 0 || errno == EEXIST) return {};
  return core::fail_errno(errno, "cannot make the folder " + folder,
                          "make it for the user of dts-forward: install -d -o dts-forward -m 700 " + folder);
}

}  // namespace

core::Status run_forwarder(const Settings& settings, const core::Log& log) {
  auto key = wire::read_nkey(settings.key_file);
  if (!key && key.error().code == core::ErrorCode::NotFound) key.error().hint = "dts-forward key --config FILE";
  if (!key) return tl::make_unexpected(key.error());
  DTS_TRY(make_folder(settings.state_folder));
  DTS_TRY_ASSIGN(auto store, open_store(settings.state_folder, log));
  DTS_TRY(store->set_rules(settings.rules));
  DTS_TRY(store->set_centre(settings.clinic, settings.ca_pem));
  DTS_TRY(store->retry_held());
  auto endpoints = client::find_endpoints(settings.daemon);
  if (!endpoints) return tl::make_unexpected(error_of(endpoints.error()));
  link::LinkOptions options{.servers = settings.servers,
                            .ca_pem = settings.ca_pem,
                            .name = settings.clinic + " recordings",
                            .seed = key->seed,
                            .inbox_prefix = wire::inbox_prefix(settings.clinic),
                            .rejection = "it is revoked, or not yet added (ask the centre: dts-fleet clinic list)"};
  DTS_TRY_ASSIGN(auto bulk, open_uplink(options, log));
  options.name = settings.clinic + " facts";
  DTS_TRY_ASSIGN(auto talk, open_uplink(options, log));
  options.name = settings.clinic + " live";
  Forwarder(settings, std::move(*endpoints), std::move(store), std::move(bulk), std::move(talk), std::move(options), log).run();
  return {};
}

}  // namespace dts::fleet::forward
