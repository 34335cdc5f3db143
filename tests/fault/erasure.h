// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "fault/faulty_disk.h"

namespace dts::fault {

/// A state folder with two recorded sessions: one of a subject, and one of another subject whose notes mention the first. A test erases
/// the first subject as often as it wants: each time the folder is as it was.
class ErasedFolder {
 public:
  /// `folder` is empty.
  explicit ErasedFolder(std::string folder);
  /// Returns why the folder could not be made; empty: it is ready.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  /// Erases the subject on a sound disk, in a process of its own. Returns a SIGKILL before every call to the disk that changes something.
  [[nodiscard]] std::vector<Fault> all_kills();
  /// Erases the subject, with a SIGKILL in between, and starts the recording part of a daemon again on a sound disk.
  struct Outcome {
    std::string problem{};  ///< What is neither complete nor gone; empty: every promise was kept.
    bool was_killed = false;
    bool is_gone = false;  ///< The subject; false: it is complete.
  };
  [[nodiscard]] Outcome kill(const Fault& fault);

 private:
  void prepare();
  void restore() const;
  [[nodiscard]] std::string erase(FaultyDisk& disk, const Fault* fault) const;
  [[nodiscard]] std::string look() const;

  std::string state_;
  std::string copy_;
  std::string problem_;
  std::string erased_session_;
  std::string other_session_;
};

}  // namespace dts::fault
