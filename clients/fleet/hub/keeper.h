// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <thread>

#include "core/log.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/clinic_list.h"
#include "fleet/hub/problem.h"
#include "fleet/hub/settings.h"

namespace dts::fleet::hub {

/// The thread that follows the table `clinic` (at once, by NOTIFY), writes the users file and lets nats-server read it. It also creates and
/// migrates the tables, again after each new connection: the database may have been replaced by an older backup. It waits only for
/// PostgreSQL, so that a revoked clinic is cut off at once.
class Keeper {
 public:
  /// All references must outlive this object.
  Keeper(const Settings& settings, std::string hub_public_key, ClinicList& clinics, const core::Log& log);
  void request_stop() { thread_.request_stop(); }

 private:
  void serve(const std::stop_token& stop);
  [[nodiscard]] core::Status migrate_tables();
  [[nodiscard]] core::Status follow_clinics();
  void reload();

  const Settings& settings_;
  std::string hub_public_key_;
  ClinicList& clinics_;
  const core::Log& log_;
  database::Database database_;
  Catalogue catalogue_;
  std::uint64_t migrated_connection_ = 0;  ///< 0: none.
  bool is_reload_due_ = true;              ///< Also at the start: an earlier process may have ended before its SIGHUP.
  Problem database_problem_{log_};
  Problem key_problem_{log_};
  Problem reload_problem_{log_};
  std::jthread thread_{};  ///< Must be the last member: it uses the others.
};

}  // namespace dts::fleet::hub
