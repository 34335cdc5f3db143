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

/// Those who may log in, one a line; empty lines and lines that begin with '#' say nothing:
///
///     # the clinic
///     anna:operator:$argon2id$v=19$m=65536,t=2,p=1$...
///
/// Names are [a-z0-9._-]{1,32}, but not "local"; nobody may read the file but its owner and its group, nobody but its owner may write it.
struct User {
  std::string name;
  v1::Role role = v1::ROLE_UNSPECIFIED;
  std::string password_hash;

  friend bool operator==(const User&, const User&) = default;
};
inline constexpr std::size_t kMostUsers = 1000;

[[nodiscard]] bool is_user_name(std::string_view name) noexcept;
/// Why nobody can have that name, in words; empty: somebody can.
[[nodiscard]] std::string problem_with_name(std::string_view name);
/// "none", "viewer", "operator", "engineer"
[[nodiscard]] std::string_view role_name(v1::Role role) noexcept;
/// Nothing for what is no role; "none" is not one.
[[nodiscard]] std::optional<v1::Role> role_of(std::string_view name) noexcept;

/// InvalidArgument, "FILE:LINE: what", for a text that is not as above.
[[nodiscard]] client::Result<std::vector<User>> parse_users(std::string_view text, const std::string& file);

/// By which a change of a file is seen without reading it.
struct FileStamp {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t bytes = 0;
  std::int64_t modified_ns = 0;
  std::int64_t changed_ns = 0;  ///< Owner and mode too.

  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};
[[nodiscard]] std::optional<FileStamp> stamp_of(const std::string& file) noexcept;

struct UserFile {
  std::vector<User> users;
  FileStamp stamp;
};
/// InvalidArgument when it is not there, others may read or change it, or a line is wrong.
[[nodiscard]] client::Result<UserFile> read_users(const std::string& file);

/// Both change nothing but the line of that user, and that as a whole or not at all: readers see the file before or after. Its owner and
/// mode stay; a new one gets 0640. WrongState: there is such a user already; NotFound: there is none.
[[nodiscard]] client::Result<void> add_user(const std::string& file, const User& user);
[[nodiscard]] client::Result<void> remove_user(const std::string& file, const std::string& name);

}  // namespace dts::gateway
