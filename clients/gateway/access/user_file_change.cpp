// SPDX-License-Identifier: Apache-2.0
// The functions of user_file.h that write.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <functional>
#include <string>
#include <system_error>

#include "cli/try.h"
#include "gateway/access/descriptor.h"
#include "gateway/access/user_file.h"
#include "gateway/access/user_text.h"

namespace dts::gateway {
namespace {

using client::ErrorCode;
using client::Result;

constexpr mode_t kNewMode = 0640;

tl::unexpected<client::Error> fail_to(const std::string& verb, const std::string& file, int why) {
  return client::fail(ErrorCode::Failed, "cannot " + verb + " '" + file + "': " + std::generic_category().message(why));
}

/// Opens and locks the file: of two changes at the same time, one would be lost. `may_create`: creates an empty file if there is none.
Result<Descriptor> open_locked(const std::string& file, bool may_create) {
  while (true) {
    Descriptor made(may_create ? ::open(file.c_str(), O_RDONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kNewMode) : -1);
    if (made) static_cast<void>(::fchmod(*made, kNewMode));  // independent of the umask
    Descriptor opened = made ? std::move(made) : Descriptor(::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (!opened || ::flock(*opened, LOCK_EX) != 0) return fail_to("open", file, errno);
    struct stat locked {};
    struct stat named {};
    const bool is_known = ::fstat(*opened, &locked) == 0 && ::stat(file.c_str(), &named) == 0;
    // Another change may have replaced the file during the wait: the new file must be locked.
    if (is_known && locked.st_ino == named.st_ino && locked.st_dev == named.st_dev) return opened;
  }
}

Result<void> fill(int descriptor, const std::string& file, const std::string& text, const struct stat& like) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno != EINTR) return fail_to("write", file, errno);
    if (written > 0) done += static_cast<std::size_t>(written);
  }
  struct stat made {};
  if (::fstat(descriptor, &made) != 0) return fail_to("write", file, errno);
  const bool is_anothers = made.st_uid != like.st_uid || made.st_gid != like.st_gid;
  if (is_anothers && ::fchown(descriptor, like.st_uid, like.st_gid) != 0) return fail_to("keep the owner of", file, errno);
  if (::fchmod(descriptor, like.st_mode & 07777U) != 0) return fail_to("keep the mode of", file, errno);
  if (::fsync(descriptor) != 0) return fail_to("write", file, errno);
  return {};
}

/// Replaces the old file by a new one with this text.
Result<void> replace(const std::string& file, const std::string& text, const struct stat& like) {
  std::string temporary = file + ".XXXXXX";
  const Descriptor made(::mkostemp(temporary.data(), O_CLOEXEC));
  if (!made) return fail_to("write beside", file, errno);
  if (auto filled = fill(*made, file, text, like); !filled) {
    ::unlink(temporary.c_str());
    return filled;
  }
  if (::rename(temporary.c_str(), file.c_str()) != 0) {
    const int why = errno;
    ::unlink(temporary.c_str());
    return fail_to("replace", file, why);
  }
  const std::size_t slash = file.rfind('/');
  const Descriptor folder(::open(slash == std::string::npos ? "." : file.substr(0, slash + 1).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder) static_cast<void>(::fsync(*folder));  // the change is done; without this, a power failure could undo it
  return {};
}

using Change = std::function<Result<void>(const std::vector<User>& users, std::string& text)>;

Result<void> change_file(const std::string& file, bool may_create, const Change& change) {
  DTS_TRY_ASSIGN(const auto locked, open_locked(file, may_create));
  DTS_TRY_ASSIGN(auto content, read_user_text(*locked, file));
  DTS_TRY_ASSIGN(const auto users, parse_users(content.text, file));
  if (!content.text.empty() && !content.text.ends_with('\n')) content.text += '\n';
  DTS_TRY(change(users, content.text));
  DTS_TRY(parse_users(content.text, file));
  return replace(file, content.text, content.facts);
}

bool has(const std::vector<User>& users, const std::string& name) { return std::ranges::find(users, name, &User::name) != users.end(); }

}  // namespace

Result<void> add_user(const std::string& file, const User& user) {
  return change_file(file, true, [&](const std::vector<User>& users, std::string& text) -> Result<void> {
    if (has(users, user.name)) {
      return client::fail(ErrorCode::WrongState, "user '" + user.name + "' exists already",
                          "dts-gateway user remove " + user.name + " --users " + file);
    }
    text += user.name + ":" + std::string(role_name(user.role)) + ":" + user.password_hash + "\n";
    return {};
  });
}

Result<void> remove_user(const std::string& file, const std::string& name) {
  return change_file(file, false, [&](const std::vector<User>& users, std::string& text) -> Result<void> {
    if (!has(users, name)) return client::fail(ErrorCode::NotFound, "no user '" + name + "'", "dts-gateway user list --users " + file);
    const std::string begin = name + ":";
    const std::size_t at = text.starts_with(begin) ? 0 : text.find("\n" + begin) + 1;
    text.erase(at, text.find('\n', at) + 1 - at);
    return {};
  });
}

}  // namespace dts::gateway
