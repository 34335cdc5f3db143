// SPDX-License-Identifier: Apache-2.0
#include "ipc/endpoint.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

namespace dts::ipc {
namespace {

constexpr std::string_view kIpc = "ipc://";
constexpr std::size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;

}  // namespace

std::string bind_hint(int system_errno) {
  return system_errno == EADDRINUSE ? "another program listens there: end it, or choose another endpoint in dtsd.toml" : "";
}

core::Status check_not_in_use(const std::string& endpoint) {
  if (!endpoint.starts_with(kIpc)) return {};
  const std::string path = endpoint.substr(kIpc.size());
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy_n(path.begin(), std::min(path.size(), kLongestPath), std::begin(address.sun_path));
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0) return {};  // no such file
  if (!S_ISSOCK(found.st_mode)) {
    return core::fail(core::ErrorCode::InvalidArgument, path + " exists and is not a socket", "choose another path for the endpoint");
  }
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return {};  // no descriptor left: bind will fail and report it
  // EAGAIN: a program listens, but its queue of connections is full.
  const bool is_taken = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 || errno == EAGAIN;
  ::close(probe);
  if (is_taken) {
    return core::fail(core::ErrorCode::WrongState, "another program already listens on " + endpoint,
                      "stop the other dtsd, or give this one another runtime directory");
  }
  return {};
}

void remove_socket_file(const std::string& endpoint) noexcept {
  if (endpoint.starts_with(kIpc)) ::unlink(endpoint.c_str() + kIpc.size());
}

}  // namespace dts::ipc
