// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/user_commands.h"

#include <memory>
#include <string>
#include <utility>

#include "cli/exit_status.h"
#include "cli/table.h"
#include "cli/try.h"
#include "cli/validators.h"
#include "gateway/access/password.h"
#include "gateway/access/user_file.h"

namespace dts::gateway {
namespace {

struct UserArguments {
  std::string users_file{};
  std::string name{};
  std::string role{};
};

client::Result<void> add(const UserArguments& arguments, const AskPassword& ask, cli::Console& console) {
  DTS_TRY_ASSIGN(const auto password, ask(console));
  DTS_TRY(check_new_password(password));
  DTS_TRY_ASSIGN(auto hash, hash_password(password));
  const v1::Role role = role_of(arguments.role).value_or(v1::ROLE_UNSPECIFIED);
  return add_user(arguments.users_file, {.name = arguments.name, .role = role, .password_hash = std::move(hash)});
}

client::Result<void> remove(const UserArguments& arguments) { return remove_user(arguments.users_file, arguments.name); }

client::Result<void> list(const UserArguments& arguments, cli::Console& console) {
  DTS_TRY_ASSIGN(const auto read, read_users(arguments.users_file));
  cli::Table table({"user", "role"});
  for (const User& user : read.users) table.add({{user.name}, {std::string(role_name(user.role))}});
  table.print(console);
  if (read.users.empty())
    cli::print_hint(console, "no users yet: dts-gateway user add NAME --role engineer --users " + arguments.users_file);
  return {};
}

int end(cli::Console& console, const client::Result<void>& result) { return result ? cli::kOk : cli::fail_with(console, result.error()); }

CLI::Validator user_name() {
  const auto check = [](std::string& text) -> std::string {
    const std::string problem = problem_with_name(text);
    return problem.empty() ? "" : "'" + text + "': " + problem;
  };
  return {check, "", "name"};
}

CLI::Validator role() {
  const auto check = [](std::string& text) -> std::string {
    return role_of(text) ? "" : "'" + text + "' is not viewer, operator or engineer";
  };
  return {check, "", "role"};
}

using ArgumentsPointer = std::shared_ptr<UserArguments>;

void add_file(CLI::App& command, const ArgumentsPointer& arguments) {
  command.add_option("--users", arguments->users_file, "File of users; the first one makes it")->required()->option_text("FILE");
}

void add_name(CLI::App& command, const ArgumentsPointer& arguments) {
  command.add_option("NAME", arguments->name, "Name to log in with")->required()->option_text(" ")->check(user_name());
}

}  // namespace

void add_user_commands(cli::CommandLine& line, AskPassword ask) {
  const auto arguments = std::make_shared<UserArguments>();
  CLI::App* user = cli::add_group(line.app, "user", "Who may log in", "dts-gateway user list --users users | names and roles\n");
  CLI::App* added =
      cli::add_command(line, *user, "add", "Add a user; asks for the password, or reads a line from the standard input",
                       "dts-gateway user add anna --role operator --users users | anna can run sessions\n",
                       [arguments, ask = std::move(ask)](cli::Console& console) { return end(console, add(*arguments, ask, console)); });
  add_name(*added, arguments);
  added->add_option("--role", arguments->role, "viewer: look; operator: run sessions; engineer: everything")
      ->required()
      ->option_text("ROLE")
      ->check(role());
  add_file(*added, arguments);
  CLI::App* removed = cli::add_command(line, *user, "remove", "Remove a user, who is logged out at once",
                                       "dts-gateway user remove anna --users users | anna is removed\n",
                                       [arguments](cli::Console& console) { return end(console, remove(*arguments)); });
  add_name(*removed, arguments);
  add_file(*removed, arguments);
  CLI::App* listed = cli::add_command(line, *user, "list", "List the users", "dts-gateway user list --users users | names and roles\n",
                                      [arguments](cli::Console& console) { return end(console, list(*arguments, console)); });
  add_file(*listed, arguments);
}

}  // namespace dts::gateway
