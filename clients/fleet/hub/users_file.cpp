// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/users_file.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <fstream>
#include <map>
#include <set>

#include "files/toml_text.h"
#include "files/whole_file.h"
#include "fleet/wire/nkey.h"
#include "fleet/wire/subjects.h"
#include "record/replace_file.h"

namespace dts::fleet::hub {
namespace {

constexpr std::size_t kMostUsersBytes = 64 * 1024 * 1024;
constexpr mode_t kUsersMode = 0644;  // no secret: nats-server runs as another user

std::string quoted_list(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "\"" : ", \"") + text + "\"";
  return "[" + list + "]";
}

struct User {
  std::string name;  // for people
  std::string key;
  wire::Permissions permissions;
};

std::vector<User> users_of(const std::string& hub_public_key, const std::vector<DashboardKey>& dashboards,
                           const std::vector<Clinic>& clinics) {
  std::vector<User> users = {{.name = "the hub", .key = hub_public_key, .permissions = wire::hub_permissions()}};
  for (const DashboardKey& dashboard : dashboards) {
    users.push_back({.name = "a [[dashboard]]",
                     .key = dashboard.public_key,
                     .permissions = wire::dashboard_permissions(dashboard.public_key, dashboard.clinics)});
  }
  for (const Clinic& clinic : clinics) {
    // A line of the database that is not a name and a key must not become configuration.
    if (clinic.is_revoked || !wire::is_clinic_name(clinic.id) || !wire::is_public_nkey(clinic.nkey)) continue;
    users.push_back({.name = "clinic '" + clinic.id + "'", .key = clinic.nkey, .permissions = wire::clinic_permissions(clinic.id)});
  }
  return users;
}

std::string user_line(const User& user) {
  return "  {nkey: " + user.key + ", permissions: {publish: {allow: " + quoted_list(user.permissions.publish) +
         "}, subscribe: {allow: " + quoted_list(user.permissions.subscribe) + "}" +
         (user.permissions.may_answer ? ", allow_responses: {max: 1, ttl: \"30s\"}" : "") + "}}\n";
}

}  // namespace

core::Status check_keys(const std::string& hub_public_key, const std::vector<DashboardKey>& dashboards,
                        const std::vector<Clinic>& clinics) {
  std::map<std::string, std::string> owners;
  std::string problems;
  for (const User& user : users_of(hub_public_key, dashboards, clinics)) {
    const auto [owner, is_new] = owners.emplace(user.key, user.name);
    if (!is_new) problems += (problems.empty() ? "" : "; ") + user.name + " has the key of " + owner->second + " and cannot connect";
  }
  if (problems.empty()) return {};
  return core::fail(core::ErrorCode::WrongState, problems, "give each of them a key of its own");
}

std::string users_text(const std::string& hub_public_key, const std::vector<DashboardKey>& dashboards, const std::vector<Clinic>& clinics) {
  std::string text =
      "# Written by dts-hub from the table clinic and hub.toml. Change it with dts-fleet clinic add and revoke, or in [[dashboard]].\n"
      "authorization {\n users = [\n";
  std::set<std::string> keys;
  for (const User& user : users_of(hub_public_key, dashboards, clinics)) {
    if (keys.insert(user.key).second) text += user_line(user);
  }
  return text + " ]\n}\n";
}

core::Result<bool> write_users(const Settings& settings, const std::string& hub_public_key, const std::vector<Clinic>& clinics) {
  if (settings.users_file.empty()) return false;
  const std::string text = users_text(hub_public_key, settings.dashboards, clinics);
  const auto present = files::read_whole_file(settings.users_file, kMostUsersBytes);
  if (present && *present == text) return false;
  DTS_TRY(record::replace_file(settings.users_file, text, kUsersMode));
  return true;
}

core::Status reload_nats(const std::string& pid_file) {
  constexpr const char* kHowElse = "leave pid_file out (dts-hub-users.path reloads nats-server), or run this as the user of nats-server";
  if (::faccessat(AT_FDCWD, pid_file.c_str(), R_OK, AT_EACCESS) != 0 && errno == EACCES) {
    return core::fail_errno(EACCES, "cannot read " + pid_file, kHowElse);
  }
  const auto text = files::read_whole_file(pid_file, 64);
  pid_t number = 0;
  if (text) std::from_chars(text->data(), text->data() + text->size(), number);
  std::string program;
  if (number > 1) std::getline(std::ifstream("/proc/" + std::to_string(number) + "/comm"), program);
  // systemd's ProtectProc hides the names of other users' processes.
  const bool is_foreign = number > 1 && program.empty() && ::kill(number, 0) != 0 && errno == EPERM;
  if (program != "nats-server" && !is_foreign) {
    return core::fail(core::ErrorCode::NotFound, "'" + pid_file + "' names no running nats-server",
                      "start nats-server, with pid_file in its configuration; it reads the users at its start");
  }
  if (!is_foreign && ::kill(number, SIGHUP) == 0) return {};
  if (!is_foreign && errno == ESRCH) return core::fail(core::ErrorCode::NotFound, "nats-server has just ended", "start it again");
  return core::fail(core::ErrorCode::NotAllowed, "may not signal process " + std::to_string(number) + ": Permission denied", kHowElse);
}

std::string enrolment_text(const std::string& clinic, const std::vector<std::string>& servers, const std::string& ca_pem) {
  std::string list;
  for (const std::string& server : servers) list += (list.empty() ? "" : ", ") + files::toml_quoted(server);
  std::string text = "# For the clinic's PC: beside forward.toml, which names it as enrolment. It holds no secret.\n";
  text += "clinic = " + files::toml_quoted(clinic) + "\nservers = [" + list + "]\n";
  const bool is_plain = ca_pem.find_first_of("\\") == std::string::npos && ca_pem.find("\"\"\"") == std::string::npos;
  if (!ca_pem.empty()) text += "ca = " + (is_plain ? "\"\"\"\n" + ca_pem + "\"\"\"" : files::toml_quoted(ca_pem)) + "\n";
  return text;
}

}  // namespace dts::fleet::hub
