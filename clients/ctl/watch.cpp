// SPDX-License-Identifier: Apache-2.0
#include "ctl/watch.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>

#include "cli/exit_status.h"
#include "ctl/commands.h"
#include "ctl/csv_lines.h"
#include "ctl/json_lines.h"
#include "ctl/live_table.h"
#include "ctl/silence.h"
#include "ctl/text_lines.h"
#include "dts/subscriber.h"

namespace dts::ctl {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kLook{100};
constexpr std::chrono::seconds kSilence{3};

std::unique_ptr<WatchSink> make_sink(const Arguments& arguments, cli::Console& console) {
  if (arguments.is_csv) return std::make_unique<CsvLines>(console);
  if (arguments.is_jsonl) return std::make_unique<JsonLines>(console.out);
  if (console.can_redraw) return std::make_unique<LiveTable>(console);
  return std::make_unique<TextLines>(console);
}

client::Error no_table(const std::string& topic) {
  return {client::ErrorCode::InvalidArgument, "CSV is a table of a stream, and no stream begins with '" + topic + "'",
          "dtsctl watch " + topic + " --jsonl"};
}

class Watch {
 public:
  Watch(const Arguments& arguments, std::vector<std::string> topics, Target where, client::Subscriber subscriber, cli::Console& console)
      : arguments_(arguments),
        topics_(std::move(topics)),
        where_(std::move(where)),
        subscriber_(std::move(subscriber)),
        console_(console),
        sink_(make_sink(arguments, console)),
        remaining_(arguments.count.value_or(std::numeric_limits<std::uint64_t>::max())) {}

  int run();

 private:
  void handle(const client::Message& message);
  [[nodiscard]] bool wants_status() const;
  [[nodiscard]] std::optional<int> check_silence(Clock::time_point now);
  [[nodiscard]] bool is_status_new();
  [[nodiscard]] client::Error explain() const;
  void say(const client::Error& error);

  const Arguments& arguments_;
  std::vector<std::string> topics_;
  Target where_;
  client::Subscriber subscriber_;
  cli::Console& console_;
  std::unique_ptr<WatchSink> sink_;
  std::uint64_t remaining_;
  Clock::time_point looked_ = Clock::now();
  std::chrono::duration<double> silence_{};         ///< Of the watched topics.
  std::chrono::duration<double> daemon_silence_{};  ///< Of the daemon as a whole: it publishes a status every second.
  std::int64_t status_time_ns_ = 0;                 ///< Time of the newest status.
  bool has_reported_ = false;
  bool has_reported_daemon_ = false;
};

int Watch::run() {
  while (remaining_ > 0 && !(console_.can_redraw && console_.is_quit_asked())) {
    const auto message = subscriber_.receive(kLook);
    if (!message) return cli::fail_with(console_, message.error());
    if (arguments_.is_csv && asks_for_events_only(subscriber_.status(), topics_))
      return cli::fail_with(console_, no_table(topics_.front()));
    if (*message) handle(**message);
    const auto now = Clock::now();
    sink_->refresh(now);
    if (!console_.out || (!*message && console_.is_out_closed())) return cli::kOk;  // the reader has closed the output
    if (const auto status = check_silence(now)) return *status;
  }
  return cli::kOk;
}

void Watch::handle(const client::Message& message) {
  const auto now = Clock::now();
  if (const auto* block = std::get_if<client::Block>(&message)) {
    const std::size_t scans = std::min<std::uint64_t>(block->scan_count, remaining_);
    sink_->show(*block, scans, now);
    if (sink_->shows(block->topic)) remaining_ -= scans;
  } else if (const auto* event = std::get_if<client::Event>(&message)) {
    sink_->show(*event);
    if (sink_->shows(event->topic)) --remaining_;
  } else if (const auto* status = std::get_if<client::Status>(&message)) {
    if (!wants_status()) return;
    sink_->show(*status);
    if (sink_->shows("dtsd/status")) --remaining_;
  } else {
    sink_->forget();
    sink_->make_room();
    console_.talk << "dtsctl: the daemon was restarted; segment and scan numbers start again" << std::endl;
  }
  silence_ = {};
  daemon_silence_ = {};
  has_reported_daemon_ = false;
  has_reported_ = asks_for_events_only(subscriber_.status(), topics_);  // silence is normal if only events are watched
}

/// An empty prefix means everything about rigs: a status line per second would hide it.
bool Watch::wants_status() const {
  return std::ranges::any_of(
      topics_, [](const std::string& prefix) { return !prefix.empty() && std::string_view("dtsd/status").starts_with(prefix); });
}

/// Reports the cause once per silence; returns an exit status after `--timeout`. Counts only time spent receiving: a process stopped with
/// Ctrl-Z cannot receive.
std::optional<int> Watch::check_silence(Clock::time_point now) {
  const auto listened = std::min<std::chrono::duration<double>>(now - looked_, 2 * kLook);
  looked_ = now;
  silence_ += listened;
  daemon_silence_ += listened;
  if (is_status_new()) {
    daemon_silence_ = {};
    has_reported_daemon_ = false;
  }
  if (arguments_.timeout_s && silence_.count() >= *arguments_.timeout_s) {
    const client::Error error = explain();
    say(error);
    return cli::exit_status(error.code);
  }
  const bool is_daemon_silent = daemon_silence_ >= kSilence;
  if (is_daemon_silent ? has_reported_daemon_ : has_reported_ || silence_ < kSilence) return std::nullopt;
  client::Error error = explain();
  has_reported_ = true;
  has_reported_daemon_ = is_daemon_silent || error.code == client::ErrorCode::Unreachable;
  error.hint += console_.can_redraw ? "; still waiting; q ends" : "; still waiting; Ctrl-C ends";
  say(error);
  return std::nullopt;
}

bool Watch::is_status_new() {
  const v1::StatusSnapshot* status = subscriber_.status();
  if (status == nullptr || status->host_time_ns() == status_time_ns_) return false;
  status_time_ns_ = status->host_time_ns();
  return true;
}

/// Uses the daemon's last status only while the daemon is not silent.
client::Error Watch::explain() const {
  const std::string& endpoint = where_.endpoints.data;
  if (auto somebody = client::probe(endpoint); !somebody) return somebody.error();
  client::Error error = explain_silence(daemon_silence_ >= kSilence ? nullptr : subscriber_.status(), topics_, endpoint);
  if (where_.key && error.code == client::ErrorCode::Unreachable) {
    error.hint = "on the daemon's machine, check that dtsd and dts-relay run, and that dtsd still has the key '" + where_.key->name +
                 "': dtsctl key list";
  }
  return error;
}

void Watch::say(const client::Error& error) {
  sink_->make_room();
  cli::print_error(console_, error.what, error.hint);
}

}  // namespace

int run_watch(const Arguments& arguments, cli::Console& console) {
  if (arguments.is_json) {
    return cli::fail_with(console, client::Error{client::ErrorCode::InvalidArgument, "watch prints a stream, not one document",
                                                 "use --jsonl instead of --json"});
  }
  if (arguments.is_csv && arguments.topics.size() > 1) {
    return cli::fail_with(console,
                          client::Error{client::ErrorCode::InvalidArgument,
                                        "CSV is a table of one stream, not of " + std::to_string(arguments.topics.size()) + " topics",
                                        "dtsctl watch " + arguments.topics.front() + " --csv, or --jsonl for all"});
  }
  if (arguments.is_csv && !arguments.topics.empty() && arguments.topics.front().starts_with("dtsd/")) {
    return cli::fail_with(console, no_table(arguments.topics.front()));
  }
  const auto where = target(arguments);
  if (!where) return cli::fail_with(console, where.error());
  const std::string& address = where->endpoints.data;
  if (auto somebody = client::probe(address); !somebody) return cli::fail_with(console, somebody.error());
  const std::vector<std::string> topics = arguments.topics.empty() ? std::vector<std::string>{""} : arguments.topics;
  auto subscriber = client::Subscriber::open(
      {.endpoint = address, .topics = topics, .mode = arguments.is_latest ? client::Mode::Latest : client::Mode::All, .key = where->key});
  if (!subscriber) return cli::fail_with(console, subscriber.error());
  return Watch(arguments, topics, *where, std::move(*subscriber), console).run();
}

}  // namespace dts::ctl
