// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/staging.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>

#include "files/whole_file.h"
#include "fleet/hub/durable_file.h"
#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::hub {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kStagedMode = 0640;
constexpr std::size_t kMostOfferBytes = 4096;
constexpr off64_t kWriteBackBytes = 8 * 1024 * 1024;

/// Reads the offer in a file NAME.offer of a clinic's folder.
std::optional<Staging::Upload> read_staged(const fs::path& file) {
  const std::string clinic = file.parent_path().filename().string();
  const auto sum = wire::bytes_of_hex(file.stem().string());
  const auto bytes = files::read_whole_file(file.string(), kMostOfferBytes);
  if (!sum || !bytes || !wire::is_clinic_name(clinic)) return std::nullopt;
  auto offer = wire::decode_offer(*bytes);
  if (!offer || offer->sha256() != *sum) return std::nullopt;
  Staging::Upload upload{.name = {clinic, *sum}, .offer = *std::move(offer)};
  struct stat status {};
  const bool has_content = ::stat(fs::path(file).replace_extension(".part").c_str(), &status) == 0;
  if (!has_content && ::stat(file.c_str(), &status) != 0) return std::nullopt;
  if (has_content) upload.have = static_cast<std::uint64_t>(status.st_size);
  upload.changed_utc_ns = std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
  if (upload.have > upload.offer.bytes()) return std::nullopt;
  return upload;
}

/// Writes without synchronising. If this fails, the file ends at `offset`, or after correct bytes of `data`.
core::Status write_at(const std::string& path, std::uint64_t offset, std::string_view data) {
  const int opened = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kStagedMode);
  if (opened < 0) return core::fail_errno(errno, "cannot open '" + path + "'", "check the disk");
  int error = 0;
  std::size_t written = 0;
  while (written < data.size() && error == 0) {
    const ssize_t count = ::pwrite(opened, data.data() + written, data.size() - written, static_cast<off_t>(offset + written));
    if (count > 0) written += static_cast<std::size_t>(count);
    if (count < 0 && errno != EINTR) error = errno;
    if (count == 0) error = ENOSPC;
  }
  if (error != 0 && ::ftruncate(opened, static_cast<off_t>(offset)) != 0) error = errno;
  const auto end = static_cast<off64_t>(offset + written);
  if (error == 0 && end / kWriteBackBytes != static_cast<off64_t>(offset) / kWriteBackBytes) {
    // Starts to write to the disk, so that the commit need not wait for the whole file.
    static_cast<void>(::sync_file_range(opened, 0, end, SYNC_FILE_RANGE_WRITE));
  }
  ::close(opened);
  if (error != 0) return core::fail_errno(error, "cannot write '" + path + "'", "make room on the disk, or check it");
  return {};
}

}  // namespace

core::Result<std::unique_ptr<Staging>> Staging::open(const std::string& folder) {
  DTS_TRY(create_folder(folder));
  const std::string file = folder + "/lock";
  const int lock = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kStagedMode);
  if (lock < 0) return core::fail_errno(errno, "cannot open '" + file + "'", "check that the folder is writable for the hub");
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock);
    return core::fail(core::ErrorCode::WrongState, "another dts-hub uses '" + folder + "'",
                      "give each hub a 'name' of its own in hub.toml");
  }
  return std::unique_ptr<Staging>(new Staging(folder, lock));
}

Staging::~Staging() { ::close(lock_); }

core::Result<std::vector<Staging::Upload>> Staging::load() {
  std::vector<Upload> uploads;
  std::vector<fs::path> offers;
  std::vector<fs::path> parts;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
    if (entry.depth() != 1) continue;
    (entry->path().extension() == ".offer" ? offers : parts).push_back(entry->path());
  }
  if (error) return core::fail(core::ErrorCode::Failed, "cannot list '" + folder_ + "': " + error.message(), "check the disk");
  std::error_code ignored;
  for (const fs::path& offer : offers) {
    if (auto upload = read_staged(offer)) {
      uploads.push_back(*std::move(upload));
    } else {
      fs::remove(offer, ignored);
    }
  }
  for (const fs::path& part : parts) {
    if (part.extension() != ".part" || !fs::exists(fs::path(part).replace_extension(".offer"), ignored)) fs::remove(part, ignored);
  }
  return uploads;
}

core::Status Staging::begin(const RecordingName& name, const v1::UploadOffer& offer) {
  DTS_TRY(create_folder(folder_ + "/" + name.clinic));
  static_cast<void>(::unlink(offer_file(name).c_str()));
  return write_at(offer_file(name), 0, offer.SerializeAsString());
}

core::Status Staging::write(const RecordingName& name, std::uint64_t offset, std::string_view data) {
  return write_at(file(name), offset, data);
}

core::Status Staging::restart(const RecordingName& name) {
  // A new file instead of an empty old one: what the system could not write of the old one must not appear in the new one.
  if (::unlink(file(name).c_str()) == 0 || errno == ENOENT) return {};
  return core::fail_errno(errno, "cannot remove '" + file(name) + "'", "check the disk");
}

void Staging::remove(const RecordingName& name) {
  static_cast<void>(::unlink(file(name).c_str()));
  static_cast<void>(::unlink(offer_file(name).c_str()));
}

std::string Staging::file(const RecordingName& name) const {
  return folder_ + "/" + name.clinic + "/" + wire::hex_of(name.sha256) + ".part";
}

std::string Staging::offer_file(const RecordingName& name) const {
  return folder_ + "/" + name.clinic + "/" + wire::hex_of(name.sha256) + ".offer";
}

}  // namespace dts::fleet::hub
