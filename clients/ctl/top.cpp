// SPDX-License-Identifier: Apache-2.0
#include "ctl/top.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <utility>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "ctl/commands.h"
#include "ctl/health_view.h"
#include "ctl/screen.h"
#include "ctl/silence.h"
#include "dts/subscriber.h"

namespace dts::ctl {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;

constexpr milliseconds kTurn{100};
constexpr std::chrono::seconds kLongestWithoutStatus{3};

class Top {
 public:
  Top(const Arguments& arguments, std::string endpoint, client::Subscriber subscriber, cli::Console& console)
      : arguments_(arguments),
        endpoint_(std::move(endpoint)),
        subscriber_(std::move(subscriber)),
        console_(console),
        screen_(console),
        is_drawn_(console.can_redraw && !arguments.is_json && !arguments.is_jsonl),
        remaining_(arguments.count.value_or(std::numeric_limits<std::uint64_t>::max())) {}

  int run();

 private:
  void show();
  [[nodiscard]] std::optional<int> check_silence();

  const Arguments& arguments_;
  std::string endpoint_;
  client::Subscriber subscriber_;
  cli::Console& console_;
  Screen screen_;
  bool is_drawn_;
  std::uint64_t remaining_;
  HealthView view_;
  std::chrono::steady_clock::time_point looked_ = std::chrono::steady_clock::now();
  duration<double> silence_{};
  bool has_reported_silence_ = false;
};

int Top::run() {
  while (remaining_ > 0 && !(is_drawn_ && console_.is_quit_asked())) {
    const auto message = subscriber_.receive(kTurn);
    if (!message) return cli::fail_with(console_, message.error());
    if (*message) {
      if (const auto* status = std::get_if<client::Status>(&**message)) {
        view_.update(*status->snapshot);
        silence_ = {};
        has_reported_silence_ = false;
        show();
        --remaining_;
      }
    }
    if (!console_.out || (!*message && console_.is_out_closed())) return cli::kOk;  // the reader has closed the output
    if (const auto status = check_silence()) return *status;
  }
  return cli::kOk;
}

void Top::show() {
  if (is_drawn_) return screen_.draw(view_.lines(screen_.clear()));
  console_.out << cli::one_line(view_.json()) << std::endl;
}

/// As in `watch`: reports a silence once, returns an exit status after `--timeout`, and counts only time spent receiving.
std::optional<int> Top::check_silence() {
  const auto now = std::chrono::steady_clock::now();
  silence_ += std::min<duration<double>>(now - looked_, 2 * kTurn);
  looked_ = now;
  const bool is_over = arguments_.timeout_s && silence_.count() >= *arguments_.timeout_s;
  if (!is_over && (has_reported_silence_ || silence_ < kLongestWithoutStatus)) return std::nullopt;
  has_reported_silence_ = true;
  screen_.make_room();  // the old picture stays, above the error message
  const client::Error error = explain_silence(nullptr, {}, endpoint_);
  cli::print_error(console_, error.what, error.hint);
  return is_over ? std::optional(cli::exit_status(error.code)) : std::nullopt;
}

}  // namespace

int run_top(const Arguments& arguments, cli::Console& console) {
  const auto where = target(arguments);
  if (!where) return cli::fail_with(console, where.error());
  const std::string& address = where->endpoints.data;
  if (auto somebody = client::probe(address); !somebody) return cli::fail_with(console, somebody.error());
  auto subscriber = client::Subscriber::open({.endpoint = address, .topics = {"dtsd/status"}, .key = where->key});
  if (!subscriber) return cli::fail_with(console, subscriber.error());
  return Top(arguments, address, std::move(*subscriber), console).run();
}

}  // namespace dts::ctl
