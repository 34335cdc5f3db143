// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dts::ctl {

/// While this object lives, Ctrl-C prints a note on the standard error and ends the program. Only one at a time.
class InterruptNote {
 public:
  explicit InterruptNote(const std::string& text);
  ~InterruptNote();
  InterruptNote(const InterruptNote&) = delete;
  InterruptNote& operator=(const InterruptNote&) = delete;

 private:
  void (*before_)(int);
};

}  // namespace dts::ctl
