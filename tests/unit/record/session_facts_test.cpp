// SPDX-License-Identifier: Apache-2.0
#include "record/session_facts.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace dts::record {
namespace {

SessionFacts whole_session() {
  SessionFacts session{.session_id = "20261121T144525Z-floor-1", .part = 2, .rig = "floor", .kind = "floor"};
  session.protocol = "reaching";
  session.subject = "P017";
  session.label = "first\ntry";
  session.fields = {{"arm_length_cm", "71"}, {"maximum_reach_cm", "64"}};
  session.started_utc_ns = 1'795'272'325'000'000'001;
  session.utc_minus_monotonic_ns = -5;
  session.boot_id = "b0";
  session.software = "dtsd 0.1.0";
  session.device_uri = "sim:floor?seed=7";
  session.device_model = "simulated";
  session.device_serial = "7";
  session.firmware = "1.2";
  session.calibration_id = "c1";
  session.stages = {"guard", "", "window_filter window_scans=3 shift_scans=1"};
  session.rig_definition = "[rig]\nname = \"floor\"\n";
  session.protocol_definition = "name = \"reaching\"";
  session.plan_seed = 18446744073709551615U;
  session.model_sha256 = "ab";
  return session;
}

/// The facts with one of them replaced.
std::vector<std::pair<std::string, std::string>> with(const std::string& name, const std::string& text) {
  auto facts = to_facts(whole_session());
  std::ranges::find(facts, name, &std::pair<std::string, std::string>::first)->second = text;
  return facts;
}

TEST(SessionFacts, AllOfThem_ComeBack) {
  const auto read = session_facts(to_facts(whole_session()));
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(*read, whole_session());
  EXPECT_EQ(session_facts(to_facts({})).value(), SessionFacts{});
}

TEST(SessionFacts, RigsOfASession_ComeBack_AndTheFirstLeads) {
  SessionFacts companion = whole_session();
  EXPECT_EQ(leading_rig(companion), "floor");
  EXPECT_EQ(leading_part(companion), 2U);
  companion.rig = "plate";
  companion.rigs = {"floor", "plate"};
  companion.part = 3;
  companion.leading_part = 2;
  const auto read = session_facts(to_facts(companion));
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(*read, companion);
  EXPECT_EQ(leading_rig(*read), "floor");
  EXPECT_EQ(leading_part(*read), 2U);
}

TEST(SessionFacts, TooManyRigs_AreRejected) {
  auto facts = to_facts(whole_session());
  facts.emplace_back("rigs", "65");
  EXPECT_EQ(session_facts(facts).error().what, "the fact rigs is 65, at most 64");
}

TEST(SessionFacts, RigsThatContradictEachOther_AreRejected) {
  SessionFacts companion = whole_session();
  companion.rigs = {"floor", "plate"};
  companion.part = 3;
  for (const auto& [rig, leading_part] : {std::pair{"chair", 2U}, std::pair{"plate", 3U}, std::pair{"plate", 4294967295U}}) {
    companion.rig = rig;
    companion.leading_part = leading_part;
    EXPECT_FALSE(session_facts(to_facts(companion))) << rig << ' ' << leading_part;
  }
  companion.rigs.clear();
  companion.leading_part = 2;
  EXPECT_FALSE(session_facts(to_facts(companion))) << "one rig has no companion";
}

TEST(SessionFacts, FactsOfOtherPrograms_AreIgnored) {
  auto facts = to_facts(whole_session());
  facts.emplace_back("datetime", "2026-11-21");
  EXPECT_EQ(session_facts(facts).value(), whole_session());
}

TEST(SessionFacts, NumberThatIsNone_IsNamed) {
  for (const char* name : {"part", "started_utc_ns", "utc_minus_monotonic_ns", "plan_seed", "stages"})
    for (const char* text : {"x", "1 ", " 1", "1.5", "99999999999999999999", "0x1"}) {
      const auto read = session_facts(with(name, text));
      ASSERT_FALSE(read) << name << " = " << text;
      EXPECT_EQ(read.error().code, core::ErrorCode::DataDamaged);
      EXPECT_NE(read.error().what.find(name), std::string::npos) << read.error().what;
    }
  EXPECT_FALSE(session_facts(with("part", "-1")));
}

TEST(SessionFacts, UnknownVersion_IsRefused) {
  EXPECT_FALSE(session_facts(with("format_version", "2")));
  EXPECT_FALSE(session_facts({}));
}

TEST(SessionFacts, TooMuch_IsRefused) {
  EXPECT_FALSE(session_facts(with("stages", "257")));
  EXPECT_FALSE(session_facts(with("label", std::string((1U << 20U) + 1, 'x'))));
  EXPECT_TRUE(session_facts(with("label", std::string(1U << 20U, 'x'))));
  SessionFacts session;
  session.fields.resize(257);
  EXPECT_FALSE(session_facts(to_facts(session)));
}

}  // namespace
}  // namespace dts::record
