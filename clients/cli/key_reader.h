// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::cli {

/// Reads single keys of a terminal without waiting for Enter, and without showing them. No effect if the file is not a terminal, or if this
/// program runs in the background. Only one at a time.
class KeyReader {
 public:
  /// `file` is the descriptor of the terminal. The terminal changes its mode at the first `is_pressed`.
  explicit KeyReader(int file) noexcept : file_(file) {}
  /// Restores the terminal.
  ~KeyReader() { restore(); }
  KeyReader(const KeyReader&) = delete;
  KeyReader& operator=(const KeyReader&) = delete;

  /// Returns whether `key` was pressed since the last call; other keys are dropped.
  [[nodiscard]] bool is_pressed(char key);
  /// Restores the terminal of the reader, if there is one; the next `is_pressed` changes it again. Safe in a signal handler.
  static void restore() noexcept;

 private:
  int file_;
};

}  // namespace dts::cli
