// SPDX-License-Identifier: Apache-2.0
#include "core/text_pattern.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "core/letters.h"
#include "core/utf8.h"

namespace dts::core {
namespace {

constexpr std::size_t kMostRepeats = 200;
constexpr std::size_t kDeepestGroup = 10;
constexpr char32_t kLargestCharacter = 0x10FFFF;

}  // namespace

/// Compiles from the end of the pattern's elements to their beginning: each element is added once per repetition and knows the step that
/// follows it (Thompson 1968).
class PatternCompiler {
 public:
  explicit PatternCompiler(std::string_view pattern) : text_(characters_of(pattern)) { made_.steps_.emplace_back(); }

  Result<TextPattern> run(std::string_view pattern) {
    const auto alternatives = read_alternatives(0);
    if (problem_.empty() && at_ < text_.size()) note("')' without '('");
    if (problem_.empty()) made_.first_ = add(alternatives, 0);
    if (!problem_.empty()) return fail(ErrorCode::InvalidArgument, problem_, "see docs/operating.md, Privacy");
    made_.pattern_ = pattern;
    return std::move(made_);
  }

 private:
  struct Element;
  using Sequence = std::vector<Element>;
  struct Element {
    TextPattern::Characters characters{};
    std::vector<Sequence> group{};  ///< Not empty: a group instead of characters.
    std::size_t least = 1;
    std::optional<std::size_t> most = 1;  ///< Absent: no limit.
  };

  void note(const std::string& what) {
    if (problem_.empty()) problem_ = "the pattern has a mistake at character " + std::to_string(at_ + 1) + ": " + what;
  }
  [[nodiscard]] bool is_next(char32_t wanted) const { return at_ < text_.size() && text_[at_] == wanted; }
  bool skip(char32_t wanted) {
    if (!is_next(wanted)) return false;
    ++at_;
    return true;
  }

  std::vector<Sequence> read_alternatives(std::size_t depth) {
    std::vector<Sequence> alternatives(1);
    while (problem_.empty() && at_ < text_.size() && !is_next(U')')) {
      if (skip(U'|')) {
        alternatives.emplace_back();
      } else {
        alternatives.back().push_back(read_element(depth));
      }
    }
    return alternatives;
  }

  Element read_element(std::size_t depth) {
    Element element;
    if (skip(U'(')) {
      if (depth == kDeepestGroup) note("too many groups in groups");
      element.group = read_alternatives(depth + 1);
      if (!skip(U')')) note("')' is missing");
    } else if (skip(U'[')) {
      read_class(element);
    } else if (skip(U'.')) {
      element.characters.ranges.emplace_back(0, kLargestCharacter);
    } else if (std::u32string_view(U"*+?{}^$]").find(text_[at_]) != std::u32string_view::npos) {
      note("this character needs '\\' before it");
    } else if (!read_property(element)) {
      const char32_t character = read_character();
      element.characters.ranges.emplace_back(character, character);
    }
    read_count(element);
    return element;
  }

  /// Reads \p{Lu} or \p{Z}, if one is next.
  bool read_property(Element& element) {
    const auto skip_text = [this](std::u32string_view wanted) {
      if (!std::u32string_view(text_).substr(at_).starts_with(wanted)) return false;
      at_ += wanted.size();
      return true;
    };
    if (skip_text(U"\\p{Lu}")) return element.characters.has_capitals = true;
    if (skip_text(U"\\p{Z}")) return element.characters.has_spaces = true;
    return false;
  }

  /// Reads a character that stands for itself, perhaps after '\'. A letter or a digit after '\' has another meaning elsewhere.
  char32_t read_character() {
    if (skip(U'\\')) {
      const bool has_meaning = at_ < text_.size() && text_[at_] < 0x80 && std::isalnum(static_cast<int>(text_[at_])) != 0;
      if (has_meaning || at_ == text_.size())
        note("'\\' stands only before a character that is no letter and no digit, and in \\p{Lu} and \\p{Z}");
    }
    return at_ < text_.size() ? text_[at_++] : U'\0';
  }

  void read_class(Element& element) {
    element.characters.is_negated = skip(U'^');
    while (problem_.empty() && at_ < text_.size() && !is_next(U']')) {
      if (read_property(element)) continue;
      const char32_t first = read_character();
      char32_t last = first;
      const bool is_range = is_next(U'-') && at_ + 1 < text_.size() && text_[at_ + 1] != U']';
      if (is_range) {
        ++at_;
        last = read_character();
      }
      if (last < first) note("the range ends before it begins");
      element.characters.ranges.emplace_back(first, last);
    }
    if (!skip(U']')) note("']' is missing");
    if (element.characters.empty()) note("'[]' has no characters");
  }

  void read_count(Element& element) {
    if (skip(U'*')) {
      element.least = 0;
      element.most.reset();
    } else if (skip(U'+')) {
      element.most.reset();
    } else if (skip(U'?')) {
      element.least = 0;
    } else if (skip(U'{')) {
      element.least = read_number();
      element.most = element.least;
      if (skip(U',')) element.most = is_next(U'}') ? std::nullopt : std::optional(read_number());
      if (!skip(U'}')) note("'}' is missing");
      if (element.most && *element.most < element.least) note("the second number is smaller than the first");
    }
  }

  std::size_t read_number() {
    std::size_t number = 0;
    const std::size_t begin = at_;
    for (; at_ < text_.size() && text_[at_] >= U'0' && text_[at_] <= U'9' && number <= kMostRepeats; ++at_) {
      number = 10 * number + (text_[at_] - U'0');
    }
    if (at_ == begin || number > kMostRepeats) note("a number of repetitions is 0 to " + std::to_string(kMostRepeats));
    return number;
  }

  std::size_t add_step(TextPattern::Step step) {
    if (made_.steps_.size() >= TextPattern::kMostSteps) {
      if (problem_.empty()) problem_ = "the pattern is too large: use smaller numbers of repetitions";
      return 0;
    }
    made_.steps_.push_back(std::move(step));
    return made_.steps_.size() - 1;
  }

  // Each function returns the step with which its part begins; `next` follows the part.

  std::size_t add(const std::vector<Sequence>& alternatives, std::size_t next) {
    std::size_t begin = 0;
    for (std::size_t index = alternatives.size(); index-- > 0 && problem_.empty();) {
      const std::size_t one = add(alternatives[index], next);
      begin = index + 1 == alternatives.size() ? one : add_fork(one, begin);
    }
    return begin;
  }
  std::size_t add(const Sequence& sequence, std::size_t next) {
    // A step of its own, because step 0, the end, cannot be the other way of a fork.
    std::size_t begin = add_step({.next = next});
    for (std::size_t index = sequence.size(); index-- > 0 && problem_.empty();) begin = add(sequence[index], begin);
    return begin;
  }
  std::size_t add(const Element& element, std::size_t next) {
    std::size_t begin = next;
    if (!element.most) {  // a loop: the fork is made first, because the element leads back to it
      begin = add_step({.next = next});
      const std::size_t again = add_once(element, begin);
      if (problem_.empty()) made_.steps_[begin].other = again;
    }
    for (std::size_t count = element.least; element.most && count < *element.most && problem_.empty(); ++count) {
      begin = add_fork(add_once(element, begin), next);
    }
    for (std::size_t count = 0; count < element.least && problem_.empty(); ++count) begin = add_once(element, begin);
    return begin;
  }
  std::size_t add_once(const Element& element, std::size_t next) {
    if (!element.group.empty()) return add(element.group, next);
    return add_step({.characters = element.characters, .next = next});
  }
  std::size_t add_fork(std::size_t one, std::size_t other) { return add_step({.next = one, .other = other}); }

  std::u32string text_;
  std::size_t at_ = 0;
  std::string problem_;
  TextPattern made_;
};

Result<TextPattern> TextPattern::compile(std::string_view pattern) {
  if (pattern.empty() || pattern.size() > kLongestPattern || !is_utf8(pattern)) {
    return fail(ErrorCode::InvalidArgument, "a pattern has 1 to " + std::to_string(kLongestPattern) + " bytes of UTF-8",
                "see docs/operating.md, Privacy");
  }
  return PatternCompiler(pattern).run(pattern);
}

bool TextPattern::Characters::has(char32_t character) const noexcept {
  const bool is_listed =
      std::ranges::any_of(ranges, [character](const auto& range) { return character >= range.first && character <= range.second; }) ||
      (has_capitals && is_capital_letter(character)) || (has_spaces && is_space(character));
  return is_listed != is_negated;
}

/// Marks a step and all steps that follow it without a character. Uses a list instead of recursion.
void TextPattern::reach(std::size_t step, std::vector<bool>& reached) const {
  std::vector<std::size_t> waiting{step};
  while (!waiting.empty()) {
    const std::size_t at = waiting.back();
    waiting.pop_back();
    if (reached[at]) continue;
    reached[at] = true;
    if (at == 0 || !steps_[at].characters.empty()) continue;
    waiting.push_back(steps_[at].next);
    if (steps_[at].other != 0) waiting.push_back(steps_[at].other);
  }
}

bool TextPattern::matches(std::string_view text) const {
  if (!is_utf8(text)) return false;
  std::vector<bool> now(steps_.size(), false);
  reach(first_, now);
  for (const char32_t character : characters_of(text)) {
    std::vector<bool> next(steps_.size(), false);
    for (std::size_t at = 1; at < steps_.size(); ++at) {
      if (!now[at] || steps_[at].characters.empty()) continue;
      if (steps_[at].characters.has(character)) reach(steps_[at].next, next);
    }
    now = std::move(next);
  }
  return now[0];
}

}  // namespace dts::core
