// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

namespace dts::ctl {

/// What the person who calibrates wants to do next.
enum class Answer { Go, Redo, Quit };

/// Asks on the terminal. Enter goes on, r measures the last point again, q (or the end of the input) quits.
class Prompt {
 public:
  /// The next line of the input; nothing at its end.
  using ReadLine = std::function<std::optional<std::string>()>;

  Prompt(std::ostream& talk, ReadLine read_line) : talk_(talk), read_line_(std::move(read_line)) {}

  static constexpr const char* kPlain = " [Enter, q = quit] ";
  static constexpr const char* kWithRedo = " [Enter, r = redo the last, q = quit] ";
  /// Redo is an answer only if it is among the `choices`.
  [[nodiscard]] Answer ask(const std::string& question, std::string_view choices) const;

 private:
  std::ostream& talk_;
  ReadLine read_line_;
};

/// Lines of the standard input.
[[nodiscard]] Prompt::ReadLine standard_input();
[[nodiscard]] bool is_input_terminal() noexcept;

}  // namespace dts::ctl
