// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "unit/device/mcc/mcc_bench.h"
#include "usb/emulator/fs_plus_emulator.h"

namespace dts::device::mcc::test {

inline constexpr char kPairUri[] = "mcc:1608fs-plus-pair?serial=AAAA0001&second_serial=BBBB0002";

/// Two units, wired.
struct Wired {
  Wired() {
    first.connect_sync(line);
    second.connect_sync(line);
  }
  emulator::SyncLine line;
  emulator::FsPlusEmulator first{emulator::FsPlusKind::Usb1608, "AAAA0001", moving_source()};
  emulator::FsPlusEmulator second{emulator::FsPlusKind::Usb1608, "BBBB0002", moving_source(8)};
};

struct PairBench : Bench {
  PairBench(Wired& units, const std::string& rest = "") : Bench(kPairUri + rest) {
    bus.plug(units.second);  // in the other order: the serial numbers decide
    bus.plug(units.first);
  }
};

}  // namespace dts::device::mcc::test
