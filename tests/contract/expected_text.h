// SPDX-License-Identifier: Apache-2.0
// Compares what a test found with a text file beside the test. The file is reviewed like code: it says what the program does.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace dts::test {

inline std::vector<std::string> lines_of(std::istream&& text) {
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// A word is itself; a number may differ by `tolerance`, as a part of it, for the mathematical functions of another machine.
inline bool is_same_word(const std::string& a, const std::string& b, double tolerance) {
  if (a == b) return true;
  char* end_a = nullptr;
  char* end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a);
  const double y = std::strtod(b.c_str(), &end_b);
  const bool are_numbers = end_a != a.c_str() && end_b != b.c_str() && std::string(end_a) == end_b;
  return are_numbers && std::abs(x - y) <= tolerance * std::max(std::abs(x), std::abs(y)) + 1e-12;
}

inline bool is_same_line(const std::string& a, const std::string& b, double tolerance) {
  std::istringstream words_a(a);
  std::istringstream words_b(b);
  std::string word_a;
  std::string word_b;
  while (words_a >> word_a) {
    if (!(words_b >> word_b) || !is_same_word(word_a, word_b, tolerance)) return false;
  }
  return !(words_b >> word_b);
}

/// `file` is named from the top of the tree. With DTS_WRITE_EXPECTED=1 in the environment the file is written anew: look at its diff.
inline void expect_text(const std::string& file, const std::string& found, double tolerance = 1e-9) {
  const std::string path = std::string(DTS_SOURCE_DIR) + "/" + file;
  if (std::getenv("DTS_WRITE_EXPECTED") != nullptr) std::ofstream(path) << found;
  const auto expected = lines_of(std::ifstream(path));
  const auto actual = lines_of(std::istringstream(found));
  EXPECT_EQ(expected.size(), actual.size()) << file;
  for (std::size_t i = 0; i < std::min(expected.size(), actual.size()); ++i) {
    ASSERT_TRUE(is_same_line(expected[i], actual[i], tolerance))
        << file << ":" << i + 1 << "\nexpected: " << expected[i] << "\nfound:    " << actual[i];
  }
}

}  // namespace dts::test
