// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/erasures.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

#include "core/descriptor.h"
#include "fleet/hub/durable_file.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::hub {
namespace {

constexpr mode_t kJournalMode = 0640;
constexpr const char* kEndOfLine = "erased";  // a line without it is torn

}  // namespace

core::Status ErasureJournal::create() const { return append(""); }

core::Status ErasureJournal::add(const SessionName& name) const {
  // In one write, so that lines of several processes do not mix. The first line feed ends a line that is torn.
  return append("\n" + name.clinic + " " + name.id + " " + kEndOfLine + "\n");
}

core::Status ErasureJournal::append(const std::string& line) const {
  const core::Descriptor file(::open(file_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kJournalMode));
  if (file.get() < 0) return core::fail_errno(errno, "cannot open '" + file_ + "'", "check that the file is writable for the hub");
  errno = 0;
  if (::write(file.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size()) || ::fsync(file.get()) != 0) {
    return core::fail_errno(errno == 0 ? ENOSPC : errno, "cannot append to '" + file_ + "'", "make room on the disk, or check it");
  }
  return synchronise(std::filesystem::path(file_).parent_path().string());
}

core::Result<std::set<SessionName>> ErasureJournal::read() const {
  std::set<SessionName> erased;
  std::error_code error;
  if (!std::filesystem::exists(file_, error) && !error) return erased;
  std::ifstream opened(file_);
  std::string line;
  while (std::getline(opened, line)) {
    SessionName name;
    std::string end;
    std::istringstream words(line);
    if (words >> name.clinic >> name.id >> end && end == kEndOfLine && wire::is_clinic_name(name.clinic)) erased.insert(std::move(name));
  }
  if (opened.eof()) return erased;
  return core::fail(core::ErrorCode::Failed, "cannot read '" + file_ + "'", "check the disk, and that the file is readable for the hub");
}

core::Result<std::uint32_t> Erasures::erase(const SessionName& name, const std::string& who, std::int64_t utc_ns) {
  DTS_TRY_ASSIGN(const bool is_known, catalogue_.is_erased(name.clinic, name.id));
  if (!is_known) {
    DTS_TRY(catalogue_.check_room_for_erasure(name.clinic));
    DTS_TRY(journal_.add(name));
  }
  DTS_TRY(catalogue_.erase_session(name, who, utc_ns));
  return remove_left(name.clinic);
}

core::Result<std::uint64_t> Erasures::reconcile(std::int64_t utc_ns) {
  DTS_TRY_ASSIGN(const auto written, journal_.read());
  DTS_TRY_ASSIGN(const auto known, catalogue_.erased_sessions());
  std::uint64_t erased = 0;
  for (const SessionName& name : written) {
    if (known.contains(name)) continue;
    DTS_TRY(catalogue_.erase_session(name, "journal", utc_ns));
    ++erased;
  }
  for (const SessionName& name : known) {
    if (!written.contains(name)) DTS_TRY(journal_.add(name));
  }
  return erased;
}

core::Result<std::uint32_t> Erasures::remove_left(const std::string& clinic) {
  DTS_TRY_ASSIGN(const auto left, catalogue_.left_recordings(clinic));
  std::uint32_t removed = 0;
  std::optional<core::Error> first;
  for (const RecordingName& name : left) {
    const auto is_removed = catalogue_.remove_left(name, store_);
    if (!is_removed && is_removed.error().code == core::ErrorCode::Unreachable) return tl::make_unexpected(is_removed.error());
    if (!is_removed && !first) first = is_removed.error();
    removed += is_removed && *is_removed ? 1U : 0U;
  }
  if (first) return tl::make_unexpected(*std::move(first));
  return removed;
}

}  // namespace dts::fleet::hub
