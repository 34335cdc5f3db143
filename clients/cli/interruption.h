// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::cli {

/// While it lives, Ctrl-C does not end the program but is noted: for work that cleans up behind itself. One at a time.
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
