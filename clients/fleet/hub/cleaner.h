// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <thread>

#include "core/clock.h"
#include "core/log.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/erasures.h"
#include "fleet/hub/ingest.h"
#include "fleet/hub/problem.h"
#include "fleet/hub/settings.h"

namespace dts::fleet::hub {

/// The thread that removes what erasures have left, uploads that do not continue, and old history: every 10 minutes, and after each new
/// connection to the database. Then it also compares the journal of erasures with the database, which may have been replaced by an older
/// backup. It may wait long for the store.
class Cleaner {
 public:
  /// All references must outlive this object.
  Cleaner(const Settings& settings, Ingest& ingest, Store& store, const core::Clock& clock, const core::Log& log);
  void request_stop() { thread_.request_stop(); }

 private:
  void serve(const std::stop_token& stop);
  /// Does all of it, whatever fails; returns the first failure. Does nothing if the tables cannot be migrated.
  [[nodiscard]] core::Status clean();
  [[nodiscard]] core::Status reconcile_erasures();

  Ingest& ingest_;
  const core::Clock& clock_;
  const core::Log& log_;
  database::Database database_;
  Catalogue catalogue_;
  Erasures erasures_;
  std::uint64_t reconciled_connection_ = 0;  ///< With it, the journal of erasures and the database were compared. 0: none.
  Problem problem_{log_};
  std::jthread thread_{};  ///< Must be the last member: it uses the others.
};

}  // namespace dts::fleet::hub
