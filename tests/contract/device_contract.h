// SPDX-License-Identifier: Apache-2.0
// What the device contract is checked on and with.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "board/fake_board_device.h"
#include "core/clock.h"
#include "device/registry.h"
#include "unit/device/replay/made_recording.h"
#include "unit/device/sim_rig.h"
#include "usb/emulator/fs_plus_emulator.h"
#include "usb/emulator/u6_emulator.h"
#include "usb/emulator/usb1608g_emulator.h"
#include "usb/fake/fake_bus.h"

namespace dts::device::contract {

inline constexpr std::int64_t kMillisecond = core::kNanosecondsPerMillisecond;
inline constexpr std::int64_t kSecond = 1000 * kMillisecond;

using Units = std::vector<std::unique_ptr<emulator::EmulatedDevice>>;

/// One device and how to make it misbehave within its first seconds; empty: this device cannot be made to.
struct DeviceUnderTest {
  const char* name;
  const char* uri;
  const char* unplugging_uri;
  const char* gapping_uri;
  Units (*make_units)() = [] { return Units(); };  ///< What must be plugged in; then the plug is pulled, and no URI does it.
  bool comes_back = true;                          ///< A lost one can be opened again later; a recording that has ended cannot.
  /// How the device is made of its URI; null: by the registry.
  std::unique_ptr<Device> (*make_device)(std::string_view uri, core::Clock& clock) = nullptr;
};

inline void PrintTo(const DeviceUnderTest& tested, std::ostream* out) { *out << tested.name; }

inline double load_v = 0.0;  ///< On every input.

/// Something moves on every input, and no two inputs are alike.
inline void fill_inputs(double time_s, std::span<double> volts) {
  for (std::size_t input = 0; input < volts.size(); ++input) {
    volts[input] = load_v + 0.2 * static_cast<double>(input + 1) + 0.05 * std::sin(time_s + static_cast<double>(input));
  }
}

template <emulator::FsPlusKind kind>
Units fs_plus() {
  Units units;
  units.push_back(std::make_unique<emulator::FsPlusEmulator>(kind, "01A2B3C4", fill_inputs));
  return units;
}

inline Units u6() {
  Units units;
  units.push_back(std::make_unique<emulator::U6Emulator>(fill_inputs));
  return units;
}

template <std::uint16_t product>
Units usb_1608g() {
  Units units;
  units.push_back(std::make_unique<emulator::Usb1608gEmulator>(product, "01A2B3C4", fill_inputs));
  return units;
}

/// Two units and the wire between their SYNC pins.
inline Units pair() {
  static emulator::SyncLine line;
  line = {};
  Units units;
  for (const char* serial : {"0000000A", "0000000B"}) {
    auto unit = std::make_unique<emulator::FsPlusEmulator>(emulator::FsPlusKind::Usb1608, serial, fill_inputs);
    unit->connect_sync(line);
    units.push_back(std::move(unit));
  }
  return units;
}

/// The address of a 1608G of some kind. Its file stands for the maker's image, which is not ours to ship: the emulated unit looks at the
/// length only.
inline const char* fpga_image(const std::string& kind) {
  static std::map<std::string, std::string> uris;
  std::string& uri = uris[kind];
  if (uri.empty()) {
    const std::string file = testing::TempDir() + "dts_contract_fpga_" + std::to_string(getpid());
    std::ofstream(file, std::ios::binary) << std::string(73'829, 'x');
    uri = kind + "?serial=01A2B3C4&fpga=" + file;
  }
  return uri.c_str();
}

/// Recordings to play, made once: a minute, half a second, and one with a gap.
struct Recordings {
  Recordings() {
    std::string name = testing::TempDir() + "dts_contract_replay_XXXXXX";
    folder = mkdtemp(name.data());
    const core::Gap gap{.reason = core::GapReason::Overrun, .missing_scans = 70, .is_exact = true};
    const auto make = [&](const char* file, std::vector<test::MadeSegment> segments) {
      return "replay:" + test::make_recording({.sensors = 3, .aux = 0, .segments = std::move(segments)}, folder + file);
    };
    whole = make("/whole.xdf", {{.scans = 6000}});
    ending = make("/ending.xdf", {{.scans = 50}});
    gapping = make("/gapping.xdf", {{.scans = 50}, {.scans = 6000, .gap = gap}});
  }
  ~Recordings() { std::filesystem::remove_all(folder); }

  std::string folder;
  std::string whole;
  std::string ending;
  std::string gapping;
};

inline const Recordings& recordings() {
  static const Recordings made;
  return made;
}

/// A board that speaks over a link in memory: the device above the link is under test, and the scheme of the address is only a label.
/// `board_real_test.cpp` of the unit tests has real links.
inline DeviceUnderTest board(const char* name, const char* uri, const char* unplugging_uri, const char* gapping_uri) {
  DeviceUnderTest tested{name, uri, unplugging_uri, gapping_uri};
  tested.make_device = dts::test::make_fake_board_device;
  return tested;
}

inline const std::array kDevices = {
    DeviceUnderTest{"sim_floor", "sim:floor", "sim:floor?fault=unplug&fault_at_s=0.5&fault_for_s=1",
                    "sim:floor?fault=overrun&fault_at_s=0.5&fault_for_s=0.7"},
    DeviceUnderTest{"sim_floor_16", "sim:floor?extra=12&clock_ppm=80&contact=point",
                    "sim:floor?extra=12&fault=unplug&fault_at_s=0&fault_for_s=0.001",
                    "sim:floor?extra=12&fault=silence&fault_at_s=0.2&fault_for_s=3"},
    DeviceUnderTest{"sim_chair", "sim:chair?aux=emg&clock_ppm=-30&sit_down_s=0.1", "sim:chair?fault=unplug&fault_at_s=0.5&fault_for_s=1",
                    "sim:chair?fault=overrun&fault_at_s=0.5&fault_for_s=0.7"},
    DeviceUnderTest{"sim_stack_floor", "sim:stack?clock_ppm=100&offset_s=1.3", "sim:stack?fault=unplug&fault_at_s=0.5&fault_for_s=1",
                    "sim:stack?fault=overrun&fault_at_s=0.5&fault_for_s=0.7"},
    DeviceUnderTest{"sim_stack_plate", "sim:stack?part=plate&step_on_s=0.1",
                    "sim:stack?part=plate&fault=unplug&fault_at_s=0.5&fault_for_s=1",
                    "sim:stack?part=plate&fault=silence&fault_at_s=0.2&fault_for_s=3"},
    DeviceUnderTest{.name = "replay",
                    .uri = recordings().whole.c_str(),
                    .unplugging_uri = recordings().ending.c_str(),
                    .gapping_uri = recordings().gapping.c_str(),
                    .comes_back = false},
    DeviceUnderTest{"mcc_1608fs_plus", "mcc:1608fs-plus?serial=01A2B3C4&channels=0,1,2,3", "", "", fs_plus<emulator::FsPlusKind::Usb1608>},
    DeviceUnderTest{"mcc_1208fs_plus", "mcc:1208fs-plus?serial=01A2B3C4", "", "", fs_plus<emulator::FsPlusKind::Usb1208>},
    DeviceUnderTest{"mcc_usb_205", "mcc:usb-205?serial=01A2B3C4&channels=1,2,5", "", "", fs_plus<emulator::FsPlusKind::Usb205>},
    DeviceUnderTest{"mcc_1608g", fpga_image("mcc:1608g"), "", "", usb_1608g<0x0110>},
    DeviceUnderTest{"mcc_pair", "mcc:1608fs-plus-pair?serial=0000000A&second_serial=0000000B", "", "", pair},
    DeviceUnderTest{"labjack_u6", "labjack:u6?serial=360004242&channels=0,1,2,3", "", "", u6},
    board("serial_frames", "serial:/dev/fake?channels=4", "serial:/dev/unplugging?channels=4",
          "serial:/dev/gapping?channels=4&baud=1000000"),
    board("serial_lines", "serial:/dev/fake?channels=4&format=lines&rate_hz=100",
          "serial:/dev/unplugging?channels=4&format=lines&rate_hz=100", "serial:/dev/gapping?channels=4&format=lines&rate_hz=100"),
    board("tcp_frames", "tcp:fake:1?channels=32&marker=5", "tcp:unplugging:1?channels=32", "tcp:gapping:1?channels=1"),
    board("tcp_lines", "tcp:fake:1?channels=2&format=lines&rate_hz=100&counter=1&counter_bits=16",
          "tcp:unplugging:1?channels=2&format=lines&rate_hz=100&counter=1", "tcp:gapping:1?channels=2&format=lines&rate_hz=100&counter=1"),
    board("exec_frames", "exec:fake?channels=4&rate_hz=100", "exec:unplugging?channels=4&rate_hz=100",
          "exec:gapping?channels=4&rate_hz=100"),
    board("exec_lines", "exec:fake?channels=4&format=lines&rate_hz=100&time_us=1",
          "exec:unplugging?channels=4&format=lines&rate_hz=100&time_us=1", "exec:gapping?channels=4&format=lines&rate_hz=100&time_us=1"),
};

/// Calls `on_sleep` before the first wait: somebody else acts at exactly that moment.
class ClockWithVisitor final : public core::Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return clock_.now_ns(); }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override {
    if (auto visit = std::exchange(on_sleep, nullptr)) visit();
    clock_.sleep_until_ns(deadline_ns);
  }

  std::function<void()> on_sleep;

 private:
  core::VirtualClock clock_{kSecond};
};

class DeviceContract : public testing::TestWithParam<DeviceUnderTest> {
 protected:
  DeviceContract() : units_(GetParam().make_units()) {
    load_v = 0.0;
    for (const auto& unit : units_) bus_.plug(*unit);
  }

  [[nodiscard]] bool is_on_usb() const { return !units_.empty(); }

  std::unique_ptr<Device> create(std::string_view uri) { return create_on(uri, clock_); }

  std::unique_ptr<Device> create_on(std::string_view uri, core::Clock& clock) {
    if (GetParam().make_device != nullptr) return GetParam().make_device(uri, clock);
    auto device = create_device(uri, {clock, rig_, &bus_});
    EXPECT_TRUE(device.has_value()) << (device ? "" : core::to_string(device.error()));
    return device ? std::move(*device) : nullptr;
  }

  static StartOptions usual(const Device& device, std::size_t max_block_scans = 64) {
    return {test::rate_of(std::clamp(100.0, device.describe().minimum_rate_hz, device.describe().maximum_rate_hz)), max_block_scans};
  }

  static core::Block block_for(const Device& device, std::size_t capacity) { return {device.describe().channels.size(), capacity}; }

  std::unique_ptr<Device> streaming(std::string_view uri) {
    auto device = create(uri);
    EXPECT_TRUE(device->open().has_value());
    EXPECT_TRUE(device->start(usual(*device)).has_value());
    return device;
  }

  /// A device that will be gone, by itself or because its plug is pulled.
  std::unique_ptr<Device> leaving() {
    auto device = streaming(is_on_usb() ? GetParam().uri : GetParam().unplugging_uri);
    if (is_on_usb()) bus_.unplug(*units_.back());
    return device;
  }

  /// Reads until the device says that it is gone.
  std::unique_ptr<Device> gone() {
    auto device = leaving();
    core::Block block = block_for(*device, 64);
    ReadResult read;
    for (int i = 0; i < 1000 && read.outcome != ReadOutcome::Gone; ++i) read = device->read(block, clock_.now_ns() + kSecond);
    EXPECT_EQ(read.outcome, ReadOutcome::Gone);
    EXPECT_EQ(read.gap.reason, core::GapReason::Unplugged);
    return device;
  }

  void bring_back() {
    clock_.advance_ns(3600 * kSecond);
    if (is_on_usb()) bus_.plug(*units_.back());
  }

  bool can_unplug() const { return is_on_usb() || GetParam().unplugging_uri[0] != '\0'; }

  core::VirtualClock clock_{kSecond};
  physics::RigModel rig_ = test::stack_rig();
  Units units_;  ///< They outlive the bus.
  emulator::FakeBus bus_{clock_};
};

inline core::ErrorCode code(const core::Status& status) { return status ? core::ErrorCode{} : status.error().code; }
inline core::ErrorCode code(const core::Result<core::Rate>& result) { return result ? core::ErrorCode{} : result.error().code; }

/// Returns false for a device that cannot know the serial number of its unit: a board that sends lines does not say it.
inline bool knows_its_serial(const Device& device) { return device.describe().uri.find("format=lines") == std::string::npos; }

/// The state table as a model: what the next state and the answer must be.
struct Model {
  /// Any operation that speaks with the device may find out that it was unplugged, not only `read`.
  bool may_leave_anywhere = false;
  DeviceState state = DeviceState::Closed;
  bool was_opened = false;

  void check_report(const Device& device) const {
    const bool has_serial = !device.report().serial.empty();  // one that needs no hardware may know it before
    EXPECT_TRUE(has_serial || !was_opened || !knows_its_serial(device));
  }

  /// A device that has no such line says so where others take the command.
  void check_sync_output(Device& device, bool is_high) const {
    const core::ErrorCode answer = code(device.set_sync_output(is_high));
    if (state == DeviceState::Closed) {
      EXPECT_EQ(answer, core::ErrorCode::WrongState);
    } else if (state == DeviceState::Gone) {
      EXPECT_EQ(answer, core::ErrorCode::DeviceGone);
    } else if (answer != core::ErrorCode::DeviceGone) {  // it has left, and nobody has read that yet
      EXPECT_TRUE(answer == core::ErrorCode{} || answer == core::ErrorCode::Unsupported);
    }
  }

  void check_open(Device& device) {
    const core::Status opened = device.open();
    if (state == DeviceState::Gone) {
      EXPECT_EQ(code(opened), core::ErrorCode::WrongState);
    } else if (opened) {
      state = state == DeviceState::Closed ? DeviceState::Open : state;
      was_opened = true;
    } else {
      EXPECT_EQ(state, DeviceState::Closed);
      const bool has_left = may_leave_anywhere && code(opened) == core::ErrorCode::DeviceGone;  // while it was asked
      EXPECT_TRUE(has_left || code(opened) == core::ErrorCode::NotFound);                       // unplugged and not back yet
    }
  }

  void check_start(Device& device, const StartOptions& options) {
    const auto started = device.start(options);
    if (state == DeviceState::Open && may_leave_anywhere && code(started) == core::ErrorCode::DeviceGone) {
      state = DeviceState::Gone;
    } else if (state == DeviceState::Open) {
      EXPECT_TRUE(started.has_value());
      state = DeviceState::Streaming;
    } else {
      EXPECT_EQ(code(started), state == DeviceState::Gone ? core::ErrorCode::DeviceGone : core::ErrorCode::WrongState);
    }
  }

  void check_read(Device& device, core::Block& block, std::int64_t deadline_ns) {
    const ReadOutcome outcome = device.read(block, deadline_ns).outcome;
    if (state == DeviceState::Gone) {
      EXPECT_EQ(outcome, ReadOutcome::Gone);
    } else if (state != DeviceState::Streaming) {
      EXPECT_EQ(outcome, ReadOutcome::NotStreaming);
    } else {
      EXPECT_NE(outcome, ReadOutcome::NotStreaming);
      if (outcome == ReadOutcome::Gone) state = DeviceState::Gone;
    }
    EXPECT_EQ(block.count() > 0, outcome == ReadOutcome::Scans);
  }

  void check_stop(Device& device) {
    EXPECT_TRUE(device.stop().has_value());
    if (state != DeviceState::Streaming) return;
    const bool has_left = may_leave_anywhere && device.state() == DeviceState::Gone;
    state = has_left ? DeviceState::Gone : DeviceState::Open;
  }

  void check_close(Device& device) {
    EXPECT_TRUE(device.close().has_value());
    state = DeviceState::Closed;
  }
};

}  // namespace dts::device::contract
