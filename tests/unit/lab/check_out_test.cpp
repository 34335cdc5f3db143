// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "lab/problems.h"

namespace dts::lab {
namespace {

class CheckOut : public testing::Test {
 protected:
  CheckOut() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-out-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~CheckOut() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  std::filesystem::path folder_;
};

TEST_F(CheckOut, WhatIsReadUnderAnyName_IsRefused) {
  const std::string model = write("model.toml", "x");
  std::filesystem::create_symlink(model, folder_ / "link.toml");

  EXPECT_FALSE(check_out(model, {model}));
  EXPECT_FALSE(check_out(folder_ / "link.toml", {model}));
  EXPECT_FALSE(check_out(folder_ / "." / "model.toml", {"", model}));
}

TEST_F(CheckOut, FilesOfTheTrials_AreRefused) {
  EXPECT_FALSE(check_out(write("trials.csv", "subject,trial"), {folder_}));
  EXPECT_FALSE(check_out(write("A.csv", "trial,v1,v2,v3,v4\n"), {folder_}));
}

TEST_F(CheckOut, NewFilesAndEarlierResults_AreWritten) {
  EXPECT_TRUE(check_out(folder_ / "new.csv", {folder_}));
  EXPECT_TRUE(check_out(write("pred.csv", "subject,trial,t_p1"), {folder_}));
  EXPECT_TRUE(check_out("new.csv", {folder_, ""}));
}

}  // namespace
}  // namespace dts::lab
