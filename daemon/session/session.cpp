// SPDX-License-Identifier: Apache-2.0
#include "session/session.h"

#include <cmath>
#include <utility>

#include "record/session_facts.h"

namespace dts::session {
namespace {

constexpr double kStartTimeoutS = 10.0;
constexpr double kLongestDurationS = 7.0 * 86400.0;
constexpr double kLongestSettleS = 3600.0;
constexpr std::size_t kLongestText = 200;

double seconds_between(std::int64_t from_ns, std::int64_t to_ns) { return static_cast<double>(to_ns - from_ns) * 1e-9; }

}  // namespace

std::string_view name(SessionState state) noexcept {
  switch (state) {
    case SessionState::Idle: return "idle";
    case SessionState::Starting: return "starting";
    case SessionState::Settling: return "settling";
    case SessionState::Running: return "running";
    case SessionState::Stopping: return "stopping";
    case SessionState::Failed: return "failed";
  }
  return "unknown";
}

core::Status check(const SessionRequest& request) {
  using core::ErrorCode;
  if (request.subject.size() > record::kLongestSubject || !record::is_id(request.subject)) {
    return core::fail(ErrorCode::InvalidArgument, "the subject ID must have at most 64 letters, digits, '_', '.' or '-'",
                      "use the clinic's subject ID, never a name");
  }
  if (request.label.size() > kLongestText) return core::fail(ErrorCode::InvalidArgument, "label is longer than 200 bytes");
  if (!std::isfinite(request.duration_s) || request.duration_s < 0 || request.duration_s > kLongestDurationS) {
    return core::fail(ErrorCode::InvalidArgument, "duration_s must be 0 (until stopped) or up to 604800 s");
  }
  if (!std::isfinite(request.settle_s) || request.settle_s < 0 || request.settle_s > kLongestSettleS) {
    return core::fail(ErrorCode::InvalidArgument, "settle_s must be 0..3600 s");
  }
  return {};
}

core::Status Session::check_free() const {
  if (!is_under_way()) return {};
  return core::fail(core::ErrorCode::WrongState, "rig '" + rig_ + "' already has session " + id_ + " (" + std::string(name(state_)) + ")",
                    "stop it first: dtsctl session stop --rig " + rig_);
}

core::Status Session::start(std::string id, const SessionRequest& request, std::int64_t now_ns) {
  DTS_TRY(check_free());
  id_ = std::move(id);
  request_ = request;
  has_scan_count_ = false;
  running_since_ns_ = 0;
  stopped_ns_ = 0;
  failure_.clear();
  enter(SessionState::Starting, now_ns);
  return {};
}

core::Status Session::stop(std::int64_t now_ns) {
  if (!is_under_way()) {
    return core::fail(core::ErrorCode::WrongState, "rig '" + rig_ + "' has no session to stop",
                      "start one: dtsctl session start --rig " + rig_ + " --protocol NAME");
  }
  if (state_ == SessionState::Stopping) {
    return core::fail(core::ErrorCode::WrongState, "session " + id_ + " is stopping already: its recording is being closed");
  }
  stopped_ns_ = now_ns;
  enter(SessionState::Stopping, now_ns);
  return {};
}

void Session::fail(std::int64_t now_ns, std::string message) {
  if (!is_under_way()) return;
  failure_ = std::move(message);
  if (state_ != SessionState::Stopping) static_cast<void>(stop(now_ns));  // cannot fail: a session is under way
}

void Session::report(std::int64_t now_ns, std::string message) {
  if (!is_under_way() || message == message_) return;
  message_ = std::move(message);
  changes_.push_back(view(now_ns));
}

void Session::closed(std::int64_t now_ns) {
  if (state_ == SessionState::Stopping) enter(failure_.empty() ? SessionState::Idle : SessionState::Failed, now_ns, failure_);
}

void Session::tick(std::int64_t now_ns, std::uint64_t scans_total) {
  if (state_ == SessionState::Starting) {
    if (!std::exchange(has_scan_count_, true)) scans_at_start_ = scans_total;
    if (scans_total > scans_at_start_) {
      enter(SessionState::Settling, now_ns);
    } else if (seconds_between(entered_ns_, now_ns) > kStartTimeoutS) {
      fail(now_ns, "the device delivered no scan for 10 s; see dtsctl status");
    }
  }
  if (state_ == SessionState::Settling && seconds_between(entered_ns_, now_ns) >= request_.settle_s) {
    running_since_ns_ = now_ns;
    enter(SessionState::Running, now_ns);
  }
  if (state_ == SessionState::Running && request_.duration_s > 0 && seconds_between(running_since_ns_, now_ns) >= request_.duration_s) {
    static_cast<void>(stop(now_ns));  // cannot fail: the session is running
  }
}

void Session::revise(std::string subject, std::string label, std::int64_t now_ns) {
  if (is_under_way()) return;
  request_.subject = std::move(subject);
  request_.label = std::move(label);
  changes_.push_back(view(now_ns));
}

void Session::forget(std::int64_t now_ns) {
  if (is_under_way()) return;
  id_.clear();
  request_ = {};
  running_since_ns_ = 0;
  enter(SessionState::Idle, now_ns);
}

SessionView Session::view(std::int64_t now_ns) const {
  SessionView view{.id = id_, .state = state_, .request = request_, .message = message_};
  if (running_since_ns_ != 0) view.elapsed_s = seconds_between(running_since_ns_, is_under_way() ? now_ns : stopped_ns_);
  return view;
}

std::vector<SessionView> Session::take_changes() { return std::exchange(changes_, {}); }

void Session::enter(SessionState state, std::int64_t now_ns, std::string message) {
  state_ = state;
  entered_ns_ = now_ns;
  message_ = std::move(message);
  changes_.push_back(view(now_ns));
}

}  // namespace dts::session
