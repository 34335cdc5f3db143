// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/cleaner.h"

#include <chrono>
#include <exception>
#include <string>

#include "core/thread.h"
#include "fleet/database/schema.h"

namespace dts::fleet::hub {
namespace {

constexpr auto kCleanTurn = std::chrono::milliseconds(200);  // until a stop or the end of a connection is noticed
constexpr auto kCleanPause = std::chrono::minutes(10);

}  // namespace

Cleaner::Cleaner(const Settings& settings, Ingest& ingest, Store& store, const core::Clock& clock, const core::Log& log)
    : ingest_(ingest),
      clock_(clock),
      log_(log),
      database_({.connection = settings.connection, .name = "dts-hub cleaner"}),
      catalogue_(database_),
      erasures_(catalogue_, store, ErasureJournal(settings.directory)) {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread("cleaner", {}));
    serve(stop);
  });
}

void Cleaner::serve(const std::stop_token& stop) {
  std::chrono::steady_clock::time_point next_clean{};
  std::uint64_t cleaned_connection = 0;
  while (!stop.stop_requested()) {
    try {
      if (!database_.wait_notification(kCleanTurn)) {  // the keeper logs it
        std::this_thread::sleep_for(kCleanTurn);
        continue;
      }
      const auto now = std::chrono::steady_clock::now();
      if (now < next_clean && cleaned_connection == database_.connections()) continue;
      next_clean = now + kCleanPause;
      cleaned_connection = database_.connections();
      problem_.report(clean());
    } catch (const std::exception& exception) {  // no memory left
      log_.error(std::string("cleaner: ") + exception.what());
    }
  }
}

core::Status Cleaner::clean() {
  DTS_TRY(database::migrate(database_));
  const auto reconciled = reconcile_erasures();  // first: it names recordings to remove
  const auto left = erasures_.remove_left("");
  const core::Status removed = left ? core::Status() : core::Status(tl::make_unexpected(left.error()));
  core::Status first;
  for (const core::Status& done : {reconciled, catalogue_.prune_history(), ingest_.clean(catalogue_), removed}) {
    if (!done && first) first = done;
  }
  return first;
}

core::Status Cleaner::reconcile_erasures() {
  const std::uint64_t connection = database_.connections();
  if (reconciled_connection_ == connection) return {};
  DTS_TRY_ASSIGN(const std::uint64_t erased, erasures_.reconcile(clock_.now_ns() + clock_.utc_minus_monotonic_ns()));
  if (erased > 0) log_.warning("erased " + std::to_string(erased) + " sessions that the database did not know as erased: it is older");
  reconciled_connection_ = connection;
  return {};
}

}  // namespace dts::fleet::hub
