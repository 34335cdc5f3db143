// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/interruption.h"
#include "cli/progress.h"
#include "record/xdf/recovery.h"

namespace dts::ctl {

/// Progress of long work on recordings. Ctrl-C requests the work to stop; the work then cleans up and ends.
class WorkBar {
 public:
  WorkBar(cli::Console& console, const std::string& what) : bar_(console, what) {}

  [[nodiscard]] record::Progress progress() {
    return [this](std::uint64_t done, std::uint64_t of) {
      bar_.report(of > 0 ? static_cast<double>(done) / static_cast<double>(of) : 1.0);
      return !interruption_.is_asked_for();
    };
  }
  [[nodiscard]] bool is_interrupted() const noexcept { return interruption_.is_asked_for(); }

 private:
  cli::Interruption interruption_;
  cli::Progress bar_;
};

}  // namespace dts::ctl
