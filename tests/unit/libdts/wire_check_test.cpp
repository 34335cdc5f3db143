// SPDX-License-Identifier: Apache-2.0
#include "../clients/libdts/wire_check.h"

#include <limits>

#include "unit/libdts/fake_daemon.h"

namespace dts::client {
namespace {

/// What is wrong with an answer in protobuf's text format; empty: nothing.
std::string fault_of(const std::string& answer) {
  const auto checked = check(testing::from_text<v1::Response>(answer));
  if (checked) return "";
  const std::string begin = "invalid answer of the daemon: ";
  EXPECT_EQ(checked.error().code, ErrorCode::DataDamaged);
  EXPECT_EQ(checked.error().what.substr(0, begin.size()), begin);
  EXPECT_EQ(checked.error().hint, "check that dtsd and this program have the same version");
  return checked.error().what.substr(begin.size());
}

TEST(WireCheck, ListOfTheGreatestLength_IsAcceptedAndALongerOneIsRefused) {
  struct Row {
    std::string before;
    std::string element;
    int most;
    std::string after;
    std::string what;
  };
  const std::string rig = "rig { name: 'floor' } ";
  const std::string stream = "streams { name: 'cop' rate { numerator: 1 denominator: 1 } ";
  const std::vector<Row> rows{{"rigs { rigs { name: 'floor' " + stream, "channels { } ", 256, "} } }", "channels"},
                              {"rigs { rigs { name: 'floor' ", "sensors { } ", 256, "} }", "sensors"},
                              {"rigs { rigs { name: 'floor' ", stream + "channels { } } ", 64, "} }", "streams"},
                              {"rigs { ", "rigs { name: 'floor' } ", 64, "}", "rigs"},
                              {"status { instance_id: 7 ", "rigs { " + rig + "} ", 64, "}", "rigs"},
                              {"status { instance_id: 7 ", "notices: '' ", 1000, "}", "notices"},
                              {"status { instance_id: 7 rigs { " + rig, "losses { } ", 1000, "} }", "causes of losses"},
                              {"status { instance_id: 7 rigs { " + rig + "latency { ", "buckets { } ", 1000, "} } }", "latency buckets"},
                              {"devices { ", "devices { } ", 1000, "}", "devices"},
                              {"devices { ", "kinds: '' ", 1000, "}", "kinds of device"},
                              {"device_test { ", "checks { } ", 1000, "}", "checks"},
                              {"device_test { ", "channels { } ", 256, "}", "channels"},
                              {"mark { ", "marks { } ", 64, "}", "marks"},
                              {"tare { ", "baseline: 0 ", 256, "}", "sensors"},
                              {"session_record { session_id: 's' ", "parts { state: 2 } ", 1000, "}", "parts"},
                              {"session_record { session_id: 's' parts { state: 2 ", "losses { } ", 1000, "} }", "causes of losses"},
                              {"session_record { session_id: 's' ", "trials { } ", 10'000, "}", "trials"},
                              {"session_record { session_id: 's' ", "corrections { } ", 10'000, "}", "corrections"},
                              {"subjects { ", "subjects { } ", 10'000, "}", "subjects"},
                              {"subject { ", "sessions { session_id: 's' } ", 10'000, "}", "sessions"},
                              {"subject { ", "mentioning_sessions: '' ", 10'000, "}", "sessions"},
                              {"sessions { ", "sessions { session_id: 's' } ", 10'000, "}", "sessions"},
                              {"audit { ", "entries { } ", 10'000, "}", "entries"},
                              {"keys { ", "keys { } ", 10'000, "}", "keys"},
                              {"protocols { ", "protocols { name: 'free' } ", 1000, "}", "protocols"},
                              {"protocols { protocols { name: 'free' ", "conditions { } ", 1000, "} }", "conditions of protocol 'free'"},
                              {"protocols { protocols { name: 'free' ", "fields { } ", 1000, "} }", "fields of protocol 'free'"},
                              {"protocols { protocols { name: 'free' fields { ", "choices: '' ", 1000, "} } }", "choices"}};
  for (const Row& row : rows) {
    std::string elements;
    for (int count = 0; count < row.most; ++count) elements += row.element;
    EXPECT_EQ(fault_of(row.before + elements + row.after), "");
    EXPECT_EQ(fault_of(row.before + elements + row.element + row.after),
              std::to_string(row.most + 1) + " " + row.what + ", more than the limit of " + std::to_string(row.most));
  }
}

TEST(WireCheck, EachValue_IsAcceptedOrRefusedWithTheReason) {
  RecordProperty("requirement", "SEC-9");
  const std::string longest(64, 'x');
  const std::string rig = "rigs { rigs { name: 'floor' streams { name: 'cop' ";
  const std::string rate = "rate { numerator: 1 denominator: 1 } ";
  const std::string disk = "status { instance_id: 1 disk { ";
  const std::string trial = "status { instance_id: 1 rigs { rig { name: 'floor' } session { trial { ";
  const std::string part = "session_record { session_id: 's' parts { ";
  const std::string protocol = "protocols { protocols { name: 'a' } protocols { name: 'free' ";
  const std::vector<std::pair<std::string, std::string>> rows{
      {"error { }", ""},
      {"note_login { }", ""},
      {"status { }", "the instance ID is missing"},
      {"status { instance_id: 1 }", ""},
      {"status { instance_id: 1 rigs { rig { name: 'floor' } session { } } }", ""},
      {"status { instance_id: 1 rigs { } }", "a rig has no valid name"},
      {"rigs { rigs { name: '" + longest + "' } }", ""},
      {"rigs { rigs { name: '" + longest + "x' } }", "a rig has no valid name"},
      {"rigs { rigs { name: 'floor' } rigs { name: 'a/b' } }", "a rig has no valid name"},
      {"rigs { rigs { name: 'floor' streams { " + rate + "channels { } } } }", "a stream has no valid name"},
      {rig + "channels { } } } }", "stream 'cop' has an invalid rate"},
      {rig + rate + "} } }", "stream 'cop' has no channels"},
      {disk + "state: 4 recordable_s: 0 } }", ""},
      {disk + "state: 99 } }", "the state of the disk is unknown"},
      {disk + "recordable_s: -1 } }", "the recordable time is -1.000000"},
      {disk + "recordable_s: nan } }", "the recordable time is nan"},
      {disk + "recordable_s: inf } }", "the recordable time is inf"},
      {trial + "phase: 6 } } } }", ""},
      {trial + "phase: 7 } } } }", "the phase of a trial is unknown"},
      {"trial { phase: 7 }", "the phase of a trial is unknown"},
      {"trial { last_outcome: 4 last_fault: 4 }", ""},
      {"trial { last_outcome: 5 }", "the outcome of a trial is unknown"},
      {"trial { last_fault: 5 }", "the fault of a trial is unknown"},
      {"trial { next_target_cm: -1 }", "a trial's target is -1.000000"},
      {"trial { remaining_s: -1 }", "a trial's time is -1.000000"},
      {"session { }", "a session has no ID"},
      {"session { session_id: 's' }", ""},
      {"session { session_id: 's' trial { phase: 7 } }", "the phase of a trial is unknown"},
      {"session_record { }", "a session has no ID"},
      {"sessions { sessions { session_id: 's' } sessions { } sessions { session_id: 's' } }", "a session has no ID"},
      {part + "} }", "the state of a recording is unknown"},
      {part + "state: -1 } }", "the state of a recording is unknown"},
      {part + "state: 7 } }", "the state of a recording is unknown"},
      {part + "state: 6 } }", ""},
      {part + "state: 6 } parts { } parts { state: 6 } }", "the state of a recording is unknown"},
      {part + "state: 6 duration_s: nan } }", "the duration of a recording is nan"},
      {part + "state: 6 lost_s_at_most: -1 } }", "the lost time of a recording is -1.000000"},
      {"protocols { protocols { } protocols { name: 'free' } }", "a protocol has no valid name"},
      {protocol + "settle_s: -1 } protocols { name: 'b' } }", "the settling time of protocol 'free' is -1.000000"},
      {protocol + "duration_s: inf } }", "the duration of protocol 'free' is inf"},
      {protocol + "settle_s: 1 duration_s: 1 fields { minimum: -1 maximum: -1 } } }", ""},
      {protocol + "fields { } fields { name: 'age' minimum: 2 maximum: 1.9 } fields { } } }", "field 'age' has no valid range"},
      {protocol + "fields { name: 'age' minimum: nan } } }", "field 'age' has no valid range"},
      {protocol + "fields { name: 'age' minimum: -inf } } }", "field 'age' has no valid range"},
      {protocol + "fields { name: 'age' maximum: inf } } }", "field 'age' has no valid range"}};
  for (const auto& [answer, fault] : rows) EXPECT_EQ(fault_of(answer), fault) << answer;
}

TEST(WireCheck, BlockAtItsLimits_IsWellFormedAndNotBeyond) {
  const auto is_good = [](std::uint32_t scans, std::uint32_t channels, std::uint64_t first_scan, std::int64_t numerator = 100,
                          std::int64_t denominator = 1) {
    v1::StreamBlock block = testing::block(1, 0, scans, 1, channels);
    block.set_first_scan(first_scan);
    block.mutable_rate()->set_numerator(numerator);
    block.mutable_rate()->set_denominator(denominator);
    return is_well_formed(block);
  };
  constexpr std::uint64_t kLast = std::numeric_limits<std::uint64_t>::max();
  constexpr std::int64_t kMost = 1'000'000'000'000;
  EXPECT_TRUE(is_good(65536, 1, 0));
  EXPECT_FALSE(is_good(65537, 1, 0));
  EXPECT_FALSE(is_good(0, 1, 0));
  EXPECT_TRUE(is_good(1, 256, 0));
  EXPECT_FALSE(is_good(1, 257, 0));
  EXPECT_FALSE(is_good(1, 0, 0));
  EXPECT_TRUE(is_good(2, 1, kLast - 2));
  EXPECT_FALSE(is_good(2, 1, kLast - 1));
  for (const auto& [numerator, denominator, expected] : {std::tuple(kMost, kMost, true),
                                                         {kMost + 1, kMost, false},
                                                         {kMost, kMost + 1, false},
                                                         {std::int64_t{1}, std::int64_t{1}, true},
                                                         {std::int64_t{0}, kMost, false},
                                                         {kMost, std::int64_t{0}, false},
                                                         {std::int64_t{-1}, std::int64_t{-1}, false}}) {
    EXPECT_EQ(is_good(1, 1, 0, numerator, denominator), expected) << numerator << " / " << denominator;
  }
}

}  // namespace
}  // namespace dts::client
