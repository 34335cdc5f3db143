// SPDX-License-Identifier: Apache-2.0
#include "ctl/sessions/recorded_files.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "cli/try.h"
#include "ctl/commands.h"

namespace dts::ctl {
namespace {

using client::ErrorCode;
using client::Result;

Result<RecordedFile> file_of(const v1::SessionRecord& session, const v1::SessionPart& part) {
  const std::string what = "part " + std::to_string(part.part()) + " of session '" + session.session_id() + "'";
  if (part.state() == v1::PART_STATE_RECORDING) {
    return client::fail(ErrorCode::WrongState, what + " is still being recorded",
                        "stop the session first: dtsctl session stop --rig " + session.rig());
  }
  if (part.state() == v1::PART_STATE_MISSING || part.file().empty()) {
    return client::fail(ErrorCode::DataDamaged, what + " is missing: there is no file '" + part.file() + "'", "restore it from a backup");
  }
  if (::access(part.file().c_str(), R_OK) == 0) {
    return RecordedFile{.path = part.file(), .session_id = session.session_id(), .part = part.part(), .sha256 = part.sha256()};
  }
  if (errno == EACCES) {
    return client::fail(ErrorCode::NotAllowed, "'" + part.file() + "': no permission to read",
                        "join the group dtsd: usermod -aG dtsd $USER, then log in again");
  }
  return client::fail(ErrorCode::Failed, "'" + part.file() + "' cannot be read here: it is on the daemon's machine",
                      "run dtsctl there, or copy the file here together with its .corrections.json, if there is one, and give its name");
}

}  // namespace

bool means_file(const std::string& argument) {
  std::error_code none;
  return argument.find('/') != std::string::npos || argument.ends_with(".xdf") || argument.ends_with(".part") ||
         std::filesystem::exists(argument, none);
}

Result<void> check_recording(const std::string& path) {
  constexpr std::string_view kMagic = "XDF:";
  const std::string what = "'" + path + "'";
  std::error_code none;
  if (!std::filesystem::exists(path, none)) {
    return client::fail(ErrorCode::InvalidArgument, "no file " + what, "check the name; to list sessions: dtsctl session list");
  }
  if (!std::filesystem::is_regular_file(path, none)) return client::fail(ErrorCode::InvalidArgument, what + " is not a file");
  if (::access(path.c_str(), R_OK) != 0)
    return client::fail(ErrorCode::NotAllowed, what + ": no permission to read",
                        "join the group dtsd: usermod -aG dtsd $USER, then log in again");
  std::array<char, kMagic.size()> begin{};
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), begin.size());
  if (file && std::string_view(begin.data(), begin.size()) == kMagic) return {};
  return client::fail(ErrorCode::InvalidArgument, what + " is not a recording: it does not start like an XDF file",
                      "give a file with the ending .xdf or .xdf.part");
}

Result<std::vector<RecordedFile>> find_recordings(const Arguments& arguments) {
  const std::string& argument = arguments.session.id;
  if (means_file(argument)) {
    return check_recording(argument).map([&] { return std::vector<RecordedFile>{{.path = argument}}; });
  }
  DTS_TRY_ASSIGN(auto dts, connect(arguments));
  DTS_TRY_ASSIGN(const auto session, dts.show_session(argument));
  if (session.is_deleted()) {
    return client::fail(ErrorCode::WrongState, "session '" + argument + "' is deleted", "restore it: dtsctl session restore " + argument);
  }
  if (session.parts_size() == 0) return client::fail(ErrorCode::NotFound, "session '" + argument + "' has no recording");
  std::vector<RecordedFile> files;
  for (const v1::SessionPart& part : session.parts()) {
    DTS_TRY_ASSIGN(auto file, file_of(session, part));
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace dts::ctl
