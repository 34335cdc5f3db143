// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "firmware/board.h"

namespace firmware::test {

/// Keeps the interrupt out while it lives, and lets it happen as soon as it may: before the first step and after the last one.
struct Interrupted {
  static inline std::function<void()> interrupt;
  static inline int guards = 0;
  Interrupted() {
    happen();
    ++guards;
  }
  ~Interrupted() { happen(); }
  static void happen() {
    if (interrupt) interrupt();
  }
};

/// A board in which the test is the timer, the converter and the EEPROM.
struct FakeHardware {
  struct Guard {
    Guard() {}
    ~Guard() {}
  };
  static constexpr Limits kLimits{2, 2'000'000, 2000, 0xFFFF, 11'520};
  static constexpr uint8_t kBits = 10;
  static constexpr float kVoltsPerCode = 5.0F / 1024.0F;
  static constexpr uint8_t kQueuedScans = 64;
  static constexpr uint32_t kFirstCounter = 0xFFFFFFF0;
  static constexpr uint16_t kDefaultPeriod = 2000;

  const char* serial() const { return serial_text.c_str(); }
  static const char* model() { return "fake"; }
  static const char* firmware() { return "test"; }
  static const char* channel_name(uint8_t channel) { return channel == 0 ? "A0" : "A1"; }
  uint32_t start_sampling(uint16_t chosen) {
    period = chosen;
    is_sampling = true;
    return 0xFFFFF000;
  }
  void stop_sampling() { is_sampling = false; }
  bool is_converting() const { return converting; }
  void wake_line() {}
  uint8_t read_cell(uint8_t cell) const { return cells.contains(cell) ? cells.at(cell) : 0xFF; }
  void store_cell(uint8_t cell, uint8_t value) { cells[cell] = value; }
  bool is_stored() const { return stored; }

  std::string serial_text = "unit-1";
  std::map<uint8_t, uint8_t> cells;
  uint16_t period = 0;
  bool is_sampling = false;
  bool converting = false;
  bool stored = true;
};

struct InterruptedHardware : FakeHardware {
  using Guard = Interrupted;
};

}  // namespace firmware::test
