// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "record/session_facts.h"
#include "record/xdf/byte_codec.h"
#include "record/xdf/xdf_reader.h"
#include "record/xdf/xdf_writer.h"
#include "support/sanitized.h"

/// For the tests of files: a folder of their own, small recordings, and XDF bytes made by hand.
namespace dts::record::xdf_test {

class Folder {
 public:
  Folder() {
    // In memory where there is such a place: these tests synchronise thousands of files.
    const std::filesystem::path memory = "/dev/shm";
    const auto parent = ::access(memory.c_str(), W_OK) == 0 ? memory : std::filesystem::temp_directory_path();
    std::string name = (parent / "dts-xdf-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// Tests of damage at every byte of a file take every fifth under sanitizers: numbers have 2, 4 and 8 bytes, so that each of a number's
/// bytes gets its turn.
inline constexpr std::size_t kByteStep = dts::test::kIsSanitized ? 5 : 1;

inline std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void put_file(const std::string& file, std::string_view bytes) {
  std::error_code ignored;
  std::filesystem::remove(file, ignored);  // closed recordings are read-only
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline core::Rate rate_of(std::int64_t scans, std::int64_t seconds = 1) {
  return core::Rate::create(scans, seconds).value_or(core::Rate{});
}

inline StreamInfo regular_stream(const std::string& name, std::vector<std::string> labels, core::Rate rate,
                                 ValueType type = ValueType::Double64) {
  StreamInfo info{.name = name, .content = "DTS", .value_type = type, .rate = rate};
  for (auto& label : labels) info.channels.push_back({.label = std::move(label), .unit = "V", .type = "Voltage"});
  return info;
}
inline StreamInfo events_stream(const std::string& name = "floor/events") {
  return {
      .name = name, .content = "Markers", .value_type = ValueType::Text, .channels = {{.label = "event", .unit = "", .type = "Marker"}}};
}
inline StreamInfo quality_stream(std::size_t channels = 1) {
  StreamInfo info{.name = "floor/quality", .content = "Quality", .value_type = ValueType::Int8};
  info.channels.resize(channels);
  return info;
}

inline SessionFacts floor_session() {
  SessionFacts session{.session_id = "20261121T144525Z-floor-1", .rig = "floor", .kind = "floor", .protocol = "free", .subject = "P017"};
  session.stages = {"window_filter window_scans=3 shift_scans=1"};
  return session;
}

/// A small recording as the recorder writes it: two segments of "floor/raw" at 100 Hz, a slower "floor/cop" at 50 Hz, events and quality.
/// Times are of synthetic data. Left open: `close` it, or do not.
inline std::unique_ptr<XdfWriter> small_recording(const std::string& name, double start_s = 1000.0) {
  auto writer = XdfWriter::create(name, to_facts(floor_session()));
  if (!writer) return nullptr;
  auto& file = **writer;
  const auto raw = file.add_stream(regular_stream("floor/raw", {"w1_v", "w2_v"}, rate_of(100)));
  const auto cop = file.add_stream(regular_stream("floor/cop", {"ml_mm"}, rate_of(50)));
  const auto events = file.add_stream(events_stream());
  const auto quality = file.add_stream(quality_stream());
  const std::vector<double> four_scans = {1, -1, 2, -2, 3, -3, 4, -4};
  const std::vector<double> two_values = {0.5, 0.25};
  const auto segment = [&](std::uint32_t number, std::uint64_t first_scan, double time_s) {
    // As dtsd 0.1 recorded it: tests know the length of the file to the byte.
    const std::string event =
        "{\"event\":\"segment\",\"segment\":" + std::to_string(number) + ",\"scan\":" + std::to_string(first_scan) + "}";
    const std::vector<std::pair<double, std::string>> texts = {{time_s, event}};
    return file.write_texts(events, texts, {.segment = number, .first_scan = {first_scan}});
  };
  const std::vector<double> quality_times_s = {start_s + 0.02};
  const std::vector<double> quality_values = {3};
  bool is_fine = segment(0, 40, start_s) && file.write_samples(raw, start_s, four_scans, {.segment = 0, .first_scan = {40}});
  is_fine = is_fine && file.write_samples(cop, start_s, two_values, {.segment = 0, .first_scan = {20}});
  is_fine = is_fine && file.write_timed(quality, quality_times_s, quality_values, {.segment = 0, .first_scan = {42}});
  is_fine = is_fine && file.write_samples(raw, start_s + 0.04, four_scans, {.segment = 0, .first_scan = {44}});
  is_fine = is_fine && file.write_clock_offset(raw, start_s + 0.05, -1.5e-6) && file.write_boundary();
  is_fine =
      is_fine && segment(1, 0, start_s + 0.5) && file.write_samples(raw, start_s + 0.5, four_scans, {.segment = 1, .first_scan = {0}});
  is_fine = is_fine && file.write_samples(cop, start_s + 0.5, two_values, {.segment = 1, .first_scan = {0}});
  return is_fine ? std::move(*writer) : nullptr;
}

/// All chunks up to the end or the first error.
struct ReadFile {
  std::vector<Chunk> chunks;
  std::uint64_t end = 0;
  core::Error error{};  ///< Its `what` is empty when there is none.
};
inline ReadFile read_all(const std::string& file) {
  ReadFile read;
  auto reader = XdfReader::open(file);
  if (!reader) {
    read.error = reader.error();
    return read;
  }
  while (true) {
    auto chunk = (*reader)->next();
    read.end = (*reader)->offset();
    if (!chunk) read.error = chunk.error();
    if (!chunk || !*chunk) return read;
    read.chunks.push_back(std::move(**chunk));
  }
}
template <class Content>
std::vector<Content> contents(const ReadFile& read) {
  std::vector<Content> found;
  for (const auto& chunk : read.chunks)
    if (const auto* content = std::get_if<Content>(&chunk.content)) found.push_back(*content);
  return found;
}

/// By hand, with a length prefix of any size.
inline std::string raw_chunk(std::uint16_t tag, const std::string& content, int length_bytes = 4) {
  std::string bytes(1, static_cast<char>(length_bytes));
  const std::uint64_t length = content.size() + 2;
  for (int byte = 0; byte < length_bytes; ++byte) bytes.push_back(static_cast<char>((length >> (8 * byte)) & 0xFFU));
  put(bytes, tag);
  return bytes + content;
}
inline std::string number_bytes(std::uint32_t number) {
  std::string bytes;
  put(bytes, number);
  return bytes;
}
inline std::string file_start(const std::string& version = "1.0") {
  return std::string(kMagic) + raw_chunk(1, "<?xml version=\"1.0\"?><info><version>" + version + "</version></info>", 1);
}
inline std::string header_chunk(std::uint32_t stream, const std::string& format, const std::string& rate_hz, const std::string& channels,
                                const std::string& name = "EEG") {
  return raw_chunk(2, number_bytes(stream) + "<?xml version=\"1.0\"?><info><name>" + name + "</name><type>EEG</type><channel_count>" +
                          channels + "</channel_count><nominal_srate>" + rate_hz + "</nominal_srate><channel_format>" + format +
                          "</channel_format><desc/></info>");
}

}  // namespace dts::record::xdf_test
