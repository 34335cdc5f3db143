// SPDX-License-Identifier: Apache-2.0
// Boards that lie. The input decides how the device is configured and which bytes arrive when; an honest fake board answers the commands in
// between, and its bytes may be damaged.
//
// Input: [form][options piece], then steps: [what][...]. See `step`.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include "board/fake_board_device.h"
#include "device/board/board_options.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::serial {
namespace {

constexpr std::size_t kLongestOptions = 100;
constexpr std::int64_t kMsNs = core::kNanosecondsPerMillisecond;
constexpr std::array<const char*, 6> kForms{"channels=4",
                                            "channels=2&marker=1",
                                            "channels=4&format=lines&rate_hz=100",
                                            "channels=4&format=lines&rate_hz=100&counter=1&counter_bits=16",
                                            "channels=4&format=lines&rate_hz=100&counter=1",
                                            "channels=4&format=lines&rate_hz=100&time_us=1"};

/// What is delivered is in order, and its time goes on.
class Reader {
 public:
  explicit Reader(std::size_t channels) : block_(channels, 16) {}

  device::ReadOutcome read(device::Device& device, const core::Clock& clock) {
    const device::ReadResult result = device.read(block_, clock.now_ns() + 50 * kMsNs);
    promise((result.outcome == device::ReadOutcome::Scans) == (block_.count() > 0), "scans, or why there are none");
    if (result.outcome == device::ReadOutcome::Gap) next_scan_ = 0;
    if (block_.count() == 0) return result.outcome;
    promise(block_.first_scan.value == next_scan_, "scans are numbered without a hole");
    promise(next_scan_ == 0 || block_.host_time_ns > host_time_ns_, "time goes on");
    host_time_ns_ = block_.host_time_ns;
    next_scan_ += block_.count();
    for (std::size_t channel = 0; channel < block_.channel_count(); ++channel) {
      for (std::size_t i = 0; i < block_.count(); ++i) {
        promise(std::isfinite(block_.column(channel)[i]) || block_.quality(channel)[i] != 0, "a value is a number, or says why not");
      }
    }
    return result.outcome;
  }
  void restart() { next_scan_ = 0; }

 private:
  core::Block block_;
  std::uint64_t next_scan_ = 0;
  std::int64_t host_time_ns_ = 0;
};

void change(dts::test::OwnedFakeLink& link, core::VirtualClock& clock, fuzz::Pieces& pieces) {
  dts::test::FakeBoard& board = link.board();
  switch (pieces.byte() % 8) {
    case 0: {  // bytes as they are
      const std::string_view bytes = pieces.piece();
      return board.send_bytes({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    }
    case 1: {  // a payload in a good frame
      const std::string_view bytes = pieces.piece().substr(0, device::board::kMostPayload);
      if (bytes.empty()) return;
      return board.send_payload({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    }
    case 2: return board.reset(clock.now_ns());
    case 3: link.link().damage.flip = pieces.byte() * 1e-3; return;
    case 4: board.set_counter(pieces.byte() * 0x01010101U); return;
    case 5: board.drop_output(); return;
    case 6: clock.advance_ns(pieces.byte() * 10 * kMsNs); return;
    default: link.link().is_plugged = pieces.byte() % 4 != 0; return;
  }
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  const std::string input = fuzz::text_of(bytes, size);
  fuzz::Pieces pieces(input);
  const std::string form = kForms[pieces.byte() % kForms.size()];
  const std::string_view more = pieces.piece();
  if (more.size() > kLongestOptions) return;
  const auto uri = device::DeviceUri::parse("serial:fake?" + form + (more.empty() ? "" : "&") + std::string(more));
  if (!uri) return;
  auto options = device::board::read_board_options(*uri, true);
  if (!options) return;
  core::VirtualClock clock(core::kNanosecondsPerSecond);
  dts::test::FakeBoardSetup setup;
  setup.speaks_lines = options->speaks_lines;
  setup.channels = options->description.channels.size();
  setup.has_counter = options->lines.first_column == device::board::FirstColumn::Counter;
  setup.has_time = options->lines.first_column == device::board::FirstColumn::TimeUs;
  setup.counter_bits = options->lines.counter_bits;
  if (options->marker) setup.constant_channel = static_cast<int>(*options->marker);
  auto owned = std::make_unique<dts::test::OwnedFakeLink>(setup, clock);
  dts::test::OwnedFakeLink& link = *owned;
  device::board::BoardDevice device(std::move(*options), std::move(owned), clock);
  Reader reader(device.describe().channels.size());
  const double rate_hz = std::max(100.0, device.describe().minimum_rate_hz);
  for (int step = 0; step < 40 && !pieces.is_over(); ++step) {
    if (device.state() == device::DeviceState::Gone) (void)device.close();
    if (device.state() == device::DeviceState::Closed && !device.open()) {
      change(link, clock, pieces);
      continue;
    }
    if (device.state() == device::DeviceState::Open) {
      const auto started = device.start({core::Rate::from_hz(rate_hz).value(), 16});
      if (!started) {
        (void)device.close();
        change(link, clock, pieces);
        continue;
      }
      reader.restart();
    }
    change(link, clock, pieces);
    if (reader.read(device, clock) == device::ReadOutcome::Broken) {
      promise(reader.read(device, clock) == device::ReadOutcome::Broken, "broken stays broken");
      (void)device.stop();
    }
    for (const device::DeviceCheck& check : device.report().checks) promise(!check.name.empty(), "a check has a name");
  }
  (void)device.close();
  promise(device.state() == device::DeviceState::Closed, "close closes");
}

}  // namespace dts::fuzz::serial

DTS_FUZZ_TARGET(serial)
