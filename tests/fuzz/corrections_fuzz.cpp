// SPDX-License-Identifier: Apache-2.0
// Corrections of a session, as dtsd writes them beside a recording. Those that are accepted are bounded and are written as they were read.
#include "fuzz/fuzz_support.h"
#include "record/catalogue/corrections.h"

namespace dts::fuzz::corrections {

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  static const Folder folder;
  const std::string file = folder.file("s1.corrections.json");
  put_file(file, text_of(bytes, size));
  const auto read = record::read_corrections(file);
  if (!read) return promise(!read.error().what.empty(), "an error says what it is");
  promise(!read->session_id.empty() && read->all.size() <= record::kMostCorrections, "a session, and a bounded list");
  std::uint32_t number = 0;
  for (const record::Correction& one : read->all) {
    promise(one.number == ++number, "numbers count from 1");
    promise(record::name(one.field) != "unknown", "a field that is known");
    promise(one.utc_ns >= 0, "a time");
  }
  promise(record::write_corrections(file, *read).has_value(), "they can be written");
  promise(record::read_corrections(file) == read, "and are the same");
}

}  // namespace dts::fuzz::corrections

DTS_FUZZ_TARGET(corrections)
