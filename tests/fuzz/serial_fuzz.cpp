// SPDX-License-Identifier: Apache-2.0
// Boards that lie. The input decides how the device is configured and which bytes arrive when; an honest fake board answers the commands in
// between, and its bytes may be damaged.
//
// Input: [form][options piece], then steps: [what][...]. See `step`.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
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

/// What is known of the scans that arrive, after what the input has changed.
struct Truth {
  int constant_channel = -1;
  bool are_values_known = true;  ///< No byte has arrived that is not the fake board's.
  bool is_order_known = true;    ///< The board counts its scans, one after the other.
};

/// What is delivered is what the fake board has made, in order, and its time goes on.
class Reader {
 public:
  Reader(std::size_t channels, const Truth& truth) : block_(channels, 16), truth_(truth) {}

  device::ReadOutcome read(device::Device& device, const core::Clock& clock) {
    const std::int64_t deadline_ns = clock.now_ns() + 50 * kMsNs;
    const device::ReadResult result = device.read(block_, deadline_ns);
    promise((result.outcome == device::ReadOutcome::Scans) == (block_.count() > 0), "scans, or why there are none");
    promise(result.outcome != device::ReadOutcome::Timeout || clock.now_ns() >= deadline_ns, "without scans, read waits");
    promise(clock.now_ns() <= deadline_ns + 10 * kMsNs, "read returns at its deadline");
    if (result.outcome != device::ReadOutcome::Scans && result.outcome != device::ReadOutcome::Timeout) restart();
    if (block_.count() == 0) return result.outcome;
    if (truth_.are_values_known) check_values();
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
  void restart() {
    next_scan_ = 0;
    last_counter_.reset();
  }

 private:
  void check_values() {
    for (std::size_t scan = 0; scan < block_.count(); ++scan) {
      const bool shows_its_origin = block_.channel_count() >= 4 && (truth_.constant_channel < 0 || truth_.constant_channel > 3);
      const auto counter = static_cast<std::uint32_t>(code(0, scan) | (shows_its_origin ? code(3, scan) << 15 : 0));
      const auto run = static_cast<std::uint8_t>(shows_its_origin ? code(1, scan) - 1 : 0);
      if (shows_its_origin) {
        const bool is_made = has_made(run, counter, scan) || has_made(run, counter | 1U << 30U, scan) ||
                             has_made(run, counter | 2U << 30U, scan) || has_made(run, counter | 3U << 30U, scan);
        promise(is_made, "a scan is one that the board has made");
      }
      const std::uint32_t mask = shows_its_origin ? 0x3FFFFFFFU : 0x7FFFU;
      if (truth_.is_order_known && last_counter_) promise(counter == ((*last_counter_ + 1U) & mask), "no scan is missing without a gap");
      last_counter_ = counter;
    }
  }
  /// The codes show 30 bits of the counter only.
  [[nodiscard]] bool has_made(std::uint8_t run, std::uint32_t counter, std::size_t scan) const {
    for (std::size_t channel = 0; channel < block_.channel_count(); ++channel) {
      const bool is_constant = static_cast<int>(channel) == truth_.constant_channel;
      if (!is_constant && code(channel, scan) != dts::test::fake_code(run, counter, channel)) return false;
    }
    return true;
  }
  [[nodiscard]] int code(std::size_t channel, std::size_t scan) const {
    const double value = block_.column(channel)[scan];
    const auto found = static_cast<std::int16_t>(std::clamp(std::lround(value / (5.0 / 32767.0)), -32768L, 32767L));
    promise(dts::test::fake_value(found) == value, "a value is one that the board has made");
    return found;
  }

  core::Block block_;
  const Truth& truth_;
  std::optional<std::uint32_t> last_counter_;  ///< Of the newest scan in this segment.
  std::uint64_t next_scan_ = 0;
  std::int64_t host_time_ns_ = 0;
};

void change(dts::test::OwnedFakeLink& link, core::VirtualClock& clock, fuzz::Pieces& pieces, Truth& truth) {
  dts::test::FakeBoard& board = link.board();
  const int what = pieces.byte() % 8;
  const bool is_time = what == 6;
  // Nothing protects lines, so two pieces of different lines can form a good one.
  if (what <= 1 || (board.setup().speaks_lines && !is_time && what != 4)) truth.are_values_known = false;
  if (what == 4) truth.is_order_known = false;  // it changes in the middle of a frame
  switch (what) {
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
  Truth truth{.constant_channel = setup.constant_channel, .is_order_known = !setup.speaks_lines || setup.has_counter};
  Reader reader(device.describe().channels.size(), truth);
  const double rate_hz = std::max(100.0, device.describe().minimum_rate_hz);
  for (int step = 0; step < 40 && !pieces.is_over(); ++step) {
    if (device.state() == device::DeviceState::Gone) (void)device.close();
    if (device.state() == device::DeviceState::Closed && !device.open()) {
      change(link, clock, pieces, truth);
      continue;
    }
    if (device.state() == device::DeviceState::Open) {
      const auto started = device.start({core::Rate::from_hz(rate_hz).value(), 16});
      if (!started) {
        (void)device.close();
        change(link, clock, pieces, truth);
        continue;
      }
      reader.restart();
    }
    change(link, clock, pieces, truth);
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
