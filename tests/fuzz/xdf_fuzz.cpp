// SPDX-License-Identifier: Apache-2.0
// Everything that reads recordings, over any bytes. libFuzzer calls it (scripts/fuzz), and in every build the driver beside it.
#include <cstddef>
#include <cstdint>
#include <string>

#include "dts/wire/event_json.h"
#include "fuzz/fuzz_support.h"
#include "record/old_event.h"
#include "record/recording.h"
#include "record/xdf/chunk_index.h"
#include "record/xdf/recovery.h"

namespace dts::fuzz::xdf {
namespace {

namespace record = dts::record;

void read_items(const std::string& file) {
  const auto recording = record::Recording::open(file);
  if (!recording) return;
  while (true) {
    const auto item = (*recording)->next();
    promise(item.has_value(), "what the first pass could read, the second can");
    if (!*item) return;
    if (const auto* scans = std::get_if<record::RecordedScans>(&**item))
      promise(scans->values.size() == scans->count * (*recording)->streams().at(scans->stream).channels.size(), "all values of all scans");
  }
}

void recover_and_verify(const std::string& file, const std::string& copy) {
  const auto recovery = record::recover(file, copy);
  if (!recovery) return;
  const auto checked = record::verify(copy);
  promise(checked && checked->is_closed && checked->has_index && checked->sha256 == recovery->sha256, "what was recovered is whole");
  ::unlink(copy.c_str());
  ::unlink(record::index_name(copy).c_str());
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  static const dts::fuzz::Folder folder;
  const std::string text = dts::fuzz::text_of(bytes, size);
  const std::string file = folder.file("a.xdf");
  dts::fuzz::put_file(file, text);
  (void)record::verify(file);
  read_items(file);
  recover_and_verify(file, folder.file("b.xdf"));
  (void)record::read_index(file);
  if (const auto event = record::event_of_text(text)) {
    const auto read_back = [](const v1::Event& told) {
      const std::string json = wire::to_json(told);
      return json.size() <= wire::kLongestEventJson ? wire::event_of_json(json) : std::nullopt;
    };
    const auto once = read_back(*event);  // without the sign of a zero, which the text does not keep
    const auto twice = once ? read_back(*once) : std::nullopt;
    if (twice) promise(wire::to_json(*twice) == wire::to_json(*once), "an event as text is that event");
  }
}

}  // namespace dts::fuzz::xdf

DTS_FUZZ_TARGET(xdf)
