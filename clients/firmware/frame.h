// SPDX-License-Identifier: Apache-2.0
// Frames of the DTS protocol: a payload, its CRC-32, COBS and one zero byte. The same source runs on a board and in tests on the host.
#pragma once

#include <stdint.h>

namespace firmware {

constexpr uint8_t kLargestPayload = 249;

enum class Type : uint8_t {
  kDescriptor = 0x01,
  kChannel = 0x02,
  kScans = 0x03,
  kLost = 0x04,
  kLog = 0x05,
  kDescribe = 0x81,
  kStart = 0x82,
  kStop = 0x83,
  kPattern = 0x84,
};

/// CRC-32 of IEEE 802.3, bit by bit: a table would take RAM, and the line is slower than this loop.
class Crc {
 public:
  void add(uint8_t byte) {
    value_ ^= byte;
    for (uint8_t bit = 0; bit < 8; ++bit) value_ = (value_ >> 1) ^ ((value_ & 1U) != 0 ? 0xEDB88320UL : 0UL);
  }
  uint32_t value() const { return ~value_; }

 private:
  uint32_t value_ = 0xFFFFFFFFUL;
};

/// Keeps the compiler from moving accesses to memory across it: data and the index that hands them over stay in order.
inline void barrier() { __asm__ volatile("" ::: "memory"); }

/// Bytes from one writer to one reader; either of them may be an interrupt. An index is one byte, so that it is always read whole.
class ByteRing {
 public:
  static constexpr uint8_t kCapacity = 255;

  /// Returns how many bytes the writer may add.
  uint8_t room() const { return static_cast<uint8_t>(kCapacity - static_cast<uint8_t>(written_ - read_)); }
  bool is_empty() const { return read_ == published_; }

  /// Adds a byte that the reader does not see before publish(). Returns its place for patch().
  uint8_t add(uint8_t byte) {
    bytes_[written_] = byte;
    return written_++;
  }
  void patch(uint8_t place, uint8_t byte) { bytes_[place] = byte; }
  void publish() {
    barrier();
    published_ = written_;
  }

  /// Takes the oldest byte. Call it only if the ring is not empty.
  uint8_t take() {
    const uint8_t byte = bytes_[read_];
    barrier();
    read_ = static_cast<uint8_t>(read_ + 1);
    return byte;
  }

 private:
  uint8_t bytes_[256] = {};
  uint8_t written_ = 0;
  volatile uint8_t published_ = 0;
  volatile uint8_t read_ = 0;
};

/// Writes one frame into a ring. The reader sees the frame only when it is complete.
/// The caller checks first that the ring has room for size_on_wire(payload).
class FrameWriter {
 public:
  /// Returns the bytes of a frame on the wire: payload, CRC, COBS code and zero. Payloads stay below the size at which COBS needs a second
  /// code.
  static constexpr uint8_t size_on_wire(uint8_t payload) { return static_cast<uint8_t>(payload + 6); }

  FrameWriter(ByteRing& ring, Type type) : ring_(ring), code_at_(ring.add(0)) { u8(static_cast<uint8_t>(type)); }

  void u8(uint8_t value) {
    crc_.add(value);
    put(value);
  }
  void u16(uint16_t value) {
    u8(static_cast<uint8_t>(value & 0xFFU));
    u8(static_cast<uint8_t>(value >> 8));
  }
  void u32(uint32_t value) {
    u16(static_cast<uint16_t>(value & 0xFFFFU));
    u16(static_cast<uint16_t>(value >> 16));
  }
  void i16(int16_t value) { u16(static_cast<uint16_t>(value)); }
  void f32(float value) {
    static_assert(sizeof(float) == sizeof(uint32_t), "f32 of the wire is IEEE 754 binary32");
    uint32_t bits = 0;
    __builtin_memcpy(&bits, &value, sizeof bits);
    u32(bits);
  }
  /// Writes the bytes of a text without its length.
  void bytes(const char* text) {
    for (; *text != '\0'; ++text) u8(static_cast<uint8_t>(*text));
  }
  /// Writes the length and the bytes of a text, of `most` bytes at most.
  void text(const char* value, uint8_t most) {
    uint8_t length = 0;
    while (value[length] != '\0' && length < most) ++length;
    u8(length);
    for (uint8_t i = 0; i < length; ++i) u8(static_cast<uint8_t>(value[i]));
  }

  /// Adds CRC and zero, and shows the frame to the reader.
  void end() {
    const uint32_t crc = crc_.value();
    for (uint8_t shift = 0; shift < 32; shift = static_cast<uint8_t>(shift + 8)) put(static_cast<uint8_t>((crc >> shift) & 0xFFU));
    ring_.patch(code_at_, code_);
    ring_.add(0);
    ring_.publish();
  }

 private:
  void put(uint8_t byte) {
    if (byte == 0) {
      ring_.patch(code_at_, code_);
      code_at_ = ring_.add(0);
      code_ = 1;
    } else {
      ring_.add(byte);
      ++code_;
    }
  }

  ByteRing& ring_;
  uint8_t code_at_;
  uint8_t code_ = 1;
  Crc crc_;
};

/// Collects the bytes of one command. A command that is longer than all known ones is skipped up to its zero byte.
class CommandReader {
 public:
  static constexpr uint8_t kLargestPayload = 9;  // START

  /// Adds a byte. Returns true if a whole command with a good CRC is in payload().
  bool add(uint8_t byte) {
    if (byte != 0) {
      if (length_ == sizeof bytes_) {
        is_too_long_ = true;
      } else {
        bytes_[length_++] = byte;
      }
      return false;
    }
    const bool is_good = !is_too_long_ && decode();
    length_ = 0;
    is_too_long_ = false;
    return is_good;
  }
  const uint8_t* payload() const { return bytes_; }
  uint8_t size() const { return size_; }

  /// Reads four bytes of the payload.
  uint32_t u32(uint8_t at) const {
    return static_cast<uint32_t>(bytes_[at]) | (static_cast<uint32_t>(bytes_[at + 1]) << 8) |
           (static_cast<uint32_t>(bytes_[at + 2]) << 16) | (static_cast<uint32_t>(bytes_[at + 3]) << 24);
  }

 private:
  /// Removes COBS in place: the text without it is one byte shorter. Returns false if a code points behind the end or the CRC is wrong.
  bool decode() {
    uint8_t from = 0;
    uint8_t to = 0;
    while (from < length_) {
      const uint8_t code = bytes_[from++];
      if (code - 1 > length_ - from) return false;
      for (uint8_t i = 1; i < code; ++i) bytes_[to++] = bytes_[from++];
      if (from < length_) bytes_[to++] = 0;
    }
    if (to < 5) return false;  // an empty frame is no error; a shorter one than type and CRC is damaged
    size_ = static_cast<uint8_t>(to - 4);
    Crc crc;
    for (uint8_t i = 0; i < size_; ++i) crc.add(bytes_[i]);
    return crc.value() == u32(size_);
  }

  uint8_t bytes_[kLargestPayload + 5] = {};
  uint8_t length_ = 0;
  uint8_t size_ = 0;
  bool is_too_long_ = false;
};

}  // namespace firmware
