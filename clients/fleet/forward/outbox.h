// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "core/log.h"
#include "fleet/forward/clinic.h"
#include "fleet/forward/store.h"

namespace dts::fleet::forward {

/// Compares dtsd's sessions with the store: what is new or changed must be sent, what dtsd has erased must be erased at the centre.
///
/// A session counts as erased only if complete lists of dtsd lack it, dtsd does not know its ID, and dtsd's audit trail proves it: it has
/// the entry that was the newest when it was last read, it reaches back to the time when dtsd last listed the session, and the erasures
/// since then removed at least as many sessions as are missing. So neither a silent daemon, nor a list that was cut, nor an empty
/// catalogue looks like an erasure, nor a catalogue from a backup in which an erasure is repeated. Thread: one.
class Outbox {
 public:
  Outbox(Clinic& clinic, Store& store, wire::SendRules rules, core::Log log)
      : clinic_(clinic), store_(store), rules_(std::move(rules)), log_(std::move(log)) {}

  /// Looks at the newest sessions only: something has just happened. `utc_ns`: now. Fails if dtsd or the store does not answer; what was
  /// found before stays.
  [[nodiscard]] core::Status look(std::int64_t utc_ns, const std::stop_token& stop);
  /// Looks at all sessions, and for erasures.
  [[nodiscard]] core::Status look_at_all(std::int64_t utc_ns, const std::stop_token& stop);

 private:
  [[nodiscard]] core::Status put_changed(const v1::ListSessionsResponse& list, std::int64_t utc_ns, const std::stop_token& stop);
  [[nodiscard]] core::Status add_unlisted(std::vector<std::string>& ids, std::int64_t utc_ns, const std::stop_token& stop);
  [[nodiscard]] core::Status look_for_erasures(const std::vector<MissingSession>& missing, std::int64_t utc_ns);
  [[nodiscard]] core::Status explain(const std::vector<MissingSession>& missing, const v1::GetAuditResponse& trail);
  [[nodiscard]] core::Status note_newest_audit(const v1::GetAuditResponse& trail);

  Clinic& clinic_;
  Store& store_;
  wire::SendRules rules_;
  core::Log log_;
  std::map<std::string, std::int64_t> unexplained_;  ///< Missing sessions that no erasure explained.
  std::int64_t completed_utc_ns_ = 0;                ///< When a list that was cut was last completed.
  std::int64_t asked_utc_ns_ = 0;                    ///< When the audit trail was read.
};

}  // namespace dts::fleet::forward
