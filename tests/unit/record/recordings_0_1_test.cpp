// SPDX-License-Identifier: Apache-2.0
// Recordings of dtsd 0.1.0 (tests/unit/record/recordings_0_1): they open, pass verification and export to the bytes that 0.1.0 wrote.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "record/catalogue/catalogue.h"
#include "record/export/export.h"
#include "record/recording.h"
#include "record/sha256.h"
#include "record/xdf/recovery.h"
#include "support/committed_text.h"
#include "unit/record/xdf_fixture.h"

namespace dts::record {
namespace {

std::string recorded(const std::string& name) { return test::committed_file("unit/record/recordings_0_1/" + name + ".xdf"); }

TEST(Recordings01, OpenAndVerify_WithEveryEvent) {
  RecordProperty("requirement", "REC-9");
  for (const auto& [name, events] : std::vector<std::pair<std::string, int>>{{"standing", 34}, {"reaching", 66}, {"free", 6}}) {
    const auto verified = verify(recorded(name));
    ASSERT_TRUE(verified) << verified.error().what;
    EXPECT_TRUE(verified->is_closed);
    auto recording = Recording::open(recorded(name));
    ASSERT_TRUE(recording);
    int found = 0;
    for (auto item = (*recording)->next(); item && *item; item = (*recording)->next()) {
      const auto* timed = std::get_if<TimedEvent>(&**item);
      if (timed == nullptr) continue;
      ++found;
      EXPECT_FALSE(timed->old_text.empty()) << name << ": an event was not read but taken for a marker";
    }
    EXPECT_EQ(found, events) << name;
  }
}

TEST(Recordings01, Export_ToTheSameBytes) {
  RecordProperty("requirement", "REC-9");
  const xdf_test::Folder temporary;
  const std::filesystem::path folder = temporary / "exports";
  for (const std::string name : {"standing", "reaching", "free"}) {
    auto recording = Recording::open(recorded(name));
    ASSERT_TRUE(recording);
    ASSERT_TRUE(export_csv(**recording, folder / (name + "-csv")));
    ASSERT_TRUE((*recording)->rewind());
    ASSERT_TRUE(export_bids(**recording, folder / (name + "-bids")));
  }
  std::istringstream listed(test::content_of(test::committed_file("unit/record/recordings_0_1/exports.sha256")));
  std::string hash;
  std::string file;
  int files = 0;
  while (listed >> hash >> file) {
    EXPECT_EQ(sha256_of(test::content_of(folder / file)), hash) << file;
    ++files;
  }
  EXPECT_EQ(files, 75);
}

TEST(Recordings01, Catalogue_HasTheirTrialsAndFigures) {
  const auto standing = read_recording(recorded("standing"));
  ASSERT_TRUE(standing);
  ASSERT_EQ(standing->trials.size(), 2U);
  EXPECT_FALSE(is_valid(standing->trials[0])) << "the person stepped on the plate during the first trial";
  EXPECT_TRUE(is_valid(standing->trials[1]));
  EXPECT_EQ(standing->results.size(), 12U);
  EXPECT_EQ(standing->part.losses->of(core::GapReason::Unplugged), (core::LossCount{.gaps = 1, .scans = 38}));

  const auto reaching = read_recording(recorded("reaching"));
  ASSERT_TRUE(reaching);
  ASSERT_EQ(reaching->trials.size(), 4U);
  for (const TrialRow& trial : reaching->trials) EXPECT_TRUE(is_valid(trial) && !trial.result.empty());
}

}  // namespace
}  // namespace dts::record
