// SPDX-License-Identifier: Apache-2.0
#include "wire_check.h"

#include <cmath>
#include <limits>
#include <string>

#include "try.h"

namespace dts::client {
namespace {

constexpr int kMaxRigs = 64;
constexpr int kMaxStreams = 64;
constexpr int kMaxChannels = 256;
constexpr std::uint32_t kMaxScans = 65536;
constexpr int kMaxTexts = 1000;
constexpr int kMaxSessions = 10'000;  ///< Sessions of the catalogue; also entries of the audit trail.
constexpr int kMaxParts = 1000;
constexpr int kMaxTrials = 10'000;
constexpr int kMaxCorrections = 10'000;
constexpr int kMaxMarkers = 1'000'000;
constexpr std::size_t kLongestName = 64;
constexpr std::int64_t kMaxRateTerm = 1'000'000'000'000;

tl::unexpected<Error> damaged(const std::string& what) {
  return fail(ErrorCode::DataDamaged, "invalid answer of the daemon: " + what, "check that dtsd and this program have the same version");
}

Result<void> check_count(int count, int limit, const char* of_what) {
  if (count <= limit) return {};
  return damaged(std::to_string(count) + " " + of_what + ", more than the limit of " + std::to_string(limit));
}

/// Checks a duration or a length: never negative, never NaN.
Result<void> check_amount(double value, const std::string& of_what) {
  if (std::isfinite(value) && value >= 0.0) return {};
  return damaged(of_what + " is " + std::to_string(value));
}

template <class... Checks>
Result<void> first_failure(Checks&&... checks) {
  Result<void> all{};
  static_cast<void>(((all = std::forward<Checks>(checks)).has_value() && ...));
  return all;
}

bool is_name(const std::string& text) { return !text.empty() && text.size() <= kLongestName && text.find('/') == std::string::npos; }

Result<void> check_stream(const v1::StreamFormat& stream) {
  if (!is_name(stream.name())) return damaged("a stream has no valid name");
  if (!is_well_formed(stream.rate())) return damaged("stream '" + stream.name() + "' has an invalid rate");
  if (stream.channels_size() == 0) return damaged("stream '" + stream.name() + "' has no channels");
  return check_count(stream.channels_size(), kMaxChannels, "channels");
}

}  // namespace

bool is_well_formed(const v1::Rate& rate) noexcept {
  return rate.numerator() > 0 && rate.numerator() <= kMaxRateTerm && rate.denominator() > 0 && rate.denominator() <= kMaxRateTerm;
}

bool is_well_formed(const v1::StreamBlock& block) noexcept {
  if (block.instance_id() == 0 || !is_well_formed(block.rate())) return false;
  const std::uint64_t scans = block.scan_count();
  const std::uint64_t channels = block.channel_count();
  if (scans == 0 || scans > kMaxScans || channels == 0 || channels > static_cast<std::uint64_t>(kMaxChannels)) return false;
  if (static_cast<std::uint64_t>(block.values_size()) != scans * channels || block.quality().size() != channels) return false;
  return block.first_scan() <= std::numeric_limits<std::uint64_t>::max() - scans;
}

Result<void> check(const v1::RigInfo& rig) {
  if (!is_name(rig.name())) return damaged("a rig has no valid name");
  DTS_TRY(check_count(rig.sensors_size(), kMaxChannels, "sensors"));
  DTS_TRY(check_count(rig.streams_size(), kMaxStreams, "streams"));
  for (const v1::StreamFormat& stream : rig.streams()) {
    DTS_TRY(check_stream(stream));
  }
  return {};
}

Result<void> check(const v1::StatusSnapshot& status) {
  if (status.instance_id() == 0) return damaged("the instance ID is missing");
  DTS_TRY(check_count(status.rigs_size(), kMaxRigs, "rigs"));
  DTS_TRY(check_count(status.notices_size(), kMaxTexts, "notices"));
  for (const v1::RigStatus& rig : status.rigs()) {
    DTS_TRY(check(rig.rig()));
    DTS_TRY(check_count(rig.losses_size(), kMaxTexts, "causes of losses"));
    DTS_TRY(check_count(rig.latency().buckets_size(), kMaxTexts, "latency buckets"));
    if (!rig.session().has_trial()) continue;
    DTS_TRY(check(rig.session().trial()));
  }
  if (!v1::DiskState_IsValid(status.disk().state())) return damaged("the state of the disk is unknown");
  return check_amount(status.disk().recordable_s(), "the recordable time");
}

Result<void> check(const v1::ListRigsResponse& rigs) {
  DTS_TRY(check_count(rigs.rigs_size(), kMaxRigs, "rigs"));
  for (const v1::RigInfo& rig : rigs.rigs()) {
    DTS_TRY(check(rig));
  }
  return {};
}

Result<void> check(const v1::GetDevicesResponse& devices) {
  DTS_TRY(check_count(devices.devices_size(), kMaxTexts, "devices"));
  return check_count(devices.kinds_size(), kMaxTexts, "kinds of device");
}

Result<void> check(const v1::TestDeviceResponse& test) {
  DTS_TRY(check_count(test.checks_size(), kMaxTexts, "checks"));
  return check_count(test.channels_size(), kMaxChannels, "channels");
}

Result<void> check(const v1::SessionInfo& session) {
  if (session.session_id().empty()) return damaged("a session has no ID");
  DTS_TRY(check_count(session.rigs_size(), kMaxRigs, "rigs"));
  return session.has_trial() ? check(session.trial()) : Result<void>{};
}

Result<void> check(const v1::MarkResponse& mark) { return check_count(mark.marks_size(), kMaxRigs, "marks"); }

Result<void> check(const v1::TareResponse& tare) { return check_count(tare.baseline_size(), kMaxChannels, "sensors"); }

Result<void> check(const v1::TrialStatus& trial) {
  if (!v1::TrialPhase_IsValid(trial.phase())) return damaged("the phase of a trial is unknown");
  if (!v1::TrialOutcome_IsValid(trial.last_outcome())) return damaged("the outcome of a trial is unknown");
  if (!v1::TrialFault_IsValid(trial.last_fault())) return damaged("the fault of a trial is unknown");
  return first_failure(check_amount(trial.next_target_cm(), "a trial's target"),
                       check_amount(trial.next_target_percent(), "a trial's target"), check_amount(trial.remaining_s(), "a trial's time"),
                       check_amount(trial.settle_s(), "a trial's settling time"), check_amount(trial.duration_s(), "a trial's duration"),
                       check_amount(trial.target_cm(), "a trial's target"), check_amount(trial.target_percent(), "a trial's target"),
                       check_amount(trial.undo_s(), "a trial's time to undo"));
}

namespace {

Result<void> check(const v1::SessionPart& part) {
  if (part.state() == v1::PART_STATE_UNSPECIFIED || !v1::PartState_IsValid(part.state()))
    return damaged("the state of a recording is unknown");
  return first_failure(check_count(part.losses_size(), kMaxTexts, "causes of losses"),
                       check_amount(part.duration_s(), "the duration of a recording"),
                       check_amount(part.lost_s_at_most(), "the lost time of a recording"));
}

Result<void> check(const v1::ProtocolInfo& protocol) {
  if (!is_name(protocol.name())) return damaged("a protocol has no valid name");
  const std::string what = "of protocol '" + protocol.name() + "'";
  auto valid =
      first_failure(check_count(protocol.conditions_size(), kMaxTexts, ("conditions " + what).c_str()),
                    check_count(protocol.fields_size(), kMaxTexts, ("fields " + what).c_str()),
                    check_amount(protocol.settle_s(), "the settling time " + what),
                    check_amount(protocol.duration_s(), "the duration " + what), check_amount(protocol.length_s(), "the length " + what));
  for (const v1::ProtocolCondition& condition : protocol.conditions()) {
    if (!valid) break;
    valid = first_failure(check_amount(condition.settle_s(), "the settling time " + what),
                          check_amount(condition.duration_s(), "a duration " + what),
                          check_amount(condition.target_percent(), "a target " + what));
  }
  for (const v1::ProtocolField& field : protocol.fields()) {
    if (!valid) break;
    const bool is_range = std::isfinite(field.minimum()) && std::isfinite(field.maximum()) && field.minimum() <= field.maximum();
    valid = is_range ? check_count(field.choices_size(), kMaxTexts, "choices") : damaged("field '" + field.name() + "' has no valid range");
  }
  return valid;
}

}  // namespace

Result<void> check(const v1::SessionRecord& session) {
  if (session.session_id().empty()) return damaged("a session has no ID");
  auto valid = first_failure(
      check_count(session.parts_size(), kMaxParts, "parts"), check_count(session.trials_size(), kMaxTrials, "trials"),
      check_count(session.corrections_size(), kMaxCorrections, "corrections"), check_count(session.markers_size(), kMaxMarkers, "markers"));
  for (const v1::SessionPart& part : session.parts()) {
    if (valid) valid = check(part);
  }
  return valid;
}

Result<void> check(const v1::ListSessionsResponse& sessions) {
  auto valid = check_count(sessions.sessions_size(), kMaxSessions, "sessions");
  for (const v1::SessionRecord& session : sessions.sessions()) {
    if (valid) valid = check(session);
  }
  return valid;
}

Result<void> check(const v1::ListProtocolsResponse& protocols) {
  auto valid = check_count(protocols.protocols_size(), kMaxTexts, "protocols");
  for (const v1::ProtocolInfo& protocol : protocols.protocols()) {
    if (valid) valid = check(protocol);
  }
  return valid;
}

Result<void> check(const v1::GetAuditResponse& audit) { return check_count(audit.entries_size(), kMaxSessions, "entries"); }

Result<void> check(const v1::ListKeysResponse& keys) { return check_count(keys.keys_size(), kMaxSessions, "keys"); }

Result<void> check(const v1::ListSubjectsResponse& subjects) { return check_count(subjects.subjects_size(), kMaxSessions, "subjects"); }

Result<void> check(const v1::SubjectRecord& subject) {
  auto valid = first_failure(check_count(subject.sessions_size(), kMaxSessions, "sessions"),
                             check_count(subject.mentioning_sessions_size(), kMaxSessions, "sessions"),
                             check_count(subject.notes_size(), kMaxSessions, "notes"),
                             check_count(subject.plan_size(), kMaxSessions, "planned sessions"));
  for (const v1::SessionRecord& session : subject.sessions()) {
    if (valid) valid = check(session);
  }
  return valid;
}

Result<void> check(const v1::EraseSubjectResponse& erased) { return check_count(erased.left_size(), kMaxSessions, "notes"); }

Result<void> check(const v1::Response& response) {
  switch (response.result_case()) {
    case v1::Response::kStatus: return check(response.status());
    case v1::Response::kRigs: return check(response.rigs());
    case v1::Response::kSession: return check(response.session());
    case v1::Response::kMark: return check(response.mark());
    case v1::Response::kTare: return check(response.tare());
    case v1::Response::kDevices: return check(response.devices());
    case v1::Response::kDeviceTest: return check(response.device_test());
    case v1::Response::kSessions: return check(response.sessions());
    case v1::Response::kSessionRecord: return check(response.session_record());
    case v1::Response::kProtocols: return check(response.protocols());
    case v1::Response::kTrial: return check(response.trial());
    case v1::Response::kAudit: return check(response.audit());
    case v1::Response::kKeys: return check(response.keys());
    case v1::Response::kSubjects: return check(response.subjects());
    case v1::Response::kSubject: return check(response.subject());
    case v1::Response::kErased: return check(response.erased());
    case v1::Response::kNoteLogin:
    case v1::Response::kError:
    case v1::Response::RESULT_NOT_SET: break;
  }
  return {};
}

}  // namespace dts::client
