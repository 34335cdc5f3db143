// SPDX-License-Identifier: Apache-2.0
// The number of a run: a byte that differs after every reset and every START, kept in the EEPROM.
#pragma once

#include <stdint.h>

namespace firmware {

/// Each run writes one cell, and the cells take turns, so that each wears only once in 64 runs. An ATmega328P allows 100,000 writes per
/// cell: 6.4 million runs. The newest cell is the one whose successor does not follow it.
class RunNumber {
 public:
  static constexpr uint8_t kCells = 64;

  /// Finds the newest run. `read` returns the byte of a cell, 0xFF in a new EEPROM.
  template <class Read>
  void load(Read read) {
    for (uint8_t cell = 0; cell < kCells; ++cell) {
      const uint8_t run = read(cell);
      if (read(next(cell)) != static_cast<uint8_t>(run + 1)) {
        cell_ = cell;
        run_ = run;
        return;
      }
    }
    // Not reached: 64 cells cannot all follow each other in a circle of 256.
  }

  /// Begins a new run. The caller then writes value() into cell().
  void advance() {
    cell_ = next(cell_);
    run_ = static_cast<uint8_t>(run_ + 1);
  }
  uint8_t value() const { return run_; }
  uint8_t cell() const { return cell_; }

 private:
  static uint8_t next(uint8_t cell) { return static_cast<uint8_t>((cell + 1) % kCells); }

  uint8_t cell_ = 0;
  uint8_t run_ = 0;
};

}  // namespace firmware
