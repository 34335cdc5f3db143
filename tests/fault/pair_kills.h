// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "fault/reference.h"
#include "system/daemon_process.h"

namespace dts::fault {

/// One session over two rigs, whose daemon is killed again and again and started again each time. The session must continue on both rigs
/// as one, and in the end all its recordings must be whole. Thread: one at a time.
class PairKills {
 public:
  explicit PairKills(std::uint32_t seed);

  /// Kills the daemon after up to `longest_s` of recording and starts it again. Returns what is wrong; empty: the session continues.
  [[nodiscard]] std::string run_round(double longest_s);
  /// Stops the session and checks all its recordings. Returns what is wrong; empty: nothing.
  [[nodiscard]] std::string finish(const Reference& reference);

 private:
  [[nodiscard]] bool runs() const;

  std::mt19937 random_;
  int rounds_ = 0;
  std::string session_;
  test::DaemonProcess daemon_;
};

}  // namespace dts::fault
