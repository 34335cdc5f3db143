// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/user_list.h"

#include <utility>

namespace dts::gateway {

client::Result<void> UserList::refresh() {
  const auto now = stamp_of(file_);
  const bool is_as_read = now && now == stamp_;
  if (!is_as_read) {
    auto read = read_users(file_);
    // Uses the stamp of the file that was read: `now` may belong to an older version.
    stamp_ = read ? std::optional(read->stamp) : now;
    problem_ = read ? std::nullopt : std::optional(read.error());
    if (read) {
      std::map<std::string, User> users;
      for (User& user : read->users) users.emplace(user.name, std::move(user));
      std::swap(users_, users);
      for (const auto& [name, user] : users) {
        const User* still = find(name);
        if (still == nullptr || *still != user) left_(name);
      }
    }
  }
  if (problem_) return tl::make_unexpected(*problem_);
  return {};
}

const User* UserList::find(const std::string& name) const {
  const auto found = users_.find(name);
  return found == users_.end() ? nullptr : &found->second;
}

}  // namespace dts::gateway
