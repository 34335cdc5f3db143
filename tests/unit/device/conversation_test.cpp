// SPDX-License-Identifier: Apache-2.0
// What each driver asks of its unit from opening to closing, call by call; what the user is told when one call fails; what the report says.
// The expected texts are in conversations/: the calls as the vendors' sources give them, with their bytes and time limits.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/committed_text.h"
#include "unit/device/description_text.h"
#include "unit/device/mcc/pair_bench.h"
#include "unit/device/sim_rig.h"
#include "usb/emulator/u6_emulator.h"
#include "usb/emulator/usb1608g_emulator.h"

namespace dts::device::conversation {
namespace {

using emulator::FsPlusEmulator;
using emulator::FsPlusKind;
using mcc::test::Bench;
using mcc::test::moving_source;
using usb::UsbResult;
using usb::UsbStatus;

constexpr std::uint16_t kRevision1 = 0x0110;
constexpr std::uint16_t kRevision2 = 0x0134;

/// A device on its bus with its units.
struct Life {
  std::vector<std::shared_ptr<void>> units;
  std::unique_ptr<Bench> bench;
  double rate_hz = 1500.0;
  std::size_t block_scans = 64;
};

/// With the beginning of the hint.
std::string told(const char* operation, const core::Error& error) {
  const std::string hint = error.hint.empty() ? "" : " (" + error.hint.substr(0, error.hint.find_first_of(",;:")) + ")";
  return std::string(operation) + ": " + std::string(core::name(error.code)) + ": " + error.what + hint;
}

/// Opens, starts, drives the sync output, stops; the first error in words, or "fine".
std::string live(const Life& life, std::string& step) {
  Device& device = *life.bench->device;
  step = "open";
  if (const auto opened = device.open(); !opened) return told("open", opened.error());
  step = "start";
  const auto started = device.start({*core::Rate::from_hz(life.rate_hz), life.block_scans});
  if (!started) return told("start", started.error());
  step = "sync";
  const auto driven = device.describe().has_sync_output ? device.set_sync_output(true) : core::Status{};
  if (!driven) return told("sync", driven.error());
  step = "stop";
  const auto stopped = device.stop();
  return stopped ? "fine" : told("stop", stopped.error());
}

std::string live(const Life& life) {
  std::string step;
  return live(life, step);
}

/// Runs open, start, sync and stop once; the calls from `first` to `last` get `answer` instead of the device's. Afterwards nothing is open,
/// and the next run succeeds.
std::string live_with(const Life& life, const UsbResult& answer, std::size_t first, std::size_t last) {
  std::size_t number = 0;
  life.bench->bus.on_call = [&](const std::string&) {
    const std::size_t at = number++;
    return at >= first && at <= last ? std::optional(answer) : std::nullopt;
  };
  const std::string error = live(life);
  life.bench->bus.on_call = nullptr;
  EXPECT_TRUE(life.bench->device->close().has_value());
  EXPECT_EQ(life.bench->bus.transfers_in_flight(), 0);
  EXPECT_EQ(life.bench->bus.open_ports(), 0);
  EXPECT_EQ(live(life), "fine");
  return error;
}

struct Call {
  std::string step;
  std::string words;
  std::size_t count = 1;  ///< So many in a row.
  std::size_t first = 0;
};

std::vector<Call> calls_of(const Life& life) {
  std::vector<Call> calls;
  std::size_t number = 0;
  std::string step;
  life.bench->bus.on_call = [&](const std::string& words) {
    if (!calls.empty() && calls.back().words == words && calls.back().step == step)
      ++calls.back().count;
    else
      calls.push_back({step, words, 1, number});
    ++number;
    return std::nullopt;
  };
  EXPECT_EQ(live(life, step), "fine");
  life.bench->bus.on_call = nullptr;
  return calls;
}

/// One line for every call, and behind it what the user is told when the device refuses it alone.
std::string told_calls(const std::function<Life()>& make) {
  std::ostringstream text;
  const std::vector<Call> calls = calls_of(make());
  for (const Call& call : calls) {
    SCOPED_TRACE(call.words);
    text << call.step << ": " << call.words;
    if (call.count > 1) text << ", " << call.count << " times";
    const std::string error = live_with(make(), tl::make_unexpected(UsbStatus::Stall), call.first, call.first);
    text << (error == "fine" ? "" : "\n    " + error) << '\n';
    static_cast<void>(live_with(make(), tl::make_unexpected(UsbStatus::TimedOut), call.first, call.first));
    const bool is_request = call.words.starts_with("in") || call.words.starts_with("out");
    if (is_request && error != "fine") {
      EXPECT_NE(live_with(make(), 999, call.first, call.first).find(" 999 of "), std::string::npos) << "another number of bytes";
    }
    const std::string gone =
        live_with(make(), tl::make_unexpected(UsbStatus::NoDevice), call.first, calls.back().first + calls.back().count);
    const bool may_be_gone = call.step == "stop" || call.words.find("transfers") != std::string::npos;
    EXPECT_EQ(gone.find("device_gone") != std::string::npos, !may_be_gone) << gone;
  }
  return text.str();
}

/// What it says of itself, after some seconds of scans.
std::string report(const Life& life) {
  Bench& bench = *life.bench;
  bench.start(life.rate_hz, life.block_scans);
  core::Block block(bench.device->describe().channels.size(), life.block_scans);
  for (double scans = 0.0; scans < 4.0 * life.rate_hz; scans += static_cast<double>(block.count())) {
    if (bench.device->read(block, bench.clock.now_ns() + mcc::test::kSecond).outcome != ReadOutcome::Scans) break;
  }
  const auto driven = bench.device->set_sync_output(true);
  return test::text_of(bench.device->describe()) + (driven ? "" : told("sync", driven.error()) + "\n") + "runs at " +
         std::to_string(bench.rate.numerator()) + " / " + std::to_string(bench.rate.denominator()) + " Hz\n" +
         test::text_of(bench.device->report());
}

template <class Unit, class... Arguments>
std::function<Life()> one(const std::string& uri, double rate_hz, std::size_t block_scans, Arguments... arguments) {
  return [=] {
    auto unit = std::make_shared<Unit>(arguments..., moving_source());
    return Life{{unit}, std::make_unique<Bench>(uri, *unit), rate_hz, block_scans};
  };
}

Life pair() {
  auto units = std::make_shared<mcc::test::Wired>();
  return {{units}, std::make_unique<mcc::test::PairBench>(*units, "&sync_output_bit=0&channels=0,1&second_channels=6,7"), 1500, 64};
}

/// A file as long as an FPGA image.
std::string image() {
  const std::string path = testing::TempDir() + "conversation_" + std::to_string(getpid()) + ".rbf";
  std::ofstream(path, std::ios::binary) << std::string(73'829, '\x5A');
  return path;
}

/// The unit that a name stands for, and how it is asked.
std::function<Life()> life_of(const std::string& name, const std::string& fpga) {
  const std::string serial = "01A2B3C4";
  const auto fs_plus = [&serial](FsPlusKind kind, const std::string& uri, double rate_hz = 1500, std::size_t block_scans = 64) {
    return one<FsPlusEmulator>(uri, rate_hz, block_scans, kind, serial);
  };
  const std::map<std::string, std::function<Life()>> lives = {
      {"usb_1608fs_plus", fs_plus(FsPlusKind::Usb1608, "mcc:1608fs-plus?channels=0,2,5,7&range_v=10,5,2,1&sync_output_bit=3&sync_pin=out")},
      {"usb_1608fs_plus_slow", fs_plus(FsPlusKind::Usb1608, "mcc:1608fs-plus?channels=1,6&trigger=falling", 100, 2)},
      {"usb_1208fs_plus", fs_plus(FsPlusKind::Usb1208, "mcc:1208fs-plus?channels=1,6&sync_output_bit=5")},
      {"usb_204", fs_plus(FsPlusKind::Usb204, "mcc:usb-204?channels=0,3,7")},
      {"usb_1608g",
       one<emulator::Usb1608gEmulator>("mcc:1608g?channels=15,3,8,0&range_v=1,2,5,10&trigger=rising&sync_output_bit=7&fpga=" + fpga, 1500,
                                       64, 0x0110, serial)},
      {"usb_1608g_slow", one<emulator::Usb1608gEmulator>("mcc:1608g?channels=4,9&fpga=" + fpga, 20, 1, 0x0110, serial)},
      {"u6", one<emulator::U6Emulator>("labjack:u6?channels=0,1,2,3&range_v=10,1,0.1,0.01,10&digital=1&marker=15&marker_v=0", 1500, 64)},
      {"u6_slow", one<emulator::U6Emulator>("labjack:u6?channels=13,8", 20, 1)},
      {"joined_pair", pair},
  };
  return lives.at(name);
}

class Conversation : public testing::TestWithParam<const char*> {};

TEST_P(Conversation, EveryCallOfALifeAndWhatIsToldWhenItFails) {
  const std::string fpga = image();
  const auto make = life_of(GetParam(), fpga);
  std::string found = told_calls(make) + report(make());
  std::remove(fpga.c_str());
  if (const std::size_t at = found.find(fpga); at != std::string::npos) found.replace(at, fpga.size(), "IMAGE");
  dts::test::expect_committed(std::string("unit/device/conversations/") + GetParam() + ".txt", found, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Units, Conversation,
                         testing::Values("usb_1608fs_plus", "usb_1608fs_plus_slow", "usb_1208fs_plus", "usb_204", "usb_1608g",
                                         "usb_1608g_slow", "u6", "u6_slow", "joined_pair"),
                         [](const auto& unit) { return std::string(unit.param); });

/// What a unit does wrong before it is opened.
template <class Unit>
struct Wrong {
  const char* name;
  std::function<void(Unit&)> harm;
};

/// How opening and starting end with each: the whole error, how long it took, and the state.
template <class Unit, class... Arguments>
std::string told_of(const std::vector<Wrong<Unit>>& rows, const std::string& uri, Arguments... arguments) {
  std::string text;
  for (const Wrong<Unit>& row : rows) {
    Unit unit(arguments..., moving_source());
    row.harm(unit);
    Life life{{}, std::make_unique<Bench>(uri, unit)};
    const std::int64_t before_ns = life.bench->clock.now_ns();
    text += std::string(row.name) + ", " + live(life);
    text += " after " + std::to_string((life.bench->clock.now_ns() - before_ns) / mcc::test::kMillisecond) + " ms, in state " +
            std::to_string(static_cast<int>(life.bench->device->state())) + "\n";
    EXPECT_TRUE(life.bench->device->close().has_value());
    EXPECT_EQ(life.bench->bus.open_ports(), 0);
  }
  return text;
}

template <class Unit>
std::vector<Wrong<Unit>> wrong_of_all() {
  return {{"well", [](Unit&) {}},
          {"mute", [](Unit& unit) { unit.faults.is_mute = true; }},
          {"one request is lost", [](Unit& unit) { unit.faults.silent_control_requests = 1; }},
          {"calibration is garbage", [](Unit& unit) { unit.faults.is_calibration_garbage = true; }},
          {"calibration is cut", [](Unit& unit) { unit.faults.calibration_bytes = 20; }}};
}

TEST(WrongUnit, AtOpenAndStart_IsToldAsItsFileSays) {
  const std::string fpga = image();
  auto fs_plus = wrong_of_all<FsPlusEmulator>();
  fs_plus.push_back({"ignores ranges", [](FsPlusEmulator& unit) { unit.ignores_ranges = true; }});
  std::string found = told_of(fs_plus, "mcc:1608fs-plus", FsPlusKind::Usb1608, "01A2B3C4");
  found += told_of<FsPlusEmulator>({{"another product", [](FsPlusEmulator&) {}}}, "mcc:1608fs-plus", FsPlusKind::Usb1208, "01AB");
  found +=
      told_of<FsPlusEmulator>({{"another serial number", [](FsPlusEmulator&) {}}}, "mcc:1608fs-plus?serial=7", FsPlusKind::Usb1608, "01AB");
  auto g = wrong_of_all<emulator::Usb1608gEmulator>();
  g.push_back({"ignores the scan list", [](emulator::Usb1608gEmulator& unit) { unit.ignores_scan_list = true; }});
  found += told_of(g, "mcc:1608g?fpga=" + fpga, kRevision1, "0123ABCD");
  found += told_of<emulator::Usb1608gEmulator>({{"no image", [](emulator::Usb1608gEmulator&) {}}}, "mcc:1608g", kRevision1, "0123ABCD");
  found += told_of<emulator::Usb1608gEmulator>({{"an image of revision 1", [](emulator::Usb1608gEmulator&) {}}}, "mcc:1608g?fpga=" + fpga,
                                               kRevision2, "0123ABCD");
  auto u6 = wrong_of_all<emulator::U6Emulator>();
  for (const std::size_t bytes : {1U, 10U}) {
    u6.push_back({"replies are cut", [bytes](emulator::U6Emulator& unit) { unit.quirks.reply_bytes = bytes; }});
  }
  for (std::uint64_t reply = 0; reply < 10; ++reply) {
    u6.push_back({"a reply is damaged", [reply](emulator::U6Emulator& unit) { unit.quirks.reply_to_damage = reply; }});
  }
  found += told_of(u6, "labjack:u6");
  std::remove(fpga.c_str());
  for (std::size_t at = found.find(fpga); at != std::string::npos; at = found.find(fpga)) found.replace(at, fpga.size(), "IMAGE");
  dts::test::expect_committed("unit/device/wrong_units.txt", found);
}

/// When and how the end of a stream is told, to the nanosecond: of each fault, at each rate.
template <class Unit, class... Arguments>
std::string ends_of(const std::string& uri, std::size_t channels, Arguments... arguments) {
  using emulator::Faults;
  constexpr std::array<std::pair<const char*, std::uint64_t Faults::*>, 7> kFaults = {{{"silence", &Faults::silence_at_code},
                                                                                       {"stall", &Faults::stall_at_code},
                                                                                       {"overrun", &Faults::overrun_at_code},
                                                                                       {"odd packet", &Faults::short_packet_at_code},
                                                                                       {"babble", &Faults::babble_at_code},
                                                                                       {"lost packet", &Faults::drop_packet_at_code},
                                                                                       {"lost code", &Faults::drop_code_at}}};
  std::string text;
  for (const auto& [name, fault] : kFaults) {
    for (const auto& [rate_hz, at_scan] : {std::pair{10.0, 0}, {10.0, 20}, {100.0, 90}, {1500.0, 900}}) {
      Unit unit(arguments..., moving_source());
      unit.faults.*fault = static_cast<std::uint64_t>(at_scan) * channels;
      Bench bench(uri, unit);
      bench.start(rate_hz, 16);
      core::Block block(channels, 16);
      const std::int64_t start_ns = bench.clock.now_ns();
      std::uint64_t scans = 0;
      ReadResult read;
      do {
        read = bench.device->read(block, bench.clock.now_ns() + 100 * mcc::test::kMillisecond);
        scans += block.count();
      } while ((read.outcome == ReadOutcome::Scans || read.outcome == ReadOutcome::Timeout) &&
               bench.clock.now_ns() < start_ns + 8 * mcc::test::kSecond);
      text += std::string(name) + " at scan " + std::to_string(at_scan) + " of " + std::to_string(rate_hz) + " Hz: outcome " +
              std::to_string(static_cast<int>(read.outcome)) + ", " + std::string(core::name(read.gap.reason)) + ", " +
              std::to_string(read.gap.missing_scans) + " missing, " + std::to_string(scans) + " scans, after " +
              std::to_string(bench.clock.now_ns() - start_ns) + " ns\n";
      EXPECT_TRUE(bench.device->close().has_value());
    }
  }
  return text;
}

TEST(EndOfAStream, OfEachFault_IsToldWhenAndAsTheFileSays) {
  const std::string fpga = image();
  dts::test::expect_committed("unit/device/ends.txt",
                              ends_of<FsPlusEmulator>("mcc:1608fs-plus?channels=0,1,2", 3, FsPlusKind::Usb1608, "01A2B3C4") +
                                  ends_of<emulator::Usb1608gEmulator>("mcc:1608g?channels=0,1,2&fpga=" + fpga, 3, kRevision1, "0123ABCD") +
                                  ends_of<emulator::U6Emulator>("labjack:u6?channels=0,1&marker=15&marker_v=0", 3));
  std::remove(fpga.c_str());
}

}  // namespace
}  // namespace dts::device::conversation
