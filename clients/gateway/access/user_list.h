// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "gateway/access/user_file.h"

namespace dts::gateway {

/// The users of a file, read again after every change. Thread: one.
class UserList {
 public:
  /// Calls `left` for every user whose line was changed or removed.
  UserList(std::string file, std::function<void(const std::string& user)> left) : file_(std::move(file)), left_(std::move(left)) {}

  /// Reads the file again if it changed. Fails as `read_users`, until the file can be read again.
  [[nodiscard]] client::Result<void> refresh();
  /// Returns the user as of the last `refresh`; nullptr if there is none of that name.
  [[nodiscard]] const User* find(const std::string& name) const;

 private:
  std::string file_;
  std::function<void(const std::string& user)> left_;
  std::optional<FileStamp> stamp_;
  std::optional<client::Error> problem_;
  std::map<std::string, User> users_;
};

}  // namespace dts::gateway
