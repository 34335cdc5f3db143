// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "core/result.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/store.h"

namespace dts::fleet::hub {

/// The erased sessions in a file beside the recordings: FOLDER/erased, one line each, "kent 20261121T144525Z-floor-1 erased". A database
/// that is restored from an older backup does not know the newest erasures; this file does. It only grows. Several processes may append.
/// Thread: any.
class ErasureJournal {
 public:
  explicit ErasureJournal(const std::string& folder) : file_(folder + "/erased") {}

  /// Creates the file if there is none, so that a backup finds it.
  [[nodiscard]] core::Status create() const;
  /// Appends one line; it is on the disk when this returns.
  [[nodiscard]] core::Status add(const SessionName& name) const;
  /// Skips lines that a power failure has torn.
  [[nodiscard]] core::Result<std::set<SessionName>> read() const;

 private:
  [[nodiscard]] core::Status append(const std::string& line) const;

  std::string file_;
};

/// Erases sessions at the centre: first the line in the journal, then the rows, then the recordings. What a crash leaves of that is done by
/// `reconcile` and `remove_left`. All may be repeated. Thread: one at a time, as the catalogue.
class Erasures {
 public:
  Erasures(Catalogue& catalogue, Store& store, ErasureJournal journal)
      : catalogue_(catalogue), store_(store), journal_(std::move(journal)) {}

  /// Returns how many recordings were removed from the store. Fails with WrongState if the clinic has used up its quota of erasures; a
  /// session that was erased before never fails for that reason.
  [[nodiscard]] core::Result<std::uint32_t> erase(const SessionName& name, const std::string& who, std::int64_t utc_ns);
  /// Erases what only the journal knows, and appends to the journal what only the database knows. Returns how many sessions were erased.
  [[nodiscard]] core::Result<std::uint64_t> reconcile(std::int64_t utc_ns);
  /// Removes the recordings that erasures have left in the store: of a clinic, or of all if `clinic` is empty. Returns how many. One that
  /// cannot be removed does not stop the others; the first such failure is returned at the end. Stops with Unreachable if the store or the
  /// database does not answer: each further recording would wait for it again.
  [[nodiscard]] core::Result<std::uint32_t> remove_left(const std::string& clinic);

 private:
  Catalogue& catalogue_;
  Store& store_;
  ErasureJournal journal_;
};

}  // namespace dts::fleet::hub
