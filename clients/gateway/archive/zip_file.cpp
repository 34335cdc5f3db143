// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/zip_file.h"

#include <archive.h>
#include <archive_entry.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "cli/try.h"
#include "gateway/access/descriptor.h"

namespace dts::gateway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPieceBytes = 1U << 16U;

using ArchivePointer = std::unique_ptr<struct archive, decltype(&archive_write_free)>;
using EntryPointer = std::unique_ptr<struct archive_entry, decltype(&archive_entry_free)>;

auto fail_with(struct archive* zip) {
  const char* why = archive_error_string(zip);
  return core::fail(core::ErrorCode::Failed, std::string("cannot write the zip file: ") + (why == nullptr ? "unknown" : why),
                    "free space in the cache directory");
}

class ZipWriter {
 public:
  ZipWriter(ArchivePointer zip, std::uint64_t most_bytes, const std::function<bool()>& is_wanted)
      : zip_(std::move(zip)), most_bytes_(most_bytes), is_wanted_(is_wanted) {}

  [[nodiscard]] core::Status open(int descriptor) {
    const bool is_open = archive_write_set_format_zip(zip_.get()) == ARCHIVE_OK &&
                         archive_write_set_options(zip_.get(), "zip:compression=deflate,zip:compression-level=1") == ARCHIVE_OK &&
                         archive_write_open_fd(zip_.get(), descriptor) == ARCHIVE_OK;
    if (!is_open) return fail_with(zip_.get());
    return {};
  }

  [[nodiscard]] core::Status add(const fs::path& file, const std::string& name) {
    const Descriptor opened(::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
    std::error_code failed;
    const auto bytes = fs::file_size(file, failed);
    if (!opened || failed) return core::fail(core::ErrorCode::Failed, "cannot read '" + file.string() + "'");
    const EntryPointer entry(archive_entry_new(), &archive_entry_free);
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes));
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0640);  // no time is set, so zip stores its zero, 1980
    if (archive_write_header(zip_.get(), entry.get()) != ARCHIVE_OK) return fail_with(zip_.get());
    std::vector<char> piece(kPieceBytes);
    for (ssize_t got = 0; (got = ::read(*opened, piece.data(), piece.size())) != 0;) {
      if (got < 0) return core::fail_errno(errno, "cannot read '" + file.string() + "'");
      if (archive_write_data(zip_.get(), piece.data(), static_cast<std::size_t>(got)) < 0) return fail_with(zip_.get());
      DTS_TRY(check());
    }
    return {};
  }

  [[nodiscard]] core::Status close() {
    if (archive_write_close(zip_.get()) != ARCHIVE_OK) return fail_with(zip_.get());
    return check();
  }

 private:
  [[nodiscard]] core::Status check() const {
    if (!is_wanted_()) return core::fail(core::ErrorCode::Failed, "the export was cancelled");
    if (static_cast<std::uint64_t>(archive_filter_bytes(zip_.get(), -1)) <= most_bytes_) return {};
    return core::fail(core::ErrorCode::LimitExceeded, "the export is too large for the gateway's cache");
  }

  ArchivePointer zip_;
  std::uint64_t most_bytes_;
  const std::function<bool()>& is_wanted_;
};

core::Result<std::vector<std::string>> names_below(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code failed;
  fs::recursive_directory_iterator entry(folder, failed);
  for (; !failed && entry != fs::recursive_directory_iterator(); entry.increment(failed)) {
    std::error_code gone;
    if (fs::is_regular_file(entry->symlink_status(gone))) names.push_back(entry->path().lexically_relative(folder).generic_string());
  }
  if (failed) return core::fail_errno(failed.value(), "cannot read '" + folder.string() + "'");
  std::ranges::sort(names);
  return names;
}

core::Status fill(ZipWriter& writer, int descriptor, const fs::path& folder) {
  DTS_TRY_ASSIGN(const auto names, names_below(folder));
  DTS_TRY(writer.open(descriptor));
  for (const std::string& name : names) {
    DTS_TRY(writer.add(folder / name, name));
  }
  return writer.close();
}

}  // namespace

core::Result<std::uint64_t> write_zip(const fs::path& folder, const fs::path& zip, std::uint64_t most_bytes,
                                      const std::function<bool()>& is_wanted) {
  const Descriptor file(::open(zip.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (!file) return core::fail_errno(errno, "cannot create '" + zip.string() + "'");
  ZipWriter writer(ArchivePointer(archive_write_new(), &archive_write_free), most_bytes, is_wanted);
  if (const auto filled = fill(writer, *file, folder); !filled) {
    ::unlink(zip.c_str());
    return tl::make_unexpected(filled.error());
  }
  std::error_code failed;
  const std::uint64_t bytes = fs::file_size(zip, failed);
  if (failed) return core::fail_errno(failed.value(), "cannot write '" + zip.string() + "'");
  return bytes;
}

}  // namespace dts::gateway
