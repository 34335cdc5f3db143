// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace dts::session {

/// Idle --start--> Starting --first scan--> Settling --settle_s--> Running --stop, duration--> Stopping --closed--> Idle
/// Starting --no scans for 10 s--> Stopping --closed--> Failed. The same happens if the recording fails. A lost device does not end a
/// running session: the session continues in the next segment.
enum class SessionState : std::uint8_t { Idle = 1, Starting, Settling, Running, Stopping, Failed };

[[nodiscard]] std::string_view name(SessionState state) noexcept;

/// The request of an operator. Checked by `check`, and against its protocol by `check_fields`.
struct SessionRequest {
  std::string protocol = "free";
  std::string subject;      ///< Subject ID assigned by the clinic: [A-Za-z0-9_.-], at most 64 characters; optional.
  std::string label;        ///< At most 200 bytes; `check_label` checks a new one.
  double duration_s = 0.0;  ///< 0: until stopped; at most 7 days, counted after settling.
  double settle_s = 0.0;    ///< 0..3600.
  std::vector<std::pair<std::string, std::string>> fields{};  ///< The protocol's fields about the subject.
};

/// Fails with InvalidArgument, naming the wrong field and its range.
[[nodiscard]] core::Status check(const SessionRequest& request);

struct SessionView {
  std::string id;  ///< Empty: no session yet.
  SessionState state = SessionState::Idle;
  SessionRequest request;
  double elapsed_s = 0.0;
  std::string message;
  std::vector<std::string> rigs{};  ///< Of a session over several rigs, the leading one first; empty: one rig.
};

/// The state machine of one rig's session. Uses only the times passed to it, so that tests need not wait. Thread: control.
class Session {
 public:
  explicit Session(std::string rig) : rig_(std::move(rig)) {}

  /// Fails with WrongState if a session is under way.
  [[nodiscard]] core::Status check_free() const;
  /// Starts a session with this ID. Fails with WrongState if one is under way. The request must have passed `check`.
  [[nodiscard]] core::Status start(std::string id, const SessionRequest& request, std::int64_t now_ns);
  /// Enters Stopping, in which the recording is closed. Fails with WrongState if no session is under way or it is already stopping.
  [[nodiscard]] core::Status stop(std::int64_t now_ns);
  /// Stops the session because of an error: it ends as Failed. No effect if no session is under way.
  void fail(std::int64_t now_ns, std::string message);
  /// Sets the message of a session under way: a rig of it is lost, or (empty) back.
  void report(std::int64_t now_ns, std::string message);
  /// Ends Stopping: the recording is closed.
  void closed(std::int64_t now_ns);
  /// Replaces subject ID and label of the last session, which has ended.
  void revise(std::string subject, std::string label, std::int64_t now_ns);
  /// Forgets the last session, which has ended.
  void forget(std::int64_t now_ns);
  /// Advances to `now_ns`; `scans_total` is the rig's counter (if it increases, the rig streams).
  void tick(std::int64_t now_ns, std::uint64_t scans_total);

  [[nodiscard]] bool is_under_way() const noexcept { return state_ != SessionState::Idle && state_ != SessionState::Failed; }
  [[nodiscard]] SessionView view(std::int64_t now_ns) const;
  /// Returns the states entered since the last call, oldest first; each becomes an event.
  [[nodiscard]] std::vector<SessionView> take_changes();

 private:
  void enter(SessionState state, std::int64_t now_ns, std::string message = {});

  std::string rig_;
  std::string id_;
  SessionState state_ = SessionState::Idle;
  SessionRequest request_;
  std::string message_;
  std::string failure_;  ///< Why the session will end as Failed; empty: it will not.
  std::int64_t entered_ns_ = 0;
  std::int64_t running_since_ns_ = 0;
  std::int64_t stopped_ns_ = 0;
  std::uint64_t scans_at_start_ = 0;
  bool has_scan_count_ = false;
  std::vector<SessionView> changes_;
};

}  // namespace dts::session
