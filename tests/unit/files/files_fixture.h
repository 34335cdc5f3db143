// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "files/toml_reader.h"

namespace dts::files {

inline const std::filesystem::path kConfig = std::filesystem::path(DTS_SOURCE_DIR) / "config";

/// A good text with its first line that begins with `line` replaced by `by`, and every problem that it has then, one a line.
struct Edit {
  std::string line;
  std::string by;
  std::string problems;
};

/// A number that is given in the first line that begins with `line`, in the table `where`: the first and last that are accepted, and a
/// number beside each that is not.
struct Range {
  std::string line;
  std::string where;
  std::string lowest;
  std::string highest;
  std::string below;
  std::string above;
};

inline std::string edited(std::string text, const std::string& line, const std::string& by) {
  const std::size_t begin = text.starts_with(line) ? 0 : text.find("\n" + line) + 1;
  EXPECT_TRUE(begin != 0 || text.starts_with(line)) << line;
  return text.replace(begin, text.find('\n', begin) - begin, by);
}

/// Each test has a folder of its own.
class FilesTest : public testing::Test {
 protected:
  FilesTest() {
    std::string pattern = testing::TempDir() + "dts-files-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~FilesTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return path(name);
  }
  static std::string content_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  /// One line each, files as seen from the test's folder.
  [[nodiscard]] std::string text_of(const Problems& problems) const {
    std::string text;
    for (const Problem& problem : problems) text += (text.empty() ? "" : "\n") + to_string(problem);
    return without_folder(text);
  }
  [[nodiscard]] std::string without_folder(std::string text) const {
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix)) text.erase(at, prefix.size());
    return text;
  }
  /// `read` reads a text and adds to the problems.
  template <typename Read>
  void expect_problems(const std::string& good, const std::vector<Edit>& edits, Read read) const {
    for (const auto& [line, by, expected] : edits) {
      Problems problems;
      read(edited(good, line, by), problems);
      EXPECT_EQ(text_of(problems), expected) << line << " -> " << by;
    }
  }

  template <typename Read>
  void expect_ranges(const std::string& good, const std::vector<Range>& ranges, Read read) const {
    for (const auto& [line, where, lowest, highest, below, above] : ranges) {
      const std::string given = line.substr(0, line.find(' ')) + " = ";
      for (const auto& [value, is_accepted] : {std::pair(lowest, true), {highest, true}, {below, false}, {above, false}}) {
        Problems problems;
        read(edited(good, line, given + value), problems);
        const std::string refusal = given + value + " is out of range; allowed: " + lowest + " .. " + highest;
        const std::string text = text_of(problems);
        EXPECT_EQ(text.find(": " + (where.empty() ? "" : where + " ") + refusal) == std::string::npos, is_accepted) << refusal << '\n'
                                                                                                                    << text;
      }
    }
  }

  std::filesystem::path folder_;
};

}  // namespace dts::files
