// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/chunk_index.h"

#include <array>
#include <boost/crc.hpp>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <limits>

#include "record/xdf/number_text.h"

namespace dts::record {
namespace {

constexpr std::size_t kMaxLineBytes = 1024;  ///< A double written with %f has at most 309 digits before its point.

/// Removes the next word from the line and returns it; empty if there is none, or if there is more than one space before it.
std::string_view read_word(std::string_view& line) noexcept {
  const std::size_t end = std::min(line.find(' '), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(std::min(end + 1, line.size()));
  return word;
}

template <class Number>
bool read_number(std::string_view& line, Number& number) noexcept {
  const auto read = number_of<Number>(read_word(line));
  if (read) number = *read;
  return read.has_value();
}

bool read_hex(std::string_view& line, std::uint32_t& number) noexcept {
  const std::string_view word = read_word(line);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number, 16);
  return error == std::errc{} && word.size() == 8 && end == word.data() + word.size();
}

}  // namespace

std::string to_line(const ChunkNote& note) {
  std::array<char, kMaxLineBytes> line{};
  const int length =
      std::snprintf(line.data(), line.size(), "%llu %llu %08x %u %u %llu %llu %.9f", static_cast<unsigned long long>(note.offset),
                    static_cast<unsigned long long>(note.length), note.crc32c, note.stream, note.segment,
                    static_cast<unsigned long long>(note.first_scan), static_cast<unsigned long long>(note.samples), note.time_s);
  return {line.data(), static_cast<std::size_t>(std::max(length, 0))};
}

std::optional<ChunkNote> note_of_line(std::string_view line) {
  ChunkNote note;
  const bool is_whole = line.size() < kMaxLineBytes && !line.empty() && line.back() != ' ' && read_number(line, note.offset) &&
                        read_number(line, note.length) && read_hex(line, note.crc32c) && read_number(line, note.stream) &&
                        read_number(line, note.segment) && read_number(line, note.first_scan) && read_number(line, note.samples) &&
                        read_number(line, note.time_s) && line.empty() && std::isfinite(note.time_s);
  return is_whole ? std::optional(note) : std::nullopt;
}

IndexReader::IndexReader(const std::string& file) : file_(file, std::ios::binary) {}

std::optional<ChunkNote> IndexReader::next() {
  if (is_over_ || !file_.is_open()) return std::nullopt;
  is_over_ = true;
  std::array<char, kMaxLineBytes> line{};
  file_.getline(line.data(), line.size());
  if (!file_ || file_.eof()) return std::nullopt;  // too long, or no line end: torn
  const auto note = note_of_line(std::string_view(line.data(), static_cast<std::size_t>(file_.gcount()) - 1));
  const bool continues = note && note->offset == next_offset_ && note->length <= std::numeric_limits<std::uint64_t>::max() - note->offset;
  if (!continues) return std::nullopt;
  next_offset_ = note->offset + note->length;
  is_over_ = false;
  return note;
}

core::Result<std::vector<ChunkNote>> read_index(const std::string& file) {
  errno = 0;
  IndexReader reader(file);
  if (!reader.is_open()) return core::fail_errno(errno, "cannot read the index " + file);
  std::vector<ChunkNote> notes;
  while (const auto note = reader.next()) notes.push_back(*note);
  return notes;
}

std::string index_name(const std::string& recording) {
  const bool is_part = recording.ends_with(kPart);
  return recording.substr(0, recording.size() - (is_part ? kPart.size() : 0)) + ".idx";
}

std::uint32_t crc32c(std::string_view bytes) noexcept {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

}  // namespace dts::record
