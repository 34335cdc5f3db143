// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/losses.h"
#include "dts/v1/control.pb.h"
#include "dts/v1/stream.pb.h"
#include "record/catalogue/catalogue.h"
#include "session/supervisor.h"

namespace dts::ipc {

/// Adds one entry for each reason that occurred.
void add_losses(const core::Losses& losses, google::protobuf::RepeatedPtrField<dts::v1::LossCount>& out);
[[nodiscard]] dts::v1::SessionInfo session_info(const std::string& rig, const session::SessionView& view);
[[nodiscard]] dts::v1::SessionState session_state(session::SessionState state);
[[nodiscard]] dts::v1::RecordingStatus recording_status(const session::RecordingView& view, std::uint32_t part);
[[nodiscard]] dts::v1::TrialStatus trial_status(const session::TrialView& view);
[[nodiscard]] dts::v1::ProtocolInfo protocol_info(const session::Protocol& protocol);
[[nodiscard]] dts::v1::SessionRecord session_record(const record::SessionRow& row, std::uint32_t planned_trials = 0);
/// Adds the protocol's fields about the subject. Reads them from the recordings, because the catalogue does not have them.
void add_fields(const record::SessionRow& row, dts::v1::SessionRecord& out);
/// Returns the session for a list: without the texts of its corrections, so that an answer stays small.
[[nodiscard]] dts::v1::SessionRecord listed_session(const record::SessionRow& row, std::uint32_t planned_trials);
[[nodiscard]] dts::v1::SubjectInfo subject_info(const record::SubjectRow& row);
/// Adds notes and plan of a subject. Each complete session of the subject does the oldest planned session of its protocol that was planned
/// before it started; if the protocol has trials (`planned_trials` of the session), only with a valid one.
void add_notes(const record::SubjectNotes& notes, const std::vector<record::SessionRow>& sessions,
               const std::function<std::uint32_t(const record::SessionRow&)>& planned_trials, dts::v1::SubjectRecord& out);
[[nodiscard]] dts::v1::SessionResult session_result(const record::ResultRow& row);
[[nodiscard]] dts::v1::AuditEntry audit_entry(const record::AuditEntry& entry);
[[nodiscard]] dts::v1::DiskStatus disk_status(const session::DiskView& view);

}  // namespace dts::ipc
