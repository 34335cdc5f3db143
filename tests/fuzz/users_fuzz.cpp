// SPDX-License-Identifier: Apache-2.0
// The gateway's users file and what is sent to log in. A list that is accepted has every name once; adding and removing somebody changes
// nobody else; a password does not stay in memory where it came in, and nothing is read that was not sent.
#include <sys/stat.h>

#include <set>

#include "fuzz/fuzz_support.h"
#include "gateway/access/login_request.h"
#include "gateway/access/password.h"
#include "gateway/access/user_file.h"

namespace dts::fuzz::users {
namespace {


constexpr const char* kHash = "$argon2id$v=19$m=65536,t=2,p=1$c29tZXNhbHRzb21lc2FsdA$RdescudvJCsgt3ub+b4dWRWJTmaaJObGRdescudvJCs";
constexpr const char* kNewName = "zoe.of-the_test";

void check_users(const std::vector<gateway::User>& users) {
  std::set<std::string> names;
  promise(users.size() <= gateway::kMostUsers, "at most 1000 users");
  for (const gateway::User& user : users) {
    promise(gateway::is_user_name(user.name) && user.name != "local" && names.insert(user.name).second, "every name once");
    promise(gateway::role_name(user.role) != "none" && gateway::is_password_hash(user.password_hash), "a role and a hash");
    promise(user.password_hash.find('\0') == std::string::npos, "nothing hides behind a hash");
  }
}

/// Whatever else stands in the file stays.
void check_change(const std::string& file, const std::vector<gateway::User>& before) {
  const gateway::User added{
      .name = kNewName, .role = v1::ROLE_VIEWER, .password_hash = before.empty() ? kHash : before.front().password_hash};
  if (!gateway::add_user(file, added)) return;
  auto expected = before;
  expected.push_back(added);
  const auto with = gateway::read_users(file);
  promise(with && with->users == expected, "somebody was added, nobody else changed");
  promise(gateway::remove_user(file, kNewName).has_value(), "who is there can be removed");
  const auto without = gateway::read_users(file);
  promise(without && without->users == before, "somebody was removed, nobody else changed");
}

/// As JSON no text is shorter than it is, and around the two stands at least this.
void check_login(std::string body) {
  constexpr std::string_view kAround = R"({"user":"","password":""})";
  const std::size_t sent = body.size();
  const auto login = gateway::read_login(body);
  promise(body.empty(), "the body is wiped");
  if (login) promise(login->user.size() + login->password.text().size() + kAround.size() <= sent, "no longer than what was sent");
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  static const fuzz::Folder folder;
  const std::string text = fuzz::text_of(bytes, size);
  check_login(text);
  const auto users = gateway::parse_users(text, "users");
  if (!users) {
    promise(users.error().what.starts_with("users:"), "a problem says where it is");
    return;
  }
  check_users(*users);
  const std::string file = folder.file("users");
  fuzz::put_file(file, text);
  ::chmod(file.c_str(), 0640);
  check_change(file, *users);
}

}  // namespace dts::fuzz::users

DTS_FUZZ_TARGET(users)
