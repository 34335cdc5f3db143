// SPDX-License-Identifier: Apache-2.0
#include "cli/suggestion.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace dts::cli {
namespace {

TEST(Nearest, Word_IsFoundOnlyWhenNear) {
  const std::vector<std::string> words{"status", "session", "watch", "watchers"};
  const std::vector<std::pair<std::string, std::string>> rows{{"statsu", "status"},
                                                              {"satus", "status"},
                                                              {"sttaus", "status"},
                                                              {"sttuas", "status"},
                                                              {"stutsa", ""},
                                                              {"wach", "watch"},
                                                              {"wa", ""},
                                                              {"watchdog", ""},
                                                              {"watcher", "watchers"},
                                                              {"atch", "watch"},
                                                              {"x", ""},
                                                              {"", ""},
                                                              {"sessionxx", "session"},
                                                              {"sessionxxx", "session"},
                                                              {"sessionxxxx", ""},
                                                              {std::string(65, 's'), ""}};
  for (const auto& [word, meant] : rows) EXPECT_EQ(nearest(word, words), meant) << word;
  EXPECT_EQ(nearest("status", {}), "");
  EXPECT_EQ(nearest("ab", {"a", "b", "ac"}), "a") << "the first of those that are equally near";
  for (const std::size_t size : {64U, 65U}) {
    const std::string candidate(size, 's');
    EXPECT_EQ(nearest(candidate.substr(1), {candidate}), size == 64 ? candidate : "");
  }
}

}  // namespace
}  // namespace dts::cli
