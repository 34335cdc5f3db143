// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <thread>

#include "core/clock.h"
#include "core/log.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/clinic_list.h"
#include "fleet/hub/erasures.h"
#include "fleet/hub/ingest.h"
#include "fleet/hub/settings.h"

namespace dts::fleet::hub {

/// The thread that keeps the hub in order: creates and migrates the tables, follows the table `clinic` (at once, by NOTIFY), writes the
/// users file and lets nats-server read it, removes what erasures have left, uploads that do not continue, and old history. At the start it
/// erases what only the journal of erasures knows.
class Keeper {
 public:
  /// All references must outlive this object.
  Keeper(const Settings& settings, std::string hub_public_key, ClinicList& clinics, Ingest& ingest, Store& store, const core::Clock& clock,
         const core::Log& log);
  void request_stop() { thread_.request_stop(); }

 private:
  void serve(const std::stop_token& stop);
  [[nodiscard]] core::Status follow_clinics();
  void reload();
  /// Does all of it, whatever fails; returns the first failure.
  [[nodiscard]] core::Status clean();
  [[nodiscard]] core::Status reconcile_erasures();
  /// Logs a problem once, and its end. `problem`: of the same matter, as it was.
  void report(const core::Status& status, std::string& problem) const;

  const Settings& settings_;
  std::string hub_public_key_;
  ClinicList& clinics_;
  Ingest& ingest_;
  const core::Clock& clock_;
  const core::Log& log_;
  database::Database database_;
  Catalogue catalogue_;
  Erasures erasures_;
  bool is_migrated_ = false;
  bool is_reconciled_ = false;  ///< The journal of erasures and the database.
  bool is_reload_due_ = true;   ///< Also at the start: an earlier process may have ended before its SIGHUP.
  std::string database_problem_{};
  std::string key_problem_{};
  std::string reload_problem_{};
  std::string clean_problem_{};
  std::jthread thread_{};  ///< Must be the last member: it uses the others.
};

}  // namespace dts::fleet::hub
