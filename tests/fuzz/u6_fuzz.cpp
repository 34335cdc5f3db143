// SPDX-License-Identifier: Apache-2.0
// LabJack U6: stream packets and calibration constants. How the bytes are cut into transfers and how much room there is for codes changes
// nothing of what is read.
//
// Input: [channels][samples per packet][flags: 1 packets get right checksums, 2 and a right header and counter][room][cut] packets.
#include <array>
#include <cmath>
#include <vector>

#include "device/labjack/u6_calibration.h"
#include "device/labjack/u6_frames.h"
#include "device/labjack/u6_stream.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::u6 {
namespace {

using namespace dts::device::labjack;

using Bytes = std::vector<std::uint8_t>;

struct Shape {
  std::size_t channels = 1;
  std::size_t samples = 1;
  [[nodiscard]] std::size_t packet_bytes() const noexcept { return 14 + 2 * samples; }
};

/// Random packets hardly ever have two right checksums: where the input asks for it they get them.
void seal(Bytes& bytes, const Shape& shape, bool is_whole_header) {
  std::uint8_t counter = 0;
  for (std::size_t at = 0; at + shape.packet_bytes() <= bytes.size(); at += shape.packet_bytes()) {
    const auto packet = std::span(bytes).subspan(at, shape.packet_bytes());
    if (is_whole_header) {
      packet[1] = 0xF9;
      packet[2] = static_cast<std::uint8_t>(4 + shape.samples);
      packet[3] = 0xC0;
      packet[10] = counter++;
    }
    const std::uint16_t sum = checksum16(packet.subspan(6));
    packet[4] = static_cast<std::uint8_t>(sum & 0xFFU);
    packet[5] = static_cast<std::uint8_t>(sum >> 8U);
    packet[0] = checksum8(packet.subspan(1, 5));
  }
}

/// What a reader finds: codes, and where something happened among them.
struct Found {
  std::vector<std::uint16_t> codes;
  struct Fault {
    std::size_t at = 0;
    core::GapReason reason = core::GapReason::None;
    bool goes_on = false;
    std::uint64_t discarded_scans = 0;
    friend bool operator==(const Fault&, const Fault&) = default;
  };
  std::vector<Fault> faults;
  friend bool operator==(const Found&, const Found&) = default;
};

/// False: the stream has ended.
bool feed(StreamParser& parser, std::span<const std::uint8_t> bytes, std::size_t room, Found& found) {
  std::vector<std::uint16_t> codes(room);
  while (!bytes.empty()) {
    const device::usb::Unpacked unpacked = parser.unpack(bytes, codes);
    promise(unpacked.bytes <= bytes.size() && unpacked.codes <= room, "no more is taken than given, and no more given than there is room");
    promise(unpacked.bytes > 0 || unpacked.codes > 0 || unpacked.fault != core::GapReason::None, "it goes on");
    found.codes.insert(found.codes.end(), codes.begin(), codes.begin() + static_cast<std::ptrdiff_t>(unpacked.codes));
    if (unpacked.fault != core::GapReason::None) {
      found.faults.push_back({found.codes.size(), unpacked.fault, unpacked.goes_on, unpacked.discarded_scans});
      if (!unpacked.goes_on) return false;
    }
    bytes = bytes.subspan(unpacked.bytes);
  }
  return true;
}

Found read_all(const Shape& shape, const Bytes& bytes, std::size_t room, std::size_t cut) {
  StreamParser parser;
  parser.restart(shape.channels, shape.samples);
  Found found;
  for (std::size_t at = 0; at < bytes.size(); at += cut) {
    if (!feed(parser, std::span(bytes).subspan(at, std::min(cut, bytes.size() - at)), room, found)) break;
  }
  return found;
}

void check_calibration(const std::string& text) {
  constexpr std::array<std::size_t, 4> kAllGains{0, 1, 2, 3};
  Bytes blocks(text.begin(), text.end());
  blocks.resize(kCalibrationBlocks * kCalibrationBlockBytes);
  for (std::size_t gains = 1; gains <= kAllGains.size(); ++gains) {
    const auto in_use = std::span(kAllGains).first(gains);
    const auto calibration = Calibration::parse(blocks, in_use);
    if (!calibration) continue;
    for (const std::size_t gain : in_use) {
      for (const unsigned code : {0U, 1U, 0x7FFFU, 0x8000U, 0xFFFEU, 0xFFFFU}) {
        promise(std::abs(calibration->volts(gain, static_cast<std::uint16_t>(code))) <= 1.5 * kRangesV[gain], "a voltage of the range");
      }
    }
  }
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  const std::string input = fuzz::text_of(bytes, size);
  fuzz::Pieces pieces(input);
  const Shape shape{.channels = 1U + pieces.byte() % kMaximumSamplesPerPacket, .samples = 1U + pieces.byte() % kMaximumSamplesPerPacket};
  const std::uint8_t flags = pieces.byte();
  const std::size_t room = 1U + pieces.byte();
  const std::size_t cut = 1U + pieces.byte();
  Bytes packets(pieces.rest().begin(), pieces.rest().end());
  if ((flags & 1U) != 0) seal(packets, shape, (flags & 2U) != 0);
  const Found whole = read_all(shape, packets, 100'000, packets.size() + 1);
  promise(whole == read_all(shape, packets, room, cut), "transfers and room change nothing");
  check_calibration(std::string(pieces.rest()));
}

}  // namespace dts::fuzz::u6

DTS_FUZZ_TARGET(u6)
