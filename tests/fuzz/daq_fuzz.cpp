// SPDX-License-Identifier: Apache-2.0
// USB DAQs that lie. An emulated one answers as its sheet says, and the input decides what becomes of each answer and each packet on the
// way to the device driver: what stands in the URI, opening, starting, reading and ending a scan must bear all of it.
//
// Input: [which][options of the URI, see Pieces] then one byte per answer: 0..199 as it is, else what `distort` says.
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "device/registry.h"
#include "fuzz/fuzz_support.h"
#include "physics/rig_model.h"
#include "usb/emulator/fs_plus_emulator.h"
#include "usb/emulator/u6_emulator.h"
#include "usb/emulator/usb1608g_emulator.h"
#include "usb/fake/fake_bus.h"

namespace dts::fuzz::daq {
namespace {


constexpr std::size_t kLongestOptions = 200;
constexpr std::int64_t kSecondNs = core::kNanosecondsPerSecond;
constexpr double kLargestVolts = 1e6;  // of a channel; a digital word counts to 65535
constexpr int kMostReads = 40;

void half_way(double, std::span<double> volts) { std::fill(volts.begin(), volts.end(), 0.5); }

/// An emulated device whose words are changed as the input says.
class Liar final : public emulator::EmulatedDevice {
 public:
  Liar(std::unique_ptr<emulator::EmulatedDevice> honest, fuzz::Pieces lies) : honest_(std::move(honest)), lies_(lies) {}

  [[nodiscard]] const emulator::Descriptors& descriptors() const override { return honest_->descriptors(); }
  void power_up(std::int64_t now_ns) override { honest_->power_up(now_ns); }
  [[nodiscard]] emulator::ControlReply control(const emulator::Setup& setup, std::span<const std::uint8_t> data,
                                               std::int64_t now_ns) override {
    emulator::ControlReply reply = honest_->control(setup, data, now_ns);
    if (distort(reply.data)) reply.kind = emulator::ReplyKind::Stall;
    return reply;
  }
  void bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, std::int64_t now_ns) override {
    honest_->bulk_out(endpoint, bytes, now_ns);
  }
  [[nodiscard]] std::optional<emulator::Packet> take_packet(std::uint8_t endpoint, std::int64_t now_ns) override {
    auto packet = honest_->take_packet(endpoint, now_ns);
    if (packet && distort(packet->bytes)) packet->is_stall = true;
    return packet;
  }
  void clear_halt(std::uint8_t endpoint) override { honest_->clear_halt(endpoint); }
  [[nodiscard]] std::int64_t next_packet_ns(std::int64_t now_ns) const override { return honest_->next_packet_ns(now_ns); }
  [[nodiscard]] bool wants_to_leave() override { return honest_->wants_to_leave(); }

 private:
  /// True: it stalls instead.
  bool distort(std::vector<std::uint8_t>& bytes) {
    const std::uint8_t lie = lies_.byte();
    if (lie < 200) return false;
    if (lie == 255) return true;
    const std::size_t at = lies_.byte();
    if (lie < 220 && !bytes.empty()) {
      bytes[at % bytes.size()] = lies_.byte();
    } else if (lie < 230) {
      bytes.resize(at % (bytes.size() + 1));
    } else if (lie < 240) {
      bytes.resize(bytes.size() + at % 8, 0xFF);
    } else {
      const std::string_view instead = lies_.piece();
      std::copy_n(instead.begin(), std::min(instead.size(), bytes.size()), bytes.begin());
    }
    return false;
  }

  std::unique_ptr<emulator::EmulatedDevice> honest_;
  fuzz::Pieces lies_;
};

struct Kind {
  const char* uri;
  std::unique_ptr<emulator::EmulatedDevice> (*make)();
};

template <emulator::FsPlusKind kind>
std::unique_ptr<emulator::EmulatedDevice> make_fs_plus() {
  return std::make_unique<emulator::FsPlusEmulator>(kind, "01A2B3C4", half_way);
}
std::unique_ptr<emulator::EmulatedDevice> make_u6() { return std::make_unique<emulator::U6Emulator>(half_way); }
std::unique_ptr<emulator::EmulatedDevice> make_1608g() {
  return std::make_unique<emulator::Usb1608gEmulator>(0x0110, "01A2B3C4", half_way);
}

const std::array<Kind, 5> kKinds{{{"labjack:u6", make_u6},
                                  {"mcc:1608fs-plus", make_fs_plus<emulator::FsPlusKind::Usb1608>},
                                  {"mcc:1208fs-plus", make_fs_plus<emulator::FsPlusKind::Usb1208>},
                                  {"mcc:usb-204", make_fs_plus<emulator::FsPlusKind::Usb204>},
                                  {"mcc:1608g", make_1608g}}};

/// What is delivered is in order, finite, and not of before.
class Witness {
 public:
  explicit Witness(std::size_t channels) : block_(channels, 16) {}

  device::ReadResult read(device::Device& device, const core::Clock& clock) {
    const device::ReadResult result = device.read(block_, clock.now_ns() + kSecondNs / 4);
    promise((result.outcome == device::ReadOutcome::Scans) == (block_.count() > 0), "scans, or why there are none");
    if (result.outcome == device::ReadOutcome::Gap) next_scan_ = 0;
    if (block_.count() == 0) return result;
    promise(block_.first_scan.value == next_scan_, "scans are numbered without a hole");
    promise(next_scan_ == 0 || block_.host_time_ns > host_time_ns_, "time goes on");
    host_time_ns_ = block_.host_time_ns;
    next_scan_ += block_.count();
    for (std::size_t channel = 0; channel < block_.channel_count(); ++channel) {
      for (const double value : std::as_const(block_).column(channel)) promise(std::abs(value) <= kLargestVolts, "a value is a number");
    }
    return result;
  }
  void restart() { next_scan_ = 0; }

 private:
  core::Block block_;
  std::uint64_t next_scan_ = 0;
  std::int64_t host_time_ns_ = 0;
};

void look_at(const device::DeviceReport& report) {
  for (const device::DeviceCheck& check : report.checks) promise(!check.name.empty(), "a check has a name");
}

void run(device::Device& device, const core::Clock& clock) {
  Witness witness(device.describe().channels.size());
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (!device.open()) break;
    const auto rate = device.start(
        {.rate = core::Rate::from_hz(device.describe().minimum_rate_hz < 100.0 ? 100.0 : 1000.0).value(), .max_block_scans = 16});
    if (!rate) break;
    promise(rate->hz() > 0.0, "a rate is one");
    witness.restart();
    auto outcome = device::ReadOutcome::Scans;
    for (int read = 0; read < kMostReads && outcome != device::ReadOutcome::Broken && outcome != device::ReadOutcome::Gone; ++read) {
      outcome = witness.read(device, clock).outcome;
    }
    if (outcome == device::ReadOutcome::Broken) promise(witness.read(device, clock).outcome == outcome, "broken stays broken");
    look_at(device.report());
    (void)device.stop();
  }
  (void)device.close();
  promise(device.state() == device::DeviceState::Closed, "close closes");
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  const std::string input = fuzz::text_of(bytes, size);
  fuzz::Pieces pieces(input);
  const Kind& kind = kKinds[pieces.byte() % kKinds.size()];
  const std::string_view options = pieces.piece();
  if (options.size() > kLongestOptions) return;
  core::VirtualClock clock(kSecondNs);
  Liar unit(kind.make(), pieces);
  emulator::FakeBus bus(clock);
  const physics::RigModel rig;
  const auto device =
      device::create_device(std::string(kind.uri) + (options.empty() ? "" : "?") + std::string(options), {clock, rig, &bus});
  if (!device) return;
  bus.plug(unit);
  run(**device, clock);
  promise(bus.transfers_in_flight() == 0, "no transfer is left behind");
}

}  // namespace dts::fuzz::daq

DTS_FUZZ_TARGET(daq)
