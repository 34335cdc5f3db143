// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace dts::testing {

[[nodiscard]] inline std::string content_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// Compares `text` with a file below tests/. With DTS_GOLDEN_WRITE=1 the file becomes the text.
inline void expect_committed(const std::string& name, const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(DTS_SOURCE_DIR) / "tests" / name;
  if (const char* write = std::getenv("DTS_GOLDEN_WRITE"); write != nullptr && std::string(write) == "1") {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  EXPECT_EQ(text, content_of(file)) << "If this is meant: run it with DTS_GOLDEN_WRITE=1, and look at the changes of " << file;
}

/// Without the decimals behind the ninth, which may differ between machines.
[[nodiscard]] inline std::string rounded(std::string text) {
  constexpr std::size_t kDecimals = 9;
  for (std::size_t at = text.find('.'); at != std::string::npos; at = text.find('.', at + 1)) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789", at + 1), text.size());
    if (end - at - 1 > kDecimals) text.erase(at + 1 + kDecimals, end - at - 1 - kDecimals);
  }
  return text;
}

[[nodiscard]] inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
  return text;
}

/// The running case as a file's name.
[[nodiscard]] inline std::string case_file() {
  const auto& info = *::testing::UnitTest::GetInstance()->current_test_info();
  return std::string(info.test_suite_name()) + "." + info.name() + ".txt";
}

}  // namespace dts::testing
