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

using database::migrate;

using SteadyTime = std::chrono::steady_clock::time_point;

constexpr auto kTurn = std::chrono::milliseconds(200);   // until a stop is noticed
constexpr auto kFollowPause = std::chrono::seconds(30);  // if a notification was lost
constexpr auto kCleanPause = std::chrono::minutes(10);
constexpr auto kRetry = std::chrono::seconds(1);
constexpr const char* kClinicChannel = "clinic";

}  // namespace

Keeper::Keeper(const Settings& settings, std::string hub_public_key, ClinicList& clinics, Ingest& ingest, Store& store,
               const core::Clock& clock, const core::Log& log)
    : settings_(settings),
      hub_public_key_(std::move(hub_public_key)),
      clinics_(clinics),
      ingest_(ingest),
      clock_(clock),
      log_(log),
      database_({.connection = settings.connection, .name = "dts-hub keeper"}),
      catalogue_(database_),
      erasures_(catalogue_, store, ErasureJournal(settings.directory)) {
  database_.listen(kClinicChannel);
  thread_ = std::jthread([this](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread("keeper", {}));
    serve(stop);
  });
}

void Keeper::serve(const std::stop_token& stop) {
  SteadyTime next_follow{};
  SteadyTime next_clean{};
  SteadyTime next_reload{};
  while (!stop.stop_requested()) {
    try {
      if (!is_migrated_) {
        const auto migrated = migrate(database_);
        is_migrated_ = migrated.has_value();
        report(migrated, database_problem_);
      }
      const auto notified = database_.wait_notification(kTurn);
      if (!notified) {
        report(tl::make_unexpected(notified.error()), database_problem_);
        std::this_thread::sleep_for(kTurn);
      }
      const auto now = std::chrono::steady_clock::now();
      if (is_migrated_ && notified && (*notified || now >= next_follow)) {
        const auto followed = follow_clinics();
        next_follow = now + (followed ? std::chrono::duration_cast<std::chrono::milliseconds>(kFollowPause) : kRetry);
        next_reload = now;
        report(followed, database_problem_);
      }
      if (is_reload_due_ && now >= next_reload) {
        next_reload = now + kRetry;
        reload();
      }
      if (is_migrated_ && now >= next_clean) {
        next_clean = now + kCleanPause;
        report(clean(), clean_problem_);
      }
    } catch (const std::exception& exception) {  // no memory left
      log_.error(std::string("keeper: ") + exception.what());
    }
  }
}

core::Status Keeper::follow_clinics() {
  DTS_TRY_ASSIGN(const auto clinics, catalogue_.clinics());
  std::set<std::string> active;
  for (const Clinic& clinic : clinics) {
    if (!clinic.is_revoked) active.insert(clinic.id);
  }
  clinics_.set(std::move(active));
  report(check_keys(hub_public_key_, settings_.dashboards, clinics), key_problem_);
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
  report(reloaded, reload_problem_);
}

core::Status Keeper::clean() {
  const auto reconciled = reconcile_erasures();  // first: it names recordings to remove
  const auto left = erasures_.remove_left("");
  const core::Status removed = left ? core::Status() : core::Status(tl::make_unexpected(left.error()));
  core::Status first;
  for (const core::Status& done : {reconciled, catalogue_.prune_history(), ingest_.clean(catalogue_), removed}) {
    if (!done && first) first = done;
  }
  return first;
}

core::Status Keeper::reconcile_erasures() {
  if (is_reconciled_) return {};
  DTS_TRY_ASSIGN(const std::uint64_t erased, erasures_.reconcile(clock_.now_ns() + clock_.utc_minus_monotonic_ns()));
  if (erased > 0) log_.warning("erased " + std::to_string(erased) + " sessions that the database did not know as erased: it is older");
  is_reconciled_ = true;
  return {};
}

void Keeper::report(const core::Status& status, std::string& problem) const {
  std::string now = status ? "" : core::to_string(status.error());
  if (!now.empty() && now != problem) log_.error(now);
  if (now.empty() && !problem.empty()) log_.info("no longer: " + problem);
  problem = std::move(now);
}

}  // namespace dts::fleet::hub
