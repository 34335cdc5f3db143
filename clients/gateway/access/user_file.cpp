// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/user_file.h"

#include <fcntl.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <set>
#include <system_error>
#include <utility>

#include "cli/try.h"
#include "gateway/access/descriptor.h"
#include "gateway/access/identity.h"
#include "gateway/access/password.h"
#include "gateway/access/user_text.h"

namespace dts::gateway {
namespace {

using client::ErrorCode;
using client::Result;

constexpr std::size_t kLongestFileBytes = 1U << 20U;
constexpr std::size_t kLongestName = 32;
constexpr mode_t kForbidden = S_IWGRP | S_IROTH | S_IWOTH;

constexpr std::array<std::pair<std::string_view, v1::Role>, 3> kRoles{
    {{"viewer", v1::ROLE_VIEWER}, {"operator", v1::ROLE_OPERATOR}, {"engineer", v1::ROLE_ENGINEER}}};

/// Returns what is wrong with a line, in words; empty if it is correct.
std::string read_line(std::string_view line, User& user) {
  const std::size_t first = line.find(':');
  const std::size_t second = first == std::string_view::npos ? first : line.find(':', first + 1);
  if (second == std::string_view::npos) return "expected NAME:ROLE:HASH";
  user.name = line.substr(0, first);
  user.password_hash = line.substr(second + 1);
  const std::string_view role = line.substr(first + 1, second - first - 1);
  const auto maybe_role = role_of(role);
  if (std::string problem = problem_with_name(user.name); !problem.empty()) return problem;
  if (!maybe_role) return "the role of '" + user.name + "' is not viewer, operator or engineer";
  if (!is_password_hash(user.password_hash)) return "the hash of '" + user.name + "' was not made by `dts-gateway user add`";
  user.role = *maybe_role;
  return {};
}

Result<void> check_mode(const std::string& file, const struct stat& facts) {
  if (!S_ISREG(facts.st_mode)) return client::fail(ErrorCode::InvalidArgument, "'" + file + "' is not a file");
  if ((facts.st_mode & kForbidden) == 0) return {};
  return client::fail(ErrorCode::InvalidArgument, "'" + file + "': other users can read it, or users other than the owner can write it",
                      "chmod 640 '" + file + "'");
}

/// The group of this process.
std::string group_name() {
  const group* const found = ::getgrgid(::getegid());
  return found == nullptr ? std::to_string(::getegid()) : std::string(found->gr_name);
}

std::int64_t in_ns(const timespec& time) noexcept { return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec; }

FileStamp stamp(const struct stat& facts) noexcept {
  return {.device = facts.st_dev,
          .inode = facts.st_ino,
          .bytes = facts.st_size,
          .modified_ns = in_ns(facts.st_mtim),
          .changed_ns = in_ns(facts.st_ctim)};
}

}  // namespace

bool is_user_name(std::string_view name) noexcept {
  return !name.empty() && name.size() <= kLongestName && std::ranges::all_of(name, [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '.' || letter == '_' || letter == '-';
  });
}

std::string problem_with_name(std::string_view name) {
  if (!is_user_name(name)) return "a name is 1 to 32 of a-z, 0-9, '.', '_', '-'";
  if (name == kLocalUser) return "'local' is the name of users without a login: choose another name";
  return {};
}

std::string_view role_name(v1::Role role) noexcept {
  const auto found = std::ranges::find(kRoles, role, [](const auto& entry) { return entry.second; });
  return found == kRoles.end() ? "none" : found->first;
}

std::optional<v1::Role> role_of(std::string_view name) noexcept {
  const auto found = std::ranges::find(kRoles, name, [](const auto& entry) { return entry.first; });
  return found == kRoles.end() ? std::nullopt : std::optional(found->second);
}

Result<std::vector<User>> parse_users(std::string_view text, const std::string& file) {
  std::vector<User> users;
  std::set<std::string> names;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line.starts_with('#')) continue;
    User user;
    std::string wrong = read_line(line, user);
    if (wrong.empty() && !names.insert(user.name).second) wrong = "'" + user.name + "' appears twice";
    if (wrong.empty() && users.size() == kMostUsers) wrong = "more than 1000 users";
    if (!wrong.empty()) return client::fail(ErrorCode::InvalidArgument, file + ":" + std::to_string(number) + ": " + wrong);
    users.push_back(std::move(user));
  }
  return users;
}

std::optional<FileStamp> stamp_of(const std::string& file) noexcept {
  struct stat facts {};
  return ::stat(file.c_str(), &facts) == 0 ? std::optional(stamp(facts)) : std::nullopt;
}

Result<UserText> read_user_text(int descriptor, const std::string& file) {
  const auto unreadable = [&](int why) {
    return client::fail(ErrorCode::InvalidArgument, "cannot read '" + file + "': " + std::generic_category().message(why));
  };
  UserText content;
  if (::fstat(descriptor, &content.facts) != 0) return unreadable(errno);
  DTS_TRY(check_mode(file, content.facts));
  std::array<char, 16384> piece{};
  for (ssize_t got = 1; got != 0;) {
    got = ::read(descriptor, piece.data(), piece.size());
    if (got < 0 && errno != EINTR) return unreadable(errno);
    if (got > 0) content.text.append(piece.data(), static_cast<std::size_t>(got));
    if (content.text.size() > kLongestFileBytes) return client::fail(ErrorCode::InvalidArgument, "'" + file + "' is larger than 1 MiB");
  }
  return content;
}

Result<UserFile> read_users(const std::string& file) {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (!opened) {
    const int why = errno;
    return client::fail(ErrorCode::InvalidArgument, "cannot read '" + file + "': " + std::generic_category().message(why),
                        why == EACCES ? "let the gateway's group read it, and the folders above: chgrp " + group_name() + " '" + file +
                                            "' && chmod 640 '" + file + "'"
                                      : "make the first user: dts-gateway user add NAME --role engineer --users FILE");
  }
  DTS_TRY_ASSIGN(const auto content, read_user_text(*opened, file));
  DTS_TRY_ASSIGN(auto users, parse_users(content.text, file));
  return UserFile{.users = std::move(users), .stamp = stamp(content.facts)};
}

}  // namespace dts::gateway
