// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/crc.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "firmware/frame.h"

namespace firmware::test {

using Bytes = std::vector<uint8_t>;

inline uint32_t crc_of(const Bytes& bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

inline Bytes with_crc(Bytes payload) {
  const uint32_t crc = crc_of(payload);
  for (unsigned shift = 0; shift < 32; shift += 8) payload.push_back(static_cast<uint8_t>((crc >> shift) & 0xFFU));
  return payload;
}

/// COBS as in the paper, with the zero byte at the end.
inline Bytes encoded(const Bytes& payload) {
  Bytes frame;
  Bytes part;
  for (const uint8_t byte : with_crc(payload)) {
    if (byte != 0) {
      part.push_back(byte);
      continue;
    }
    frame.push_back(static_cast<uint8_t>(part.size() + 1));
    frame.insert(frame.end(), part.begin(), part.end());
    part.clear();
  }
  frame.push_back(static_cast<uint8_t>(part.size() + 1));
  frame.insert(frame.end(), part.begin(), part.end());
  frame.push_back(0);
  return frame;
}

/// Returns the payload of a frame without its zero byte; nullopt if it is damaged.
inline std::optional<Bytes> decoded(const Bytes& frame) {
  Bytes data;
  for (std::size_t at = 0; at < frame.size();) {
    const std::size_t code = frame[at];
    if (code == 0 || at + code > frame.size()) return std::nullopt;
    data.insert(data.end(), frame.begin() + static_cast<std::ptrdiff_t>(at + 1), frame.begin() + static_cast<std::ptrdiff_t>(at + code));
    at += code;
    if (at < frame.size()) data.push_back(0);
  }
  if (data.size() < 5) return std::nullopt;
  const Bytes payload(data.begin(), data.end() - 4);
  return with_crc(payload) == data ? std::optional(payload) : std::nullopt;
}

/// Takes all bytes out of a ring and returns the payloads of its frames.
inline std::vector<Bytes> take_frames(ByteRing& ring) {
  std::vector<Bytes> payloads;
  Bytes frame;
  while (!ring.is_empty()) {
    const uint8_t byte = ring.take();
    if (byte != 0) {
      frame.push_back(byte);
    } else if (!frame.empty()) {
      payloads.push_back(decoded(frame).value());
      frame.clear();
    }
  }
  return payloads;
}

inline uint32_t u32_at(const Bytes& payload, std::size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, payload.data() + at, sizeof value);
  return value;
}

inline int16_t i16_at(const Bytes& payload, std::size_t at) {
  int16_t value = 0;
  std::memcpy(&value, payload.data() + at, sizeof value);
  return value;
}

inline Bytes u32_bytes(uint32_t value) {
  Bytes bytes(4);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

}  // namespace firmware::test
