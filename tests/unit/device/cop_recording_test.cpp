// SPDX-License-Identifier: Apache-2.0
#include "device/sim/cop_recording.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

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

TEST(CopRecording, TwoRows_InterpolatedCentredAndRepeatedAfterABridge) {
  const TemporaryFile file("t_s,x_mm,y_mm\r\n0.5,10,1\r\n1.5,20,3\r\n");
  const auto recording = CopRecording::load(file.path());

  ASSERT_TRUE(recording.has_value());
  EXPECT_EQ(recording->duration_s(), 1.0);
  EXPECT_EQ(recording->at(0.0), (dts::sim::CopPosition{-5.0, -1.0}));
  EXPECT_EQ(recording->at(0.5), (dts::sim::CopPosition{0.0, 0.0}));
  EXPECT_EQ(recording->at(1.0), (dts::sim::CopPosition{5.0, 1.0}));
  EXPECT_EQ(recording->at(-3.0).ml_mm, -5.0) << "the nearest row";
  EXPECT_EQ(recording->at(3.0).ml_mm, 5.0);
  EXPECT_EQ(recording->repeated_at(-1.0).ml_mm, -5.0);
  EXPECT_EQ(recording->repeated_at(1.0).ml_mm, 5.0);
  EXPECT_EQ(recording->repeated_at(1.5).ml_mm, 0.0);
  EXPECT_EQ(recording->repeated_at(2.0).ml_mm, -5.0);
  EXPECT_EQ(recording->repeated_at(2.5).ml_mm, 0.0);
}

TEST(CopRecording, NoSuchFileOrAFolder_NotFound) {
  for (const std::string& path : {std::string("no/such/file.csv"), testing::TempDir()}) {
    const auto recording = CopRecording::load(path);
    ASSERT_FALSE(recording.has_value());
    EXPECT_EQ(recording.error().code, core::ErrorCode::NotFound);
    EXPECT_NE(recording.error().what.find(path), std::string::npos);
  }
}

TEST(CopRecording, WrongFile_RefusedWithItsLine) {
  const std::string head = "t_s,x_mm,y_mm\n";
  for (const auto& [content, refusal] : {std::pair{std::string("t_s,y_mm,x_mm\n0,1,1\n"), ":1: the header"},
                                         {"", ":1: the header"},
                                         {head + "0,1,1\n1,1,1\n1,1,1\n", ":4: the time is not later than in the row before"},
                                         {head + "0,1,1\n1,1001,1\n", ":3: a position"},
                                         {head + "0,1," + std::string(253, '0') + "\n1,1,1\n", ":2: longer"},
                                         {head, ": too few rows, at least 2 needed"},
                                         {head + "0,1,1\n", ": too few rows, at least 2 needed"}}) {
    EXPECT_EQ(recording_refusal(content).rfind(refusal, 0), 0U) << recording_refusal(content);
  }
  EXPECT_EQ(recording_refusal(head + "0,1," + std::string(252, '0') + "\n1,1,1\n"), "") << "256 characters";
}

TEST(CopRecording, BadRow_RefusedWithItsLine) {
  const std::string start = "t_s,x_mm,y_mm\n0,1,1\n";
  for (const char* row : {"1,1", "1,1,1,1", "1,,1", "1,a,1", "1,1 ,1", "1,nan,1", "1,inf,1", "", "1;1;1", "1,1,1,"}) {
    EXPECT_EQ(recording_refusal(start + row + "\n2,1,1\n").rfind(":3: ", 0), 0U)
        << '"' << row << "\" -> " << recording_refusal(start + row + "\n2,1,1\n");
  }
}

}  // namespace
}  // namespace dts::device::sim
