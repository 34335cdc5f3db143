// SPDX-License-Identifier: Apache-2.0
// Everything that reads recordings, over any bytes. libFuzzer calls it (scripts/fuzz), and in every build the driver beside it.
#include <stdlib.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "record/event.h"
#include "record/recording.h"
#include "record/xdf/chunk_index.h"
#include "record/xdf/recovery.h"

namespace {

namespace record = dts::record;

/// One folder for the whole run, in memory where there is such a place.
class Folder {
 public:
  Folder() {
    std::string name = ::access("/dev/shm", W_OK) == 0 ? "/dev/shm/dts-fuzz-XXXXXX" : "/tmp/dts-fuzz-XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// A promise that is broken is as much of a find as a crash.
void promise(bool is_kept) {
  if (!is_kept) std::abort();
}

void put_file(const std::string& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void read_items(const std::string& file) {
  const auto recording = record::Recording::open(file);
  if (!recording) return;
  while (true) {
    const auto item = (*recording)->next();
    promise(item.has_value());  // what the first pass could read, the second can
    if (!*item) return;
    if (const auto* scans = std::get_if<record::RecordedScans>(&**item))
      promise(scans->values.size() == scans->count * (*recording)->streams().at(scans->stream).channels.size());
  }
}

void recover_and_verify(const std::string& file, const std::string& copy) {
  const auto recovery = record::recover(file, copy);
  if (!recovery) return;
  const auto checked = record::verify(copy);
  promise(checked && checked->is_closed && checked->has_index && checked->sha256 == recovery->sha256);
  ::unlink(copy.c_str());
  ::unlink(record::index_name(copy).c_str());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const Folder folder;
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  const std::string file = folder.file("a.xdf");
  put_file(file, text);
  (void)record::verify(file);
  read_items(file);
  recover_and_verify(file, folder.file("b.xdf"));
  (void)record::read_index(file);
  if (const auto event = record::event_of_json(std::string(text))) {
    const std::string json = record::to_json(*event);
    if (json.size() <= 64U << 10U) promise(record::to_json(record::event_of_json(json).value()) == json);
  }
  return 0;
}
