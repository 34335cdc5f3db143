// SPDX-License-Identifier: Apache-2.0
// What a test found, compared with a text that is committed beside the test. Such a text is reviewed like code: it shows what the program
// does.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace dts::test {

/// `name` is a path below tests/.
[[nodiscard]] inline std::filesystem::path committed_file(const std::string& name) {
  return std::filesystem::path(DTS_SOURCE_DIR) / "tests" / name;
}

[[nodiscard]] inline std::string content_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

[[nodiscard]] inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Whether two words are equal, or decimal numbers that differ by at most `tolerance` of their size. Whole numbers (also bytes and codes)
/// have to be equal.
[[nodiscard]] inline bool is_same_word(const std::string& a, const std::string& b, double tolerance) {
  if (a == b) return true;
  if ((a + b).find('.') == std::string::npos && (a + b).find("e-") == std::string::npos) return false;
  char* end_a = nullptr;
  char* end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a);
  const double y = std::strtod(b.c_str(), &end_b);
  const bool are_numbers = end_a != a.c_str() && end_b != b.c_str() && std::string(end_a) == end_b;
  return are_numbers && std::abs(x - y) <= tolerance * std::max(std::abs(x), std::abs(y)) + 1e-12;
}

[[nodiscard]] inline bool is_same_line(const std::string& a, const std::string& b, double tolerance) {
  if (a == b || tolerance == 0.0) return a == b;
  std::istringstream words_a(a);
  std::istringstream words_b(b);
  std::string word_a;
  std::string word_b;
  while (words_a >> word_a) {
    if (!(words_b >> word_b) || !is_same_word(word_a, word_b, tolerance)) return false;
  }
  return !(words_b >> word_b);
}

/// Compares `text` with the committed file, line by line. Numbers may differ by `tolerance` of their size: the mathematical functions of
/// another machine may round differently. With DTS_GOLDEN_WRITE=1 in the environment the file becomes the text: look at its diff.
inline void expect_committed(const std::string& name, const std::string& text, double tolerance = 0.0) {
  const std::filesystem::path file = committed_file(name);
  if (const char* write = std::getenv("DTS_GOLDEN_WRITE"); write != nullptr && std::string(write) == "1") {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    GTEST_SKIP() << "written: " << file;
  }
  const std::vector<std::string> expected = lines_of(content_of(file));
  const std::vector<std::string> found = lines_of(text);
  const std::string hint = "If this is meant: run it with DTS_GOLDEN_WRITE=1, and look at the changes of " + file.string();
  ASSERT_FALSE(expected.empty()) << hint;
  for (std::size_t line = 0; line < std::min(expected.size(), found.size()); ++line) {
    ASSERT_TRUE(is_same_line(expected[line], found[line], tolerance))
        << name << ":" << line + 1 << "\nexpected: " << expected[line] << "\nfound:    " << found[line] << "\n"
        << hint;
  }
  EXPECT_EQ(expected.size(), found.size()) << "lines of " << name << ". " << hint;
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
  const auto& info = *testing::UnitTest::GetInstance()->current_test_info();
  return std::string(info.test_suite_name()) + "." + info.name() + ".txt";
}

}  // namespace dts::test
