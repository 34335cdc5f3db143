// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

namespace dts::ctl {

/// The person's next step in a calibration.
enum class Answer { Go, Redo, Skip, Quit };

struct Reply {
  Answer answer = Answer::Go;
  std::optional<std::size_t> number{};  ///< Number of the point to redo, from 1; nothing: the last one.

  friend bool operator==(const Reply& reply, Answer answer) { return reply.answer == answer; }
};

/// Asks on the terminal. Enter continues, r measures the last point again, r 13 the thirteenth point, s skips this point, q (or the end of
/// the input) quits.
class Prompt {
 public:
  /// Returns the next line of the input; nothing at its end.
  using ReadLine = std::function<std::optional<std::string>()>;

  /// Returns true if a line waits to be read.
  using IsTyped = std::function<bool()>;

  Prompt(std::ostream& talk, ReadLine read_line, IsTyped is_typed = {})
      : talk_(talk), read_line_(std::move(read_line)), is_typed_(std::move(is_typed)) {}

  static constexpr const char* kPlain = " [Enter, q = quit] ";
  static constexpr const char* kWithRedo = " [Enter, r = redo the last, q = quit] ";
  static constexpr const char* kWithAll = " [Enter, r = redo the last, r N = redo point N, s = skip, q = quit] ";
  /// Asks until the person types one of the `choices`.
  [[nodiscard]] Reply ask(const std::string& question, std::string_view choices) const;
  /// Reads a line typed without a question, during other work; drops a line that has no meaning then.
  [[nodiscard]] std::optional<Answer> poll() const;

 private:
  std::ostream& talk_;
  ReadLine read_line_;
  IsTyped is_typed_;
};

/// Returns lines of the standard input.
[[nodiscard]] Prompt::ReadLine standard_input();
[[nodiscard]] bool has_standard_input();
[[nodiscard]] bool is_input_terminal() noexcept;

}  // namespace dts::ctl
