// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/session_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>

#include "cli/try.h"
#include "gateway/access/descriptor.h"

namespace dts::gateway {
namespace {

using client::ErrorCode;
using client::Result;

/// The daemon supplies the path, but the gateway checks the file: it must be a recording, not any other file that the gateway's user may
/// read.
Result<void> check_recording(const std::string& path, const std::string& what) {
  constexpr std::string_view kMagic = "XDF:";
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!file && errno == EACCES) {
    return client::fail(ErrorCode::NotAllowed, what + " may not be read by the gateway",
                        "add the gateway's user to the group of the recordings");
  }
  if (!file) {
    return client::fail(ErrorCode::Failed, what + " cannot be read by the gateway",
                        "run the gateway on the daemon's host, with access to its files");
  }
  struct stat facts {};
  std::array<char, kMagic.size()> begin{};
  const bool is_recording = path.starts_with('/') && ::fstat(*file, &facts) == 0 && S_ISREG(facts.st_mode) &&
                            ::read(*file, begin.data(), begin.size()) == static_cast<ssize_t>(begin.size()) &&
                            std::string_view(begin.data(), begin.size()) == kMagic;
  if (is_recording) return {};
  return client::fail(ErrorCode::DataDamaged, what + " is no recording", "restore it from a backup");
}

Result<std::string> readable_file(const v1::SessionRecord& session, const v1::SessionPart& part) {
  const std::string what = "part " + std::to_string(part.part()) + " of session '" + session.session_id() + "'";
  switch (part.state()) {
    case v1::PART_STATE_COMPLETE:
    case v1::PART_STATE_INCOMPLETE:
    case v1::PART_STATE_INTERRUPTED:  // cut off, but its complete part can be read
    case v1::PART_STATE_RECOVERED: break;
    case v1::PART_STATE_RECORDING: return client::fail(ErrorCode::WrongState, what + " is still being recorded", "stop the session first");
    default: return client::fail(ErrorCode::DataDamaged, what + " is gone", "restore it from a backup");
  }
  return check_recording(part.file(), what).map([&part] { return part.file(); });
}

Result<void> check_kept(const v1::SessionRecord& session) {
  if (!session.is_deleted()) return {};
  return client::fail(ErrorCode::WrongState, "session '" + session.session_id() + "' is deleted", "restore the session first");
}

}  // namespace

Result<std::vector<std::string>> files_of(const v1::SessionRecord& session) {
  DTS_TRY(check_kept(session));
  if (session.state() == "running") {
    return client::fail(ErrorCode::WrongState, "session '" + session.session_id() + "' is running", "stop the session first");
  }
  if (session.parts().empty()) return client::fail(ErrorCode::NotFound, "session '" + session.session_id() + "' has no recording");
  std::vector<std::string> files;
  for (const v1::SessionPart& part : session.parts()) {
    DTS_TRY_ASSIGN(auto file, readable_file(session, part));
    files.push_back(std::move(file));
  }
  return files;
}

Result<std::string> file_of(const v1::SessionRecord& session, std::uint32_t number) {
  DTS_TRY(check_kept(session));
  const auto part = std::ranges::find(session.parts(), number, &v1::SessionPart::part);
  if (part != session.parts().end()) return readable_file(session, *part);
  return client::fail(ErrorCode::NotFound, "session '" + session.session_id() + "' has no part " + std::to_string(number));
}

std::string fingerprint_of(const v1::SessionRecord& session) {
  std::string print;
  for (const v1::SessionPart& part : session.parts()) {
    print += std::to_string(part.part()) + "/" + std::to_string(part.state()) + "/" + std::to_string(part.bytes()) + "/" + part.sha256() +
             "/" + part.file() + "\n";
  }
  for (const v1::Correction& correction : session.corrections()) print += correction.SerializeAsString();
  return print;
}

}  // namespace dts::gateway
