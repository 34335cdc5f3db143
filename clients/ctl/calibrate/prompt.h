// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

namespace dts::ctl {

/// What the person who calibrates wants to do next.
enum class Answer { Go, Redo, Skip, Quit };

struct Reply {
  Answer answer = Answer::Go;
  std::optional<std::size_t> number{};  ///< Of the point to redo, from 1; nothing: the last one.

  friend bool operator==(const Reply& reply, Answer answer) { return reply.answer == answer; }
};

/// Asks on the terminal. Enter goes on, r measures the last point again, r 13 the thirteenth, s leaves this one out, q (or the end of the
/// input) quits.
class Prompt {
 public:
  /// The next line of the input; nothing at its end.
  using ReadLine = std::function<std::optional<std::string>()>;

  /// Whether a line waits to be read.
  using IsTyped = std::function<bool()>;

  Prompt(std::ostream& talk, ReadLine read_line, IsTyped is_typed = {})
      : talk_(talk), read_line_(std::move(read_line)), is_typed_(std::move(is_typed)) {}

  static constexpr const char* kPlain = " [Enter, q = quit] ";
  static constexpr const char* kWithRedo = " [Enter, r = redo the last, q = quit] ";
  static constexpr const char* kWithAll = " [Enter, r = redo the last, r N = redo point N, s = skip, q = quit] ";
  /// Only one of the `choices` is an answer.
  [[nodiscard]] Reply ask(const std::string& question, std::string_view choices) const;
  /// What was typed without being asked, while something else goes on; a line that means nothing then is forgotten.
  [[nodiscard]] std::optional<Answer> overhear() const;

 private:
  std::ostream& talk_;
  ReadLine read_line_;
  IsTyped is_typed_;
};

/// Lines of the standard input.
[[nodiscard]] Prompt::ReadLine standard_input();
[[nodiscard]] bool has_standard_input();
[[nodiscard]] bool is_input_terminal() noexcept;

}  // namespace dts::ctl
