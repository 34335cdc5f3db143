// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/keeper.h"

#include <exception>
#include <set>
#include <utility>

#include "core/thread.h"
#include "fleet/database/schema.h"
#include "fleet/hub/users_file.h"

namespace dts::fleet::hub {
namespace {

using SteadyTime = std::chrono::steady_clock::time_point;

constexpr auto kTurn = std::chrono::milliseconds(200);   // until a stop is noticed
constexpr auto kFollowPause = std::chrono::seconds(30);  // if a notification was lost
constexpr auto kRetry = std::chrono::seconds(1);
constexpr const char* kClinicChannel = "clinic";

}  // namespace

Keeper::Keeper(const Settings& settings, std::string hub_public_key, ClinicList& clinics, const core::Log& log)
    : settings_(settings),
      hub_public_key_(std::move(hub_public_key)),
      clinics_(clinics),
      log_(log),
      database_({.connection = settings.connection, .name = "dts-hub keeper"}),
      catalogue_(database_) {
  database_.listen(kClinicChannel);
  thread_ = std::jthread([this](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread("keeper", {}));
    serve(stop);
  });
}

void Keeper::serve(const std::stop_token& stop) {
  SteadyTime next_follow{};
  SteadyTime next_reload{};
  while (!stop.stop_requested()) {
    try {
      const auto notified = database_.wait_notification(kTurn);
      if (!notified) {
        database_problem_.report(tl::make_unexpected(notified.error()));
        std::this_thread::sleep_for(kTurn);
      }
      if (notified && migrated_connection_ != database_.connections()) {
        const auto migrated = migrate_tables();
        database_problem_.report(migrated);
        if (migrated) next_follow = {};
      }
      const auto now = std::chrono::steady_clock::now();
      const bool is_migrated = migrated_connection_ == database_.connections();
      if (notified && is_migrated && (*notified || now >= next_follow)) {
        const auto followed = follow_clinics();
        next_follow = now + (followed ? std::chrono::duration_cast<std::chrono::milliseconds>(kFollowPause) : kRetry);
        next_reload = now;
        database_problem_.report(followed);
      }
      if (is_reload_due_ && now >= next_reload) {
        next_reload = now + kRetry;
        reload();
      }
    } catch (const std::exception& exception) {  // no memory left
      log_.error(std::string("keeper: ") + exception.what());
    }
  }
}

core::Status Keeper::migrate_tables() {
  const std::uint64_t connection = database_.connections();
  DTS_TRY(database::migrate(database_));
  migrated_connection_ = connection;
  return {};
}

core::Status Keeper::follow_clinics() {
  DTS_TRY_ASSIGN(const auto clinics, catalogue_.clinics());
  std::set<std::string> active;
  for (const Clinic& clinic : clinics) {
    if (!clinic.is_revoked) active.insert(clinic.id);
  }
  clinics_.set(std::move(active));
  key_problem_.report(check_keys(hub_public_key_, settings_.dashboards, clinics));
  DTS_TRY_ASSIGN(const bool is_written, write_users(settings_, hub_public_key_, clinics));
  if (is_written) {
    is_reload_due_ = true;
    log_.info("wrote the users of nats-server: " + settings_.users_file);
  }
  return {};
}

void Keeper::reload() {
  is_reload_due_ = false;
  if (settings_.pid_file.empty() || settings_.users_file.empty()) return;
  const auto reloaded = reload_nats(settings_.pid_file);
  if (!reloaded) is_reload_due_ = true;
  reload_problem_.report(reloaded);
}

}  // namespace dts::fleet::hub
