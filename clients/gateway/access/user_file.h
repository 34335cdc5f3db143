// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dts/error.h"
#include "dts/v1/control.pb.h"

namespace dts::gateway {

/// One user per line; empty lines and lines that begin with '#' are ignored:
///
///     # the clinic
///     anna:operator:$argon2id$v=19$m=65536,t=2,p=1$...
///
/// Names are [a-z0-9._-]{1,32}, except "local". Only the file's owner and group may read it; only its owner may write it.
struct User {
  std::string name;
  v1::Role role = v1::ROLE_UNSPECIFIED;
  std::string password_hash;

  friend bool operator==(const User&, const User&) = default;
};
inline constexpr std::size_t kMostUsers = 1000;

[[nodiscard]] bool is_user_name(std::string_view name) noexcept;
/// Returns why the name is not allowed, in words; empty: it is allowed.
[[nodiscard]] std::string problem_with_name(std::string_view name);
/// Returns "none", "viewer", "operator", "engineer".
[[nodiscard]] std::string_view role_name(v1::Role role) noexcept;
/// Returns nothing for any other text; "none" is not a role.
[[nodiscard]] std::optional<v1::Role> role_of(std::string_view name) noexcept;

/// Fails with InvalidArgument, "FILE:LINE: what", for a text in another format.
[[nodiscard]] client::Result<std::vector<User>> parse_users(std::string_view text, const std::string& file);

/// Detects a change of a file without reading it.
struct FileStamp {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t bytes = 0;
  std::int64_t modified_ns = 0;
  std::int64_t changed_ns = 0;  ///< Changes of owner and mode count too.

  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};
[[nodiscard]] std::optional<FileStamp> stamp_of(const std::string& file) noexcept;

struct UserFile {
  std::vector<User> users;
  FileStamp stamp;
};
/// Fails with InvalidArgument if the file does not exist, other users may read or change it, or a line is wrong.
[[nodiscard]] client::Result<UserFile> read_users(const std::string& file);

/// Both change only the line of that user, and atomically: readers see the file before or after the change. Owner and mode stay the same; a
/// new file gets mode 0640. Fail with WrongState if the user already exists, and with NotFound if there is no such user.
[[nodiscard]] client::Result<void> add_user(const std::string& file, const User& user);
[[nodiscard]] client::Result<void> remove_user(const std::string& file, const std::string& name);

}  // namespace dts::gateway
