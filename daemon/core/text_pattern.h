// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

namespace dts::core {

/// A regular expression that a text must match completely: the part of the usual notation that can be matched in linear time.
///
///     a \. .            a character; a character with a meaning, as itself; any character
///     [a-z_] [^a-z]     one of these characters; any other character
///     \p{Lu} \p{Z}      a capital letter, a space, of any script; also within []
///     (...) a|b         group; either
///     * + ? {2} {1,40}  how often the element before it occurs
///
/// There are no back-references, anchors or look-around. std::regex is not used: it needs exponential time or a deep stack for some pairs
/// of pattern and text, and texts come from the network. Here a match costs at most `kMostSteps` per character, and the size of the
/// compiled pattern is bounded. Characters are Unicode code points.
class TextPattern {
 public:
  static constexpr std::size_t kLongestPattern = 400;  ///< Bytes.
  static constexpr std::size_t kMostSteps = 4000;

  /// Fails with InvalidArgument, naming the place, if the pattern has a mistake, is too long or compiles to more than `kMostSteps`.
  [[nodiscard]] static Result<TextPattern> compile(std::string_view pattern);

  /// Returns false for a text that is not UTF-8.
  [[nodiscard]] bool matches(std::string_view text) const;
  [[nodiscard]] const std::string& pattern() const noexcept { return pattern_; }

 private:
  friend class PatternCompiler;
  struct Characters {
    std::vector<std::pair<char32_t, char32_t>> ranges{};  ///< First and last character.
    bool has_capitals = false;                            ///< \p{Lu}
    bool has_spaces = false;                              ///< \p{Z}
    bool is_negated = false;

    [[nodiscard]] bool empty() const noexcept { return ranges.empty() && !has_capitals && !has_spaces; }
    [[nodiscard]] bool has(char32_t character) const noexcept;
  };

  /// A step of a non-deterministic automaton. A step with characters consumes one of them and continues at `next`; a step without goes to
  /// `next` and, if set, to `other`.
  struct Step {
    Characters characters{};
    std::size_t next = 0;
    std::size_t other = 0;  ///< 0: none; step 0 is the end.
  };
  void reach(std::size_t step, std::vector<bool>& reached) const;

  std::string pattern_;
  std::vector<Step> steps_{};  ///< Step 0 is the end of the text.
  std::size_t first_ = 0;
};

}  // namespace dts::core
