// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "fake_recording.h"
#include "record/export/export.h"

namespace dts::record {

/// A folder of its own to export into, gone with the test.
class ExportTest : public ::testing::Test {
 protected:
  ExportTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "dts-export-XXXXXX").string();
    base_ = ::mkdtemp(pattern.data());
    folder_ = base_ / "out";
  }
  ~ExportTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(base_, ignored);
  }

  [[nodiscard]] std::string text(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    EXPECT_TRUE(file) << name;
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::vector<std::string> lines(const std::string& name) const {
    std::vector<std::string> found;
    std::istringstream stream(text(name));
    for (std::string line; std::getline(stream, line);) found.push_back(line);
    return found;
  }
  /// Everything below the folder, sorted.
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> found;
    if (!std::filesystem::exists(folder_)) return found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      if (!entry.is_directory()) found.push_back(entry.path().lexically_relative(folder_).string());
    }
    std::ranges::sort(found);
    return found;
  }
  /// Empty after a success; paths as seen from the test's folder.
  [[nodiscard]] std::string refusal(const core::Result<Exported>& exported) const {
    std::string text = exported ? "" : core::to_string(exported.error());
    for (std::size_t at = text.find(base_); at != std::string::npos; at = text.find(base_)) text.erase(at, base_.string().size());
    return text;
  }
  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << content;
  }

  std::filesystem::path base_;
  std::filesystem::path folder_;
};

inline std::vector<std::string> cells(const std::string& line, char separator) {
  std::vector<std::string> found;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, separator);) found.push_back(cell);
  if (line.ends_with(separator)) found.emplace_back();
  return found;
}

}  // namespace dts::record
