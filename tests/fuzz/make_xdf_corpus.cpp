// SPDX-License-Identifier: Apache-2.0
// make_xdf_corpus FOLDER writes the seeds of the XDF fuzzer: small recordings, synthetic, one for each thing that a file may hold.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "record/session_facts.h"
#include "record/xdf/byte_codec.h"
#include "record/xdf/recovery.h"
#include "record/xdf/xdf_writer.h"

namespace {

namespace fs = std::filesystem;
using namespace dts::record;

const SessionFacts kSession{.session_id = "20261121T144525Z-floor-1", .rig = "floor", .kind = "floor", .protocol = "free"};
const std::vector<double> kValues = {1, 2, 3, 4};

StreamInfo stream(const std::string& name, ValueType type, bool is_regular) {
  StreamInfo info{.name = name, .content = "DTS", .value_type = type, .channels = {{.label = "a_v", .unit = "V", .type = "Voltage"}}};
  if (is_regular) info.rate = dts::core::Rate::create(100, 1).value();
  return info;
}

bool write_type(const fs::path& folder, const std::string& name, ValueType type) {
  auto writer = XdfWriter::create(folder / (name + ".xdf"), {});
  if (!writer) return false;
  const auto number = (*writer)->add_stream(stream("x/raw", type, true));
  return (*writer)->write_samples(number, 5.0, kValues, {}) && (*writer)->write_samples(number, 5.04, kValues, {}) && (*writer)->close();
}

std::unique_ptr<XdfWriter> session(const fs::path& file) {
  auto writer = XdfWriter::create(file, to_facts(kSession)).value();
  const auto raw = writer->add_stream(stream("floor/raw", ValueType::Float32, true));
  const auto events = writer->add_stream(stream("floor/events", ValueType::Text, false));
  const auto quality = writer->add_stream(stream("floor/quality", ValueType::Int8, false));
  const std::vector<std::pair<double, std::string>> first = {{9.0, R"({"scan":"7","segment_start":{}})"}};
  const std::vector<std::pair<double, std::string>> second = {{19.0, R"({"segment":1,"segment_start":{}})"}, {19.5, "press"}};
  const std::vector<double> times_s = {9.01};
  const std::vector<double> bits = {3};
  const bool is_written = writer->write_texts(events, first, {}) && writer->write_samples(raw, 9.0, kValues, {}) &&
                          writer->write_timed(quality, times_s, bits, {}) && writer->write_clock_offset(raw, 9.02, 1e-6) &&
                          writer->write_boundary() && writer->write_texts(events, second, {}) &&
                          writer->write_samples(raw, 19.0, kValues, {});
  return is_written ? std::move(writer) : nullptr;
}

bool write_sessions(const fs::path& folder) {
  const fs::path killed = folder / "killed.xdf";
  session(killed)->abandon();
  const bool is_recovered = recover(killed.string() + ".part", folder / "recovered.xdf").has_value();
  fs::rename(killed.string() + ".part", killed);
  return is_recovered && session(folder / "closed.xdf")->close() && session(folder / "incomplete.xdf")->close_incomplete("disk full");
}

std::string chunk(std::uint16_t tag, const std::string& content) {
  std::string bytes;
  put_length(bytes, content.size() + 2);
  put(bytes, tag);
  return bytes + content;
}

/// Two texts a sample, stamps here and there, a tag of nobody's, no footers: what other programs may do.
void write_foreign(const fs::path& file) {
  const std::string one("\1\0\0\0", 4);
  const std::string two("\2\0\0\0", 4);
  std::string bytes = "XDF:" + chunk(1, "<?xml version=\"1.0\"?><info><version>1.0</version></info>");
  bytes += chunk(2, one +
                        "<info><name>m</name><channel_count>2</channel_count><nominal_srate>0</nominal_srate><channel_format>string</"
                        "channel_format></info>");
  bytes += chunk(2, two +
                        "<info><name>e</name><channel_count>1</channel_count><nominal_srate>250.0</nominal_srate><channel_format>int16</"
                        "channel_format></info>");
  bytes += chunk(3, one + std::string("\1\1\0\1\1a\1\0", 8));
  std::string samples = two + std::string("\4\3\0\0\0\10", 6);
  put(samples, 5.0);
  bytes += chunk(3, samples + std::string("\1\0\0\2\0\0\3\0", 8)) + chunk(99, "?") + chunk(4, two + std::string(16, '\1'));
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  const fs::path folder = arguments[1];
  fs::create_directories(folder);
  constexpr std::pair<const char*, ValueType> kTypes[] = {{"double64", ValueType::Double64},
                                                          {"int8", ValueType::Int8},
                                                          {"int16", ValueType::Int16},
                                                          {"int32", ValueType::Int32},
                                                          {"int64", ValueType::Int64}};
  bool is_written = write_sessions(folder);
  for (const auto& [name, type] : kTypes) is_written = write_type(folder, name, type) && is_written;
  write_foreign(folder / "foreign.xdf");
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".idx") {
      fs::remove(entry.path());
    } else {
      fs::permissions(entry.path(), fs::perms{0644});
    }
  if (!is_written) std::fprintf(stderr, "a seed could not be written: are there old ones in %s?\n", folder.c_str());
  return is_written ? 0 : 1;
}
