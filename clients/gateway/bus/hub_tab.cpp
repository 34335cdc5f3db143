// SPDX-License-Identifier: Apache-2.0
#include "gateway/bus/hub_tab.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/utf8.h"
#include "dts/wire/options.h"
#include "gateway/access/command_id.h"
#include "gateway/bus/hub.h"

namespace dts::gateway {
namespace {

using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC, like host times

constexpr unsigned kPolicyViolation = 1008;  // RFC 6455, 7.4.1
constexpr unsigned kLoggedOut = 4401;        // our own code, similar to HTTP's 401
constexpr std::size_t kMostCommandsUnderWay = 8;
constexpr std::size_t kLongestRequestId = 64;
/// With more unsent bytes the network is slow: new messages wait in the queue, where they can be dropped.
constexpr std::size_t kMostUnsentBytes = 256U << 10U;
constexpr std::chrono::milliseconds kSlowNetworkPause{50};

client::Error refusal(client::ErrorCode code, std::string what, std::string hint) {
  return {.code = code, .what = std::move(what), .hint = std::move(hint)};
}

/// Cuts only between characters: half a character would make the message unreadable.
std::string short_id(const std::string& id) {
  std::size_t length = std::min(id.size(), kLongestRequestId);
  while (length > 0 && length < id.size() && !core::starts_character(id[length])) --length;
  return id.substr(0, length);
}

}  // namespace

HubTab::HubTab(Hub& hub, boost::asio::io_context& io, CommandPool* commands, Identity identity, TabConnection& connection)
    : hub_(hub),
      commands_(commands),
      identity_(std::move(identity)),
      connection_(connection),
      timer_(io),
      self_(std::make_shared<HubTab*>(this)) {}

HubTab::~HubTab() { hub_.close_tab(*this); }

void HubTab::welcome(const std::string& version, const v1::Link& link) {
  v1::FromGateway message;
  v1::Welcome& welcome = *message.mutable_welcome();
  welcome.set_user(identity_.user);
  welcome.set_role(identity_.role);
  welcome.set_version(version);
  *welcome.mutable_link() = link;
  send(message);
}

void HubTab::send_link(const v1::Link& link) {
  v1::FromGateway message;
  *message.mutable_link() = link;
  send(message);
}

void HubTab::push(const CarriedPointer& message) {
  // The status arrives every second: often enough to detect that a login has ended.
  if (message->kind == Carried::Kind::Status && !identity_.holds()) return connection_.close(kLoggedOut, "the login has expired");
  queue_.push(message, Clock::now());
  arm();
}

void HubTab::on_message(std::string_view bytes) {
  v1::FromBrowser message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return connection_.close(kPolicyViolation, "not a message of dts.v1");
  }
  switch (message.body_case()) {
    case v1::FromBrowser::kSubscribe: return on_subscribe(std::move(*message.mutable_subscribe()));
    case v1::FromBrowser::kPainted:
      if (!queue_.painted(message.painted().frame())) return connection_.close(kPolicyViolation, "confirmed a frame that was not sent");
      return arm();
    case v1::FromBrowser::kClockProbe: return answer_clock(message.clock_probe());
    case v1::FromBrowser::kRequest: return on_request(std::move(*message.mutable_request()));
    case v1::FromBrowser::BODY_NOT_SET: break;
  }
  connection_.close(kPolicyViolation, "an empty message");
}

void HubTab::on_subscribe(v1::Subscribe&& wanted) {
  std::vector<std::string> prefixes(wanted.mutable_topics()->begin(), wanted.mutable_topics()->end());
  if (!queue_.subscribe(std::move(prefixes), wanted.frames_per_second())) {
    return connection_.close(kPolicyViolation, "too many or too long topics, or an impossible rate");
  }
  hub_.wishes_changed(*this);
}

void HubTab::answer_clock(const v1::ClockProbe& probe) {
  v1::FromGateway message;
  message.mutable_clock_answer()->set_browser_ms(probe.browser_ms());
  message.mutable_clock_answer()->set_host_time_ns(hub_.host_time());
  send(message);
}

void HubTab::on_request(v1::Request&& request) {
  const v1::Role needed = wire::rules_of(request).role();
  const std::string id = request.request_id();
  if (commands_ == nullptr) {
    return refuse(id, refusal(client::ErrorCode::NotAllowed, "the centre can only look", "give this command at the clinic"));
  }
  if (id.empty() || id.size() > kLongestRequestId || needed == v1::ROLE_UNSPECIFIED || request.has_note_login()) {
    return refuse(id, refusal(client::ErrorCode::InvalidArgument, "unknown command for this version of the gateway", "reload the page"));
  }
  if (!identity_.holds()) return connection_.close(kLoggedOut, "the login has expired");
  if (!may(identity_, needed)) {
    const std::string role = needed == v1::ROLE_ENGINEER ? "engineer" : "operator";
    return refuse(id, refusal(client::ErrorCode::NotAllowed, "this command requires the role " + role, "log in as a user with this role"));
  }
  if (commands_under_way_ == kMostCommandsUnderWay) {
    return refuse(id,
                  refusal(client::ErrorCode::LimitExceeded, "too many commands at once", "wait for the pending answers, then try again"));
  }
  ++commands_under_way_;
  request.set_request_id(command_id(identity_.user, id));
  // For a user without a login the daemon itself sets "local"; the browser's own value is ignored.
  request.set_on_behalf_of(identity_.user == kLocalUser ? std::string() : identity_.user);
  commands_->submit(std::move(request), [self = std::weak_ptr(self_), id](client::Result<v1::Response> answer) {
    const auto tab = self.lock();
    if (!tab) return;
    --(*tab)->commands_under_way_;
    if (!answer) return (*tab)->refuse(id, answer.error());
    answer->set_request_id(id);
    v1::FromGateway message;
    *message.mutable_response() = std::move(*answer);
    (*tab)->send(message);
  });
}

void HubTab::refuse(const std::string& request_id, const client::Error& error) {
  v1::FromGateway message;
  v1::Response& response = *message.mutable_response();
  response.set_request_id(short_id(request_id));
  response.mutable_error()->set_code(static_cast<v1::ErrorCode>(error.code));
  response.mutable_error()->set_what(error.what);
  response.mutable_error()->set_hint(error.hint);
  send(message);
}

/// Sets the timer for the next frame.
void HubTab::arm() {
  if (is_armed_) return;
  auto due = queue_.due();
  if (!due) return;
  if (connection_.unsent_bytes() > kMostUnsentBytes) due = std::max(*due, Clock::now() + kSlowNetworkPause);
  is_armed_ = true;
  timer_.expires_at(*due);
  timer_.async_wait([self = std::weak_ptr(self_)](const boost::system::error_code& error) {
    const auto tab = self.lock();
    if (error || !tab) return;
    HubTab& me = **tab;
    me.is_armed_ = false;
    if (me.connection_.unsent_bytes() <= kMostUnsentBytes && me.queue_.due()) me.connection_.send(me.queue_.take_frame(Clock::now()));
    me.arm();
  });
}

void HubTab::send(const v1::FromGateway& message) { connection_.send(message.SerializeAsString()); }

}  // namespace dts::gateway
