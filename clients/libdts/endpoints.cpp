// SPDX-License-Identifier: Apache-2.0
#include "dts/endpoints.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>

#include "try.h"

namespace dts::client {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kIpc = "ipc://";
constexpr std::string_view kTcp = "tcp://";
constexpr std::string_view kControlName = "control.sock";
constexpr std::string_view kDataName = "data.sock";
constexpr std::size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;

std::string value_of(const Environment& environment, const char* variable) {
  const char* value = environment(variable);
  return value == nullptr ? std::string() : std::string(value);
}

/// Changes ".../control.sock" to ".../data.sock" or the reverse. Returns an empty text if `endpoint` does not end in `from`.
std::string sibling(const std::string& endpoint, std::string_view from, std::string_view to) {
  const std::string ending = "/" + std::string(from);
  if (!endpoint.starts_with(kIpc) || !endpoint.ends_with(ending)) return {};
  return endpoint.substr(0, endpoint.size() - from.size()) + std::string(to);
}

Endpoints in_directory(const fs::path& directory, std::string origin) {
  const std::string base = std::string(kIpc) + directory.string() + "/";
  return {.control = base + std::string(kControlName), .data = base + std::string(kDataName), .origin = std::move(origin)};
}

/// Derives the missing address; at least one of the two is known.
Endpoints completed(std::string control, std::string data, std::string origin) {
  if (control.empty()) control = sibling(data, kDataName, kControlName);
  if (data.empty()) data = sibling(control, kControlName, kDataName);
  return {.control = std::move(control), .data = std::move(data), .origin = std::move(origin)};
}

/// Any user may create a directory in /tmp: a directory of another user could be there to receive our commands.
Result<Endpoints> in_tmp() {
  const fs::path directory = "/tmp/dtsd-" + std::to_string(::geteuid());
  struct stat status {};
  if (::stat(directory.c_str(), &status) == 0 && status.st_uid != ::geteuid() && status.st_uid != 0) {
    return fail(ErrorCode::NotAllowed, directory.string() + " belongs to another user",
                "remove it, or set DTSD_RUNTIME_DIR to the directory of the daemon");
  }
  return in_directory(directory, directory.string());
}

Result<Endpoints> by_directory(const Environment& environment, const fs::path& system_directory) {
  if (const auto given = value_of(environment, "DTSD_RUNTIME_DIR"); !given.empty()) return in_directory(given, "DTSD_RUNTIME_DIR");
  // A directory without read permission still belongs to the daemon; probe() then reports which permission is missing.
  std::error_code why;
  if (fs::exists(system_directory / kControlName, why) || why == std::errc::permission_denied) {
    return in_directory(system_directory, system_directory.string());
  }
  if (const auto session = value_of(environment, "XDG_RUNTIME_DIR"); session.starts_with('/')) {
    return in_directory(fs::path(session) / "dtsd", "XDG_RUNTIME_DIR");
  }
  return in_tmp();
}

Result<void> check_address(const std::string& endpoint, const std::string& origin) {
  const std::string subject = "'" + endpoint + "' (from " + origin + ")";
  if (endpoint.starts_with(kIpc)) {
    const std::size_t length = endpoint.size() - kIpc.size();
    if (length == 0 || (endpoint[kIpc.size()] != '/' && endpoint[kIpc.size()] != '@')) {
      return fail(ErrorCode::InvalidArgument, subject + ": the socket path must be absolute", "write ipc:///run/dtsd/control.sock");
    }
    if (length > kLongestPath) {
      return fail(ErrorCode::InvalidArgument, subject + ": the socket path is longer than " + std::to_string(kLongestPath) + " bytes",
                  "choose a shorter runtime directory");
    }
    return {};
  }
  const std::size_t colon = endpoint.rfind(':');
  if (endpoint.starts_with(kTcp) && colon > kTcp.size() && colon + 1 < endpoint.size()) return {};
  return fail(ErrorCode::InvalidArgument, subject + " is not an address", "write ipc:///path/control.sock or tcp://host:port");
}

}  // namespace

const char* process_environment(const char* name) noexcept { return std::getenv(name); }

Result<Endpoints> find_endpoints(const EndpointWishes& wishes, const Environment& environment, const fs::path& system_directory) {
  const std::string control = value_of(environment, "DTSD_CONTROL");
  const std::string data = value_of(environment, "DTSD_DATA");
  Result<Endpoints> found;
  if (!wishes.control.empty() || !wishes.data.empty()) {
    found = completed(wishes.control, wishes.data, wishes.control.empty() ? "--data" : "--endpoint");
  } else if (!control.empty() || !data.empty()) {
    found = completed(control, data, control.empty() ? "DTSD_DATA" : "DTSD_CONTROL");
  } else {
    found = by_directory(environment, system_directory);
  }
  if (!found) return found;
  // A TCP address does not determine the other address, but the environment may have it.
  if (found->control.empty()) found->control = control;
  if (found->data.empty()) found->data = data;
  for (const std::string& address : {found->control, found->data}) {
    if (address.empty()) continue;
    DTS_TRY(check_address(address, found->origin));
  }
  return found;
}

Result<void> probe(const std::string& endpoint) {
  if (!endpoint.starts_with(kIpc)) return {};
  const std::string path = endpoint.substr(kIpc.size());
  if (path.empty() || path.front() != '/' || path.size() > kLongestPath) return {};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), std::begin(address.sun_path));
  const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return {};  // no file descriptor left: the real connection will report this
  const int outcome = ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
  ::close(descriptor);
  switch (outcome) {
    case ENOENT:
    case ENOTDIR:
      return fail(ErrorCode::Unreachable, "no daemon at " + endpoint + ": the socket does not exist",
                  "start it: systemctl start dtsd, or dtsd --config FILE; if it uses another directory (scripts/demo prints it), set "
                  "DTSD_RUNTIME_DIR or give --endpoint");
    case ECONNREFUSED:
      return fail(ErrorCode::Unreachable, "no daemon at " + endpoint + ": the socket exists, but no program listens on it",
                  "start it: systemctl start dtsd; find out why it ended: journalctl -u dtsd");
    case EACCES:
    case EPERM:
      return fail(ErrorCode::NotAllowed, "no permission to open " + endpoint,
                  "join the group that owns the socket's directory (usermod -aG dtsd $USER), then log in again");
    default: return {};  // connected, or an error after which libzmq retries
  }
}

}  // namespace dts::client
