// SPDX-License-Identifier: Apache-2.0
#include "device/sim/cop_recording.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "unit/device/sim_rig.h"

namespace dts::device::sim {
namespace {

/// A file that lives as long as the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& content) : path_(test::temporary_path("cop.csv")) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::string recording_refusal(const std::string& content) {
  const TemporaryFile file(content);
  const auto recording = CopRecording::load(file.path());
  return recording ? "" : recording.error().what.substr(file.path().size());
}

TEST(CopRecording, TwoRows_InterpolatedAndCentred) {
  const TemporaryFile file("t_s,x_mm,y_mm\n0.5,10,1\n1.5,20,3\n");
  const auto recording = CopRecording::load(file.path());

  ASSERT_TRUE(recording.has_value());
  EXPECT_EQ(recording->duration_s(), 1.0);
  EXPECT_EQ(recording->at(0.0), (physics::CopPosition{-5.0, -1.0}));
  EXPECT_EQ(recording->at(0.5), (physics::CopPosition{0.0, 0.0}));
  EXPECT_EQ(recording->at(1.0), (physics::CopPosition{5.0, 1.0}));
}

TEST(CopRecording, OutsideTheRows_TheNearestRow) {
  const TemporaryFile file("t_s,x_mm,y_mm\n0,10,1\n1,20,3\n");
  const auto recording = CopRecording::load(file.path());

  ASSERT_TRUE(recording.has_value());
  EXPECT_EQ(recording->at(-3.0).ml_mm, -5.0);
  EXPECT_EQ(recording->at(3.0).ml_mm, 5.0);
}

TEST(CopRecording, Repeated_StartsAgainAfterABridge) {
  const TemporaryFile file("t_s,x_mm,y_mm\n0,10,1\n1,20,3\n");
  const auto recording = CopRecording::load(file.path());

  ASSERT_TRUE(recording.has_value());
  EXPECT_EQ(recording->repeated_at(-1.0).ml_mm, -5.0);
  EXPECT_EQ(recording->repeated_at(1.0).ml_mm, 5.0);
  EXPECT_EQ(recording->repeated_at(1.5).ml_mm, 0.0);
  EXPECT_EQ(recording->repeated_at(2.0).ml_mm, -5.0);
  EXPECT_EQ(recording->repeated_at(2.5).ml_mm, 0.0);
}

TEST(CopRecording, WindowsLineEnds_Accepted) { EXPECT_EQ(recording_refusal("t_s,x_mm,y_mm\r\n0,10,1\r\n1,20,3\r\n"), ""); }

TEST(CopRecording, NoSuchFile_NotFound) {
  const auto recording = CopRecording::load("no/such/file.csv");

  ASSERT_FALSE(recording.has_value());
  EXPECT_EQ(recording.error().code, core::ErrorCode::NotFound);
  EXPECT_NE(recording.error().what.find("no/such/file.csv"), std::string::npos);
}

TEST(CopRecording, AFolder_NotFound) {
  const auto recording = CopRecording::load(testing::TempDir());

  ASSERT_FALSE(recording.has_value());
  EXPECT_EQ(recording.error().code, core::ErrorCode::NotFound);
}

TEST(CopRecording, WrongHeader_RefusedAtLineOne) {
  EXPECT_EQ(recording_refusal("t_s,y_mm,x_mm\n0,1,1\n").rfind(":1: the header", 0), 0U);
  EXPECT_EQ(recording_refusal("").rfind(":1: the header", 0), 0U);
}

TEST(CopRecording, BadRow_RefusedWithItsLine) {
  const std::string start = "t_s,x_mm,y_mm\n0,1,1\n";
  for (const char* row : {"1,1", "1,1,1,1", "1,,1", "1,a,1", "1,1 ,1", "1,nan,1", "1,inf,1", "", "1;1;1", "1,1,1,"}) {
    EXPECT_EQ(recording_refusal(start + row + "\n2,1,1\n").rfind(":3: ", 0), 0U)
        << '"' << row << "\" -> " << recording_refusal(start + row + "\n2,1,1\n");
  }
}

TEST(CopRecording, TimeStandsStill_RefusedWithItsLine) {
  EXPECT_EQ(recording_refusal("t_s,x_mm,y_mm\n0,1,1\n1,1,1\n1,1,1\n"), ":4: the time does not rise");
}

TEST(CopRecording, PositionOffAnyPlate_Refused) {
  EXPECT_EQ(recording_refusal("t_s,x_mm,y_mm\n0,1,1\n1,1001,1\n").rfind(":3: a position", 0), 0U);
}

TEST(CopRecording, VeryLongLine_Refused) {
  EXPECT_EQ(recording_refusal("t_s,x_mm,y_mm\n" + std::string(10'000, '1') + ",1,1\n").rfind(":2: longer", 0), 0U);
}

TEST(CopRecording, FewerThanTwoRows_Refused) {
  EXPECT_EQ(recording_refusal("t_s,x_mm,y_mm\n"), ": too few rows, at least 2 needed");
  EXPECT_EQ(recording_refusal("t_s,x_mm,y_mm\n0,1,1\n"), ": too few rows, at least 2 needed");
}

}  // namespace
}  // namespace dts::device::sim
