// SPDX-License-Identifier: Apache-2.0
#include "fleet/wire/messages.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace dts::fleet::wire {
namespace {

const std::string kSum(kSha256Bytes, 's');

v1::FleetSession session() {
  v1::FleetSession session;
  session.set_session_id("20261121T144525Z-floor-1");
  session.set_revision(1);
  session.set_rig("AZaz09._-");  // the ends of what an ID may have
  session.set_protocol("romberg");
  session.set_state("complete");
  auto& part = *session.add_parts();
  part.set_part(1);
  part.set_state(v1::PART_STATE_COMPLETE);
  part.set_sha256(kSum);
  auto& trial = *session.add_trials();
  trial.set_part(1);
  trial.set_trial(1);
  trial.set_attempt(1);
  trial.set_outcome("done");
  session.add_results()->set_name("MVELO");
  return session;
}

v1::Beat beat() {
  v1::Beat beat;
  beat.add_rigs()->set_rig("floor");
  return beat;
}

v1::UploadOffer offer() {
  v1::UploadOffer offer;
  offer.set_sha256(kSum);
  offer.set_bytes(1);
  offer.set_session_id("s1");
  offer.set_part(1);
  return offer;
}

/// A change of a sound message, and the field that the error must name.
template <class Message>
using Twin = std::pair<std::string, std::function<void(Message&)>>;

template <class Message, class Decode>
void expect_rejected(const Message& sound, Decode decode, const std::vector<Twin<Message>>& twins) {
  ASSERT_TRUE(decode(sound.SerializeAsString()));
  for (const auto& [field, change] : twins) {
    Message twin = sound;
    change(twin);
    const auto decoded = decode(twin.SerializeAsString());
    ASSERT_FALSE(decoded) << field;
    EXPECT_EQ(decoded.error().code, core::ErrorCode::DataDamaged);
    EXPECT_NE(decoded.error().what.find("'" + field + "'"), std::string::npos) << decoded.error().what;
  }
}

TEST(Messages, Offer_WithAWrongField_IsRejected) {
  using M = v1::UploadOffer;
  expect_rejected<M>(offer(), decode_offer,
                     {{"sha256", [](M& m) { m.set_sha256("short"); }},
                      {"bytes", [](M& m) { m.set_bytes(0); }},
                      {"bytes", [](M& m) { m.set_bytes(kLargestFile + 1); }},
                      {"session_id", [](M& m) { m.set_session_id("../x"); }},
                      {"session_id", [](M& m) { m.clear_session_id(); }},
                      {"part", [](M& m) { m.set_part(0); }}});
}

TEST(Messages, Chunk_WithAWrongField_IsRejected) {
  using M = v1::UploadChunk;
  M chunk;
  chunk.set_sha256(kSum);
  chunk.set_data(std::string(kLargestChunk, 'x'));
  expect_rejected<M>(chunk, decode_chunk,
                     {{"sha256", [](M& m) { m.clear_sha256(); }},
                      {"offset", [](M& m) { m.set_offset(std::numeric_limits<std::uint64_t>::max()); }},
                      {"data", [](M& m) { m.clear_data(); }},
                      {"data", [](M& m) { m.mutable_data()->push_back('x'); }}});
}

/// Adds `count` rows that differ in what `number` changes.
template <class Row, class Number>
void add_many(google::protobuf::RepeatedPtrField<Row>& rows, int count, Number number) {
  const Row first = rows.at(0);
  for (int row = 0; row < count; ++row) number(*rows.Add() = first, row);
}

TEST(Messages, Session_WithAWrongField_IsRejected) {
  using M = v1::FleetSession;
  expect_rejected<M>(
      session(), decode_session,
      {{"revision", [](M& m) { m.set_revision(0); }},
       {"revision", [](M& m) { m.set_revision(std::numeric_limits<std::uint64_t>::max()); }},
       {"rig", [](M& m) { m.set_rig("a b"); }},
       {"protocol", [](M& m) { m.set_protocol(std::string("a\0b", 3)); }},
       {"subject", [](M& m) { m.set_subject(std::string(201, 'x')); }},
       {"state", [](M& m) { m.set_state("finished"); }},
       {"started_utc_ns", [](M& m) { m.set_started_utc_ns(-1); }},
       {"notes", [](M& m) { m.set_notes(std::string(1001, 'x')); }},
       {"label", [](M& m) { m.set_label("two\nlines"); }},
       {"fields", [](M& m) { (*m.mutable_fields())["a"] = "\x1b"; }},
       {"fields",
        [](M& m) {
          for (int number = 0; number <= 100; ++number) (*m.mutable_fields())["f" + std::to_string(number)] = "1";
        }},
       {"parts", [](M& m) { add_many(*m.mutable_parts(), 1000, [](auto& part, int n) { part.set_part(2U + static_cast<unsigned>(n)); }); }},
       {"trials",
        [](M& m) { add_many(*m.mutable_trials(), 20'000, [](auto& trial, int n) { trial.set_trial(2U + static_cast<unsigned>(n)); }); }},
       {"results",
        [](M& m) { add_many(*m.mutable_results(), 10'000, [](auto& result, int n) { result.set_name("r" + std::to_string(n)); }); }},
       {"parts.part", [](M& m) { *m.add_parts() = m.parts(0); }},
       {"parts.state", [](M& m) { m.mutable_parts(0)->set_state(static_cast<v1::PartState>(77)); }},
       {"parts.sha256", [](M& m) { m.mutable_parts(0)->set_sha256("x"); }},
       {"parts.duration_s", [](M& m) { m.mutable_parts(0)->set_duration_s(std::numeric_limits<double>::quiet_NaN()); }},
       {"trials.attempt", [](M& m) { *m.add_trials() = m.trials(0); }},
       {"trials.outcome", [](M& m) { m.mutable_trials(0)->clear_outcome(); }},
       {"trials.fault", [](M& m) { m.mutable_trials(0)->set_fault(static_cast<v1::TrialFault>(-1)); }},
       {"results.name", [](M& m) { *m.add_results() = m.results(0); }},
       {"results.value", [](M& m) { m.mutable_results(0)->set_value(std::numeric_limits<double>::infinity()); }}});
  auto lines = session();
  lines.set_notes("two\nlines");
  EXPECT_TRUE(decode_session(lines.SerializeAsString()));
}

TEST(Messages, Beat_WithAWrongField_IsRejected) {
  using M = v1::Beat;
  expect_rejected<M>(beat(), decode_beat,
                     {{"rigs.rig", [](M& m) { *m.add_rigs() = m.rigs(0); }},
                      {"rigs.device", [](M& m) { m.mutable_rigs(0)->set_device(static_cast<v1::DeviceState>(99)); }},
                      {"rigs.session", [](M& m) { m.mutable_rigs(0)->set_session(static_cast<v1::SessionState>(99)); }},
                      {"rigs.streams", [](M& m) { m.mutable_rigs(0)->add_streams("a,b"); }},
                      {"rigs.measured_rate_hz", [](M& m) { m.mutable_rigs(0)->set_measured_rate_hz(-1.0); }},
                      {"disk.state", [](M& m) { m.mutable_disk()->set_state(static_cast<v1::DiskState>(99)); }},
                      {"backlog.bytes", [](M& m) { m.mutable_backlog()->set_bytes(std::numeric_limits<std::uint64_t>::max()); }},
                      {"daemon_version", [](M& m) { m.set_daemon_version("\n"); }}});
}

TEST(Messages, Answers_WithAWrongField_AreRejected) {
  using M = v1::UploadAnswer;
  M stored;
  stored.mutable_stored()->set_clinic("kent");
  stored.mutable_stored()->set_sha256(kSum);
  stored.mutable_stored()->set_bytes(1);
  stored.mutable_stored()->set_hub("hub-1");
  expect_rejected<M>(stored, decode_upload_answer,
                     {{"answer", [](M& m) { m.clear_answer(); }},
                      {"stored.clinic", [](M& m) { m.mutable_stored()->set_clinic("Kent"); }},
                      {"stored.sha256", [](M& m) { m.mutable_stored()->clear_sha256(); }},
                      {"upload.worker", [](M& m) { m.mutable_upload()->set_worker("a.b"); }},
                      {"later.wait_s", [](M& m) { m.mutable_later()->set_wait_s(301); }},
                      {"later.wait_s", [](M& m) { m.mutable_later()->set_wait_s(0); }},
                      {"refusal.reason", [](M& m) { m.mutable_refusal()->set_reason(std::string(1001, 'x')); }}});
  EXPECT_FALSE(decode_facts_answer(""));
  EXPECT_FALSE(decode_erase_answer(""));
  EXPECT_FALSE(decode_live_answer(""));
  v1::BeatAnswer beaten;
  beaten.set_hub("hub-1");
  EXPECT_TRUE(decode_beat_answer(beaten.SerializeAsString()));
  beaten.set_audit_head("x");
  EXPECT_FALSE(decode_beat_answer(beaten.SerializeAsString()));
}

TEST(Messages, LiveRequest_NeedsTopicsAndAUser) {
  v1::LiveRequest request;
  request.add_topics("floor/cop");
  EXPECT_FALSE(decode_live_request(request.SerializeAsString()));
  request.set_who("anna");
  EXPECT_TRUE(decode_live_request(request.SerializeAsString()));
  request.clear_topics();
  EXPECT_FALSE(decode_live_request(request.SerializeAsString()));
}

TEST(Messages, UnknownFields_AreKept) {
  auto message = offer().SerializeAsString();
  message += std::string("\xf8\x07\x01", 3);  // field 127, a number
  EXPECT_EQ(decode_offer(message)->SerializeAsString().size(), message.size());
}

TEST(Messages, TooLongOrTorn_IsRejected) {
  EXPECT_FALSE(decode_session(std::string(kLargestMessage + 1, '\n')));
  const auto whole = session().SerializeAsString();
  EXPECT_FALSE(decode_session(std::string_view(whole).substr(0, whole.size() - 1)));
}

TEST(Messages, Hex_IsItsOwnReverse) {
  const std::string text = "00ff" + std::string(60, 'a');
  ASSERT_TRUE(bytes_of_hex(text));
  EXPECT_EQ(bytes_of_hex(text)->substr(0, 2), std::string("\0\xff", 2));
  EXPECT_EQ(hex_of(*bytes_of_hex(text)), text);
  for (const std::string& wrong :
       {std::string(63, 'a'), std::string(66, 'a'), std::string(64, 'A'), std::string(63, 'a') + "g", std::string()}) {
    EXPECT_FALSE(bytes_of_hex(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace dts::fleet::wire
