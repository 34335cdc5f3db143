// SPDX-License-Identifier: Apache-2.0
// Everything that a rig publishes for recorded scans, against the committed text: see README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "dts/v1/stream.pb.h"
#include "golden/golden_case.h"
#include "golden/golden_rig.h"
#include "golden/golden_text.h"

namespace dts::golden {
namespace {

constexpr std::size_t kMostDifferences = 10;

bool is_asked(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && std::string(value) == "1";
}

std::string expected_file(const std::string& name) { return folder() + "/" + name + ".golden"; }

class Golden : public testing::TestWithParam<std::string> {};

TEST_P(Golden, Case_PublishesWhatItDid) {
  RecordProperty("requirement", "PUB-9");
  const Case golden = read_case(GetParam());
  if (is_asked("DTS_GOLDEN_RECORD") && !golden.sim.empty()) record_scans(golden);
  const std::vector<std::string> got = run(golden, read_scans(golden.name));
  if (is_asked("DTS_GOLDEN_WRITE")) {
    std::string text;
    for (const std::string& line : got) text += line + "\n";
    write_text(expected_file(golden.name), text);
    GTEST_SKIP() << "written: " << expected_file(golden.name);
  }
  std::string report;
  for (const std::string& line : differences(lines_of(read_text(expected_file(golden.name))), got, kMostDifferences)) report += line + "\n";
  EXPECT_TRUE(report.empty()) << golden.name << ":\n"
                              << report << "If this is meant: DTS_GOLDEN_WRITE=1 build/release/tests/golden_cases --gtest_filter='*/"
                              << golden.name << "'\nA commit that changes a golden file gives the reason.";
}

INSTANTIATE_TEST_SUITE_P(Cases, Golden, testing::ValuesIn(case_names()), [](const auto& given) { return given.param; });

/// All expected lines of all cases.
std::string everything() {
  std::string text;
  for (const std::string& name : case_names()) text += read_text(expected_file(name));
  return text;
}

TEST(GoldenCases, EveryKindOfMessage_IsInOne) {
  const std::string text = everything();
  std::vector<std::string> wanted = {"event dtsd/status "};
  for (const char* stream : {"raw", "filtered", "deflection", "cop", "transient", "aux"}) wanted.push_back("/" + std::string(stream) + " ");
  const auto* body = dts::v1::Event::descriptor()->FindOneofByName("body");
  for (int index = 0; index < body->field_count(); ++index) wanted.push_back(" " + std::string(body->field(index)->name()) + ".");
  for (const auto* kinds : {dts::v1::TrialEventKind_descriptor(), dts::v1::ReachStep_descriptor(), dts::v1::TriggerEdge_descriptor(),
                            dts::v1::SessionState_descriptor(), dts::v1::GapReason_descriptor()}) {
    for (int index = 0; index < kinds->value_count(); ++index) {
      if (kinds->value(index)->number() != 0) wanted.push_back("=" + std::string(kinds->value(index)->name()));
    }
  }
  // Played scans wait for the pipeline: its ring is never full. Without recordings no session fails. A cancelled reach has no case yet.
  // Three bodies are only recorded.
  const std::vector<std::string> impossible = {
      "=GAP_REASON_RING_FULL", "=SESSION_STATE_FAILED", "=REACH_STEP_CANCELLED", " segment_start.", " loss.", " figure."};
  for (const std::string& word : wanted) {
    if (std::ranges::find(impossible, word) != impossible.end()) continue;
    EXPECT_NE(text.find(word), std::string::npos) << "in no case:" << word;
  }
}

TEST(GoldenText, NumberBeyondItsTolerance_IsADifferenceAndOneWithinIsNot) {
  const std::vector<std::string> event = {"event chair/reach d1_mm=0.25 scan=12"};
  EXPECT_TRUE(differences(event, {"event chair/reach d1_mm=0.25000000009 scan=12"}, 10).empty());
  EXPECT_EQ(differences(event, {"event chair/reach d1_mm=0.25000001 scan=12"}, 10).size(), 1U);
  EXPECT_EQ(differences(event, {"event chair/reach d1_mm=0.25 scan=13"}, 10).size(), 1U);
  EXPECT_EQ(differences(event, {"event chair/reach d1_mm=nan scan=12"}, 10).size(), 1U);
  EXPECT_EQ(differences(event, {}, 10).size(), 1U);
  EXPECT_TRUE(differences({"block floor/cop c0.mean=100.0"}, {"block floor/cop c0.mean=100.00002"}, 10).empty());
  EXPECT_EQ(differences({"block floor/cop c0.mean=100.0"}, {"block floor/cop c0.mean=100.0001"}, 10).size(), 1U);
}

}  // namespace
}  // namespace dts::golden
