// SPDX-License-Identifier: Apache-2.0
#include "lsl/session_marks.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace dts::lsl {

core::Result<SessionMarks> SessionMarks::open(const std::string& control_endpoint, std::string rig, core::Log log) {
  auto control = client::ControlClient::open({.endpoint = control_endpoint, .timeout = {}, .key = {}});
  if (!control) {
    return core::fail(static_cast<core::ErrorCode>(control.error().code), control.error().what, control.error().hint);
  }
  return SessionMarks(std::move(*control), std::move(rig), std::move(log));
}

void SessionMarks::set(const ReceivedMarker& marker, const std::stop_token& stop) {
  v1::Request request;
  request.set_request_id(request_id(marker));
  request.set_on_behalf_of("lsl");  // the audit trail then has "local:lsl"
  request.mutable_mark()->set_text(marker.text);
  request.mutable_mark()->set_rig(rig_);
  request.mutable_mark()->set_host_time_ns(marker.host_time_ns);
  const auto answer = control_.forward(request, stop);
  const bool is_early = answer && std::ranges::any_of(answer->mark().marks(), &v1::MarkResponse::At::is_before_session);
  if ((answer && !is_early) || stop.stop_requested() || !reports_.take(std::chrono::steady_clock::now())) return;
  if (is_early) {
    log_.warning("a marker of the LSL stream " + marker.stream_name + " is not recorded: its time is before the session began");
    return;
  }
  const client::Error& error = answer.error();
  log_.warning("a marker of the LSL stream " + marker.stream_name + " is not in the session: " + error.what +
               (error.hint.empty() ? "" : " (" + error.hint + ")"));
}

}  // namespace dts::lsl
