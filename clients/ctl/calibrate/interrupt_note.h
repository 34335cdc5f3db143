// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dts::ctl {

/// While it lives, Ctrl-C ends the program with a last word on the standard error. One at a time.
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
