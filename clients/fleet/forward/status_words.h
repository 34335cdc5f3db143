// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Names of the words that the running program stores for `dts-forward status`.
namespace dts::fleet::forward::words {

inline constexpr const char* kUpdated = "updated_utc_ns";  ///< When the words were stored.
inline constexpr const char* kLinkProblem = "link_problem";
inline constexpr const char* kOutboxProblem = "outbox_problem";  ///< Why dtsd could not be asked.
inline constexpr const char* kBeatProblem = "beat_problem";      ///< Why the last beat was not answered.
inline constexpr const char* kDeskProblem = "desk_problem";      ///< Why facts are not sent.
inline constexpr const char* kHub = "hub";
inline constexpr const char* kBeat = "beat_utc_ns";             ///< When the centre last answered a beat.
inline constexpr const char* kClockOffset = "clock_offset_ns";  ///< This clock minus the centre's.
inline constexpr const char* kAuditHead = "audit_head";
inline constexpr const char* kViewers = "viewers";
inline constexpr const char* kUploadSession = "upload_session";
inline constexpr const char* kUploadPart = "upload_part";
inline constexpr const char* kUploadBytes = "upload_bytes";
inline constexpr const char* kUploadHave = "upload_have";
inline constexpr const char* kUploadRate = "upload_bytes_per_s";
inline constexpr const char* kUploadProblem = "upload_problem";

}  // namespace dts::fleet::forward::words
