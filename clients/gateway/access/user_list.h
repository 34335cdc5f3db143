// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "gateway/access/user_file.h"

namespace dts::gateway {

/// The users of a file, read again whenever it changes. Thread: one.
class UserList {
 public:
  /// `left` is told of everybody whose line changed or went.
  UserList(std::string file, std::function<void(const std::string& user)> left) : file_(std::move(file)), left_(std::move(left)) {}

  /// Looks whether the file changed. Fails as `read_users`, until it can be read again.
  [[nodiscard]] client::Result<void> refresh();
  /// As of the last `refresh`; nothing: nobody of that name.
  [[nodiscard]] const User* find(const std::string& name) const;

 private:
  std::string file_;
  std::function<void(const std::string& user)> left_;
  std::optional<FileStamp> stamp_;
  std::optional<client::Error> problem_;
  std::map<std::string, User> users_;
};

}  // namespace dts::gateway
