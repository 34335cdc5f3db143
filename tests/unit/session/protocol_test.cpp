// SPDX-License-Identifier: Apache-2.0
#include "session/protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace dts::session {
namespace {

using Fields = std::vector<std::pair<std::string, std::string>>;
using testing::HasSubstr;
using testing::Not;

/// As thesis Table 6.1, with the targets given.
Protocol reaching(std::vector<Condition> conditions = {}) {
  Protocol protocol;
  protocol.name = "reach";
  protocol.fields = {{.name = "age_years", .minimum = 3, .maximum = 120},
                     {.name = "arm_length_cm", .minimum = 20, .maximum = 120},
                     {.name = "max_reach_cm", .minimum = 10, .maximum = 250},
                     {.name = "side", .label = "Reaching arm", .is_required = true, .choices = {"left", "right"}}};
  if (!conditions.empty()) protocol.trials = TrialPlan{.conditions = std::move(conditions), .trials_per_block = 15};
  return protocol;
}

/// The error's one line; "" when the fields pass.
std::string refusal(const Protocol& protocol, const Fields& fields) {
  const auto checked = check_fields(protocol, fields);
  if (checked) return "";
  EXPECT_EQ(checked.error().code, core::ErrorCode::InvalidArgument);
  return core::to_string(checked.error());
}

TEST(ProtocolFields, InRangeOrOptional_Pass) {
  for (const Fields& fields : {Fields{{"side", "left"}, {"age_years", "120"}, {"arm_length_cm", "65.5"}}, Fields{{"side", "right"}},
                               Fields{{"side", "left"}, {"age_years", "3"}, {"arm_length_cm", "20"}}}) {
    EXPECT_EQ(refusal(reaching(), fields), "");
  }
}

TEST(ProtocolFields, WhatDoesNotFit_IsToldAndNotRepeated) {
  struct Row {
    Fields fields;
    std::string message;
  };
  const std::vector<Row> rows{
      // Neither a value nor an unknown name: it might be a person's.
      {{{"side", "left"}, {"Jane Doe", "Baker Street"}}, "field 2 of 2 is not a field of protocol 'reach'"},
      {{{"side", "left"}, {"arm_lenght_cm", "60"}}, "protocol 'reach' has no field 'arm_lenght_cm' (did you mean 'arm_length_cm'?)"},
      {{{"side", "left"}, {"side", "left"}}, "'side' is given twice"},
      {{{"side", "Jane"}}, "left, right"},
      {{{"side", "left"}, {"arm_length_cm", "19.9"}}, "20 .. 120"},
      {{{"side", "left"}, {"arm_length_cm", "120.1"}}, "20 .. 120"},
      {{{"side", "left"}, {"arm_length_cm", "-65"}}, "20 .. 120"},
  };
  for (const auto& [fields, message] : rows) {
    EXPECT_THAT(refusal(reaching(), fields), testing::AllOf(HasSubstr(message), Not(HasSubstr("Jane")), Not(HasSubstr("Baker"))));
  }
  for (const char* text : {"", "tall", "65,5", "65 cm", " 65", "65x", "nan", "inf", "1e999", "0x41", "+65"}) {
    EXPECT_THAT(refusal(reaching(), {{"side", "left"}, {"arm_length_cm", text}}), HasSubstr("'arm_length_cm' is not a number")) << text;
  }
  EXPECT_EQ(refusal(free_protocol(), {{"weight", "30"}}), "protocol 'free' has no field 'weight' (remove it: this protocol has no fields)");
}

TEST(ProtocolFields, SeveralWrongOrMissing_AreToldTogether) {
  RecordProperty("requirement", "SES-8");
  Protocol protocol = reaching();
  protocol.fields.push_back({.name = "weight_kg", .is_required = true, .minimum = 20.0, .maximum = 250.0});
  const std::string message = refusal(protocol, {{"age_years", "500"}, {"arm_length_cm", "tall"}, {"hat", "red"}});

  for (const char* part :
       {"protocol 'reach' has no field 'hat'", "'age_years' is out of range", "age_years: allowed: 3 .. 120",
        "'arm_length_cm' is not a number", "needs more fields", "add --field side=left|right --field weight_kg=20..250"}) {
    EXPECT_THAT(message, HasSubstr(part));
  }
}

TEST(ProtocolFields, TargetInPercent_NeedsTheArm) {
  const auto protocol = reaching({{.name = "120", .target_percent = 120}});
  EXPECT_THAT(refusal(protocol, {{"side", "left"}}), testing::AllOf(HasSubstr("'arm_length_cm' is missing"), HasSubstr("'120'")));
  EXPECT_EQ(refusal(protocol, {{"side", "left"}, {"arm_length_cm", "70"}}), "");
}

TEST(ProtocolFields, TargetAtMaximumReach_NeedsTheReach) {
  const auto protocol = reaching({{.name = "max", .is_maximum_reach = true}});
  EXPECT_THAT(refusal(protocol, {{"side", "left"}, {"arm_length_cm", "70"}}), HasSubstr("'max_reach_cm' is missing"));
  EXPECT_EQ(refusal(protocol, {{"side", "left"}, {"max_reach_cm", "132"}}), "");
}

TEST(ProtocolFields, TargetBeyondTheMaximumReach_IsRefusedAsInTheThesis) {
  RecordProperty("requirement", "SES-8");
  const auto protocol = reaching({{.name = "80", .target_percent = 80}, {.name = "max", .is_maximum_reach = true}});
  // Table 6.1: S1 reaches 43 cm with an arm of 68 cm, H1 132 cm with 71 cm.
  EXPECT_THAT(refusal(protocol, {{"side", "right"}, {"arm_length_cm", "68"}, {"max_reach_cm", "43"}}),
              HasSubstr("target '80' is at 54.4 cm, beyond the subject's maximum reach of 43 cm"));
  EXPECT_EQ(refusal(protocol, {{"side", "right"}, {"arm_length_cm", "71"}, {"max_reach_cm", "132"}}), "");
}

TEST(TargetDistance, ComesFromTheSubjectsMeasures) {
  const Fields fields{{"arm_length_cm", "65.5"}, {"max_reach_cm", "121"}};
  EXPECT_DOUBLE_EQ(target_cm({.name = "120", .target_percent = 120}, fields).value_or(0), 78.6);
  EXPECT_DOUBLE_EQ(target_cm({.name = "max", .is_maximum_reach = true}, fields).value_or(0), 121.0);
  EXPECT_DOUBLE_EQ(target_percent({.name = "120", .target_percent = 120}, fields).value_or(0), 120.0);
  EXPECT_DOUBLE_EQ(target_percent({.name = "max", .is_maximum_reach = true}, fields).value_or(0), 121.0 / 65.5 * 100.0);
  EXPECT_FALSE(target_percent({.name = "max", .is_maximum_reach = true}, {{"max_reach_cm", "121"}})) << "the arm is not known";
  EXPECT_FALSE(target_cm({.name = "eyes-open"}, fields).has_value());
  EXPECT_FALSE(target_cm({.name = "120", .target_percent = 120}, {{"arm_length_cm", "long"}}).has_value());
}

}  // namespace
}  // namespace dts::session
