// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::cli {

/// While this object lives, Ctrl-C does not end the program but sets a flag, for work that cleans up before it ends. Only one at a time.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  Interruption(Interruption&&) = delete;
  Interruption& operator=(Interruption&&) = delete;

  [[nodiscard]] bool is_asked_for() const noexcept;

 private:
  void (*before_)(int);
};

}  // namespace dts::cli
