// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "record/catalogue/catalogue.h"
#include "session/label_rule.h"

namespace dts::session {

/// What an operator wants to correct in a closed session. Absent values stay as they are.
struct CorrectionRequest {
  std::string session_id;
  std::optional<std::string> subject{};
  std::optional<std::string> label{};
  std::optional<std::string> notes{};
  std::uint32_t trial = 0;                   ///< 0: no outcome is corrected.
  std::uint32_t attempt = 0;                 ///< 0: the newest.
  std::uint32_t part = 0;                    ///< 0: the newest; with `attempt`, the only one that has it.
  std::string outcome{};                     ///< "done", "redone", "rejected", "aborted"
  std::uint32_t marker = 0;                  ///< Number within the session, from 1; 0: no marker is corrected.
  std::optional<std::string> marker_text{};  ///< Empty: the text is removed.
  std::string reason{};
};

/// Returns the corrections that the request means, without number, time and author; values that do not change are left out. Fails with
/// InvalidArgument for a value that is not allowed, for an attempt that several parts have, or if nothing would change, with NotFound for
/// an unknown trial or marker, and with WrongState if a trial cannot be done: it has no result, or another attempt of it is done.
[[nodiscard]] core::Result<std::vector<record::Correction>> corrections_for(const record::SessionRow& session,
                                                                            const CorrectionRequest& request, const LabelRule& rule);

/// Fails with InvalidArgument for an empty reason or one that does not follow the rule.
[[nodiscard]] core::Status check_reason(const std::string& reason, const LabelRule& rule);

}  // namespace dts::session
