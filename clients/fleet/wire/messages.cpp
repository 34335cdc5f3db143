// SPDX-License-Identifier: Apache-2.0
#include "fleet/wire/messages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <tuple>

#include "core/utf8.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::wire {
namespace {

constexpr std::size_t kLongestId = 100;     // of a session, a rig, a calibration
constexpr std::size_t kLongestWord = 200;   // a name of a protocol, a condition, a measure, a version
constexpr std::size_t kLongestText = 1000;  // notes and reasons: dtsd's limit
constexpr std::uint32_t kLongestWaitS = 300;
constexpr std::uint32_t kLongestLeaseS = 60;
constexpr std::uint32_t kLargestNumber = 1'000'000;  // of a part, a trial, an attempt
constexpr int kMostRigs = 64;
constexpr int kMostTopics = 64;
// Of a session. dtsd runs at most 10,000 trials, each at most twice, and stores at most 10,000 results.
constexpr int kMostParts = 1000;
constexpr int kMostTrials = 20'000;
constexpr int kMostResults = 10'000;
constexpr int kMostFields = 100;
constexpr std::uint64_t kLargestCount = std::numeric_limits<std::int64_t>::max();  // PostgreSQL has no unsigned numbers

tl::unexpected<core::Error> wrong(const char* message, const std::string& field) {
  return core::fail(core::ErrorCode::DataDamaged, std::string(message) + ": field '" + field + "' is invalid");
}

/// Collects the first wrong field of a message.
class Check {
 public:
  explicit Check(const char* message) : message_(message) {}

  Check& that(bool is_sound, const char* field) {
    if (!is_sound && field_.empty()) field_ = field;
    return *this;
  }
  Check& text(const std::string& text, const char* field, std::size_t most, std::size_t least = 0, bool has_lines = false) {
    const auto is_control = [has_lines](char letter) {
      const auto code = static_cast<unsigned char>(letter);
      return (code < 0x20U && !(has_lines && (letter == '\n' || letter == '\t'))) || code == 0x7FU;
    };
    return that(text.size() >= least && text.size() <= most && core::is_utf8(text) && std::ranges::none_of(text, is_control), field);
  }
  Check& word(const std::string& word, const char* field, std::size_t least = 0) { return text(word, field, kLongestWord, least); }
  /// `least` is 0 if there may be none.
  Check& id(const std::string& id, const char* field, std::size_t least = 1) {
    const auto is_letter = [](char letter) {
      return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') ||
             std::string_view("._-").find(letter) != std::string_view::npos;
    };
    return that(id.size() >= least && id.size() <= kLongestId && std::ranges::all_of(id, is_letter), field);
  }
  Check& sha256(const std::string& bytes, const char* field) { return that(bytes.size() == kSha256Bytes, field); }
  Check& optional_sha256(const std::string& bytes, const char* field) { return that(bytes.empty() || bytes.size() == kSha256Bytes, field); }
  Check& count(std::uint64_t value, const char* field, std::uint64_t largest = kLargestCount, std::uint64_t least = 0) {
    return that(value >= least && value <= largest, field);
  }
  Check& not_negative(double value, const char* field) { return that(std::isfinite(value) && value >= 0.0, field); }
  Check& utc(std::int64_t utc_ns, const char* field) { return that(utc_ns >= 0, field); }

  [[nodiscard]] core::Status status() const {
    if (field_.empty()) return {};
    return wrong(message_, field_);
  }

 private:
  const char* message_;
  std::string field_;
};

template <class Message>
core::Result<Message> parsed(std::string_view bytes, const char* name) {
  Message message;
  if (bytes.size() > kLargestMessage || !message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return core::fail(core::ErrorCode::DataDamaged, std::string(name) + ": the bytes are not such a message");
  }
  return message;
}

template <class Message>
core::Result<Message> checked(Message message, const Check& check) {
  DTS_TRY(check.status());
  return message;
}

bool is_outcome(const std::string& word) { return word == "done" || word == "redone" || word == "rejected" || word == "aborted"; }

bool is_session_state(const std::string& word) {
  static const std::set<std::string> kStates = {"running", "complete", "recovered", "incomplete", "interrupted", "aborted"};
  return kStates.contains(word);
}

void check_later(Check& check, const v1::Later& later) {
  check.text(later.reason(), "later.reason", kLongestText).count(later.wait_s(), "later.wait_s", kLongestWaitS, 1);
}

void check_refusal(Check& check, const v1::Refusal& refusal) { check.text(refusal.reason(), "refusal.reason", kLongestText); }

void check_parts(Check& check, const v1::FleetSession& session) {
  std::set<std::uint32_t> numbers;
  std::set<std::string> sums;
  for (const auto& part : session.parts()) {
    check.count(part.part(), "parts.part", kLargestNumber, 1).that(numbers.insert(part.part()).second, "parts.part");
    check.that(v1::PartState_IsValid(part.state()), "parts.state").optional_sha256(part.sha256(), "parts.sha256");
    check.that(part.sha256().empty() || sums.insert(part.sha256()).second, "parts.sha256");
    check.optional_sha256(part.recorded_sha256(), "parts.recorded_sha256").count(part.bytes(), "parts.bytes", kLargestFile);
    check.count(part.scans(), "parts.scans").not_negative(part.duration_s(), "parts.duration_s");
    check.count(part.lost_scans(), "parts.lost_scans").count(part.valid_trials(), "parts.valid_trials", kLargestNumber);
    check.id(part.rig(), "parts.rig", 0).count(part.leading_part(), "parts.leading_part", kLargestNumber);
  }
}

void check_trials(Check& check, const v1::FleetSession& session) {
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> keys;
  for (const auto& trial : session.trials()) {
    check.count(trial.part(), "trials.part", kLargestNumber, 1).count(trial.trial(), "trials.trial", kLargestNumber, 1);
    check.count(trial.attempt(), "trials.attempt", kLargestNumber, 1).count(trial.block(), "trials.block", kLargestNumber);
    check.that(keys.emplace(trial.part(), trial.trial(), trial.attempt()).second, "trials.attempt");
    check.word(trial.condition(), "trials.condition").that(is_outcome(trial.outcome()), "trials.outcome");
    check.that(trial.recorded_outcome().empty() || is_outcome(trial.recorded_outcome()), "trials.recorded_outcome");
    check.that(v1::TrialFault_IsValid(trial.fault()), "trials.fault");
  }
}

void check_results(Check& check, const v1::FleetSession& session) {
  std::set<std::string> names;
  for (const auto& result : session.results()) {
    check.word(result.name(), "results.name", 1).that(names.insert(result.name()).second, "results.name");
    check.that(std::isfinite(result.value()), "results.value").word(result.unit(), "results.unit");
  }
}

void check_rig(Check& check, const v1::RigBeat& rig) {
  check.id(rig.rig(), "rigs.rig").word(rig.kind(), "rigs.kind").that(v1::DeviceState_IsValid(rig.device()), "rigs.device");
  check.not_negative(rig.nominal_rate_hz(), "rigs.nominal_rate_hz").not_negative(rig.measured_rate_hz(), "rigs.measured_rate_hz");
  check.count(rig.scans_total(), "rigs.scans_total").count(rig.lost_scans_total(), "rigs.lost_scans_total");
  check.count(rig.gaps_total(), "rigs.gaps_total").that(v1::SessionState_IsValid(rig.session()), "rigs.session");
  check.id(rig.session_id(), "rigs.session_id", 0).word(rig.calibration(), "rigs.calibration");
  check.count(rig.sensors(), "rigs.sensors", 1000).that(rig.streams_size() <= kMostTopics, "rigs.streams");
  for (const auto& stream : rig.streams()) check.id(stream, "rigs.streams");
}

}  // namespace

core::Result<v1::UploadOffer> decode_offer(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto offer, parsed<v1::UploadOffer>(bytes, "UploadOffer"));
  Check check("UploadOffer");
  check.sha256(offer.sha256(), "sha256").count(offer.bytes(), "bytes", kLargestFile, 1);
  check.id(offer.session_id(), "session_id").count(offer.part(), "part", kLargestNumber, 1);
  return checked(std::move(offer), check);
}

core::Result<v1::UploadChunk> decode_chunk(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto chunk, parsed<v1::UploadChunk>(bytes, "UploadChunk"));
  Check check("UploadChunk");
  check.sha256(chunk.sha256(), "sha256").count(chunk.offset(), "offset", kLargestFile).count(chunk.data().size(), "data", kLargestChunk, 1);
  return checked(std::move(chunk), check);
}

core::Result<v1::UploadCommit> decode_commit(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto commit, parsed<v1::UploadCommit>(bytes, "UploadCommit"));
  return checked(std::move(commit), Check("UploadCommit").sha256(commit.sha256(), "sha256"));
}

core::Result<v1::UploadAnswer> decode_upload_answer(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto answer, parsed<v1::UploadAnswer>(bytes, "UploadAnswer"));
  Check check("UploadAnswer");
  switch (answer.answer_case()) {
    case v1::UploadAnswer::kStored:
      check.that(is_clinic_name(answer.stored().clinic()), "stored.clinic").sha256(answer.stored().sha256(), "stored.sha256");
      check.count(answer.stored().bytes(), "stored.bytes", kLargestFile, 1).utc(answer.stored().stored_utc_ns(), "stored.stored_utc_ns");
      check.that(is_worker_name(answer.stored().hub()), "stored.hub");
      break;
    case v1::UploadAnswer::kUpload:
      check.that(is_worker_name(answer.upload().worker()), "upload.worker").count(answer.upload().have(), "upload.have", kLargestFile);
      break;
    case v1::UploadAnswer::kLater: check_later(check, answer.later()); break;
    case v1::UploadAnswer::kRefusal: check_refusal(check, answer.refusal()); break;
    case v1::UploadAnswer::ANSWER_NOT_SET: check.that(false, "answer"); break;
  }
  return checked(std::move(answer), check);
}

core::Result<v1::FleetSession> decode_session(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto session, parsed<v1::FleetSession>(bytes, "FleetSession"));
  Check check("FleetSession");
  check.id(session.session_id(), "session_id").count(session.revision(), "revision", kLargestCount, 1).id(session.rig(), "rig", 0);
  check.word(session.protocol(), "protocol").word(session.subject(), "subject").that(is_session_state(session.state()), "state");
  check.utc(session.started_utc_ns(), "started_utc_ns").utc(session.ended_utc_ns(), "ended_utc_ns");
  check.count(session.planned_trials(), "planned_trials", kLargestNumber);
  check.word(session.label(), "label").text(session.notes(), "notes", kLongestText, 0, true);
  check.that(static_cast<int>(session.fields().size()) <= kMostFields, "fields").that(session.parts_size() <= kMostParts, "parts");
  check.that(session.trials_size() <= kMostTrials, "trials").that(session.results_size() <= kMostResults, "results");
  DTS_TRY(check.status());  // before the time that the rows need
  for (const auto& [name, value] : session.fields()) check.word(name, "fields", 1).word(value, "fields");
  check_parts(check, session);
  check_trials(check, session);
  check_results(check, session);
  return checked(std::move(session), check);
}

core::Result<v1::FactsAnswer> decode_facts_answer(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto answer, parsed<v1::FactsAnswer>(bytes, "FactsAnswer"));
  Check check("FactsAnswer");
  switch (answer.answer_case()) {
    case v1::FactsAnswer::kRevision: check.count(answer.revision(), "revision"); break;
    case v1::FactsAnswer::kLater: check_later(check, answer.later()); break;
    case v1::FactsAnswer::kRefusal: check_refusal(check, answer.refusal()); break;
    case v1::FactsAnswer::ANSWER_NOT_SET: check.that(false, "answer"); break;
  }
  return checked(std::move(answer), check);
}

core::Result<v1::EraseSession> decode_erase(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto erase, parsed<v1::EraseSession>(bytes, "EraseSession"));
  return checked(std::move(erase), Check("EraseSession").id(erase.session_id(), "session_id"));
}

core::Result<v1::EraseAnswer> decode_erase_answer(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto answer, parsed<v1::EraseAnswer>(bytes, "EraseAnswer"));
  Check check("EraseAnswer");
  switch (answer.answer_case()) {
    case v1::EraseAnswer::kFiles: break;
    case v1::EraseAnswer::kLater: check_later(check, answer.later()); break;
    case v1::EraseAnswer::kRefusal: check_refusal(check, answer.refusal()); break;
    case v1::EraseAnswer::ANSWER_NOT_SET: check.that(false, "answer"); break;
  }
  return checked(std::move(answer), check);
}

core::Result<v1::Beat> decode_beat(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto beat, parsed<v1::Beat>(bytes, "Beat"));
  Check check("Beat");
  check.utc(beat.utc_ns(), "utc_ns").word(beat.forwarder_version(), "forwarder_version").word(beat.daemon_version(), "daemon_version");
  check.that(beat.rigs_size() <= kMostRigs, "rigs");
  std::set<std::string> names;
  for (const auto& rig : beat.rigs()) {
    check_rig(check, rig);
    check.that(names.insert(rig.rig()).second, "rigs.rig");
  }
  check.that(v1::DiskState_IsValid(beat.disk().state()), "disk.state").count(beat.disk().free_bytes(), "disk.free_bytes");
  check.not_negative(beat.disk().recordable_s(), "disk.recordable_s").count(beat.backlog().bytes(), "backlog.bytes");
  check.utc(beat.backlog().oldest_utc_ns(), "backlog.oldest_utc_ns");
  check.utc(beat.backlog().last_receipt_utc_ns(), "backlog.last_receipt_utc_ns");
  return checked(std::move(beat), check);
}

core::Result<v1::BeatAnswer> decode_beat_answer(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto answer, parsed<v1::BeatAnswer>(bytes, "BeatAnswer"));
  Check check("BeatAnswer");
  check.utc(answer.utc_ns(), "utc_ns").that(is_worker_name(answer.hub()), "hub").optional_sha256(answer.audit_head(), "audit_head");
  return checked(std::move(answer), check);
}

core::Result<v1::LiveRequest> decode_live_request(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto request, parsed<v1::LiveRequest>(bytes, "LiveRequest"));
  Check check("LiveRequest");
  check.that(request.topics_size() >= 1 && request.topics_size() <= kMostTopics, "topics").word(request.who(), "who", 1);
  for (const auto& topic : request.topics()) check.word(topic, "topics", 1);
  return checked(std::move(request), check);
}

core::Result<v1::LiveAnswer> decode_live_answer(std::string_view bytes) {
  DTS_TRY_ASSIGN(auto answer, parsed<v1::LiveAnswer>(bytes, "LiveAnswer"));
  Check check("LiveAnswer");
  switch (answer.answer_case()) {
    case v1::LiveAnswer::kLeaseS: check.count(answer.lease_s(), "lease_s", kLongestLeaseS, 1); break;
    case v1::LiveAnswer::kRefusal: check_refusal(check, answer.refusal()); break;
    case v1::LiveAnswer::ANSWER_NOT_SET: check.that(false, "answer"); break;
  }
  return checked(std::move(answer), check);
}

std::string hex_of(std::string_view sha256) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * sha256.size());
  for (const char byte : sha256) {
    const auto value = static_cast<unsigned char>(byte);
    text += kDigits[value >> 4U];
    text += kDigits[value & 0xFU];
  }
  return text;
}

core::Result<std::string> bytes_of_hex(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string bytes;
  for (std::size_t index = 0; index + 1 < text.size(); index += 2) {
    const auto high = kDigits.find(text[index]);
    const auto low = kDigits.find(text[index + 1]);
    if (high == std::string_view::npos || low == std::string_view::npos) break;
    bytes += static_cast<char>(16 * high + low);
  }
  if (text.size() == 2 * kSha256Bytes && bytes.size() == kSha256Bytes) return bytes;
  return core::fail(core::ErrorCode::InvalidArgument, "a SHA-256 has 64 hexadecimal digits in lower case");
}

}  // namespace dts::fleet::wire
