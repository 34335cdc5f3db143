// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/result.h"
#include "dts/v1/fleet.pb.h"
#include "fleet/database/database.h"
#include "fleet/hub/quota.h"
#include "fleet/hub/store.h"
#include "record/session_facts.h"

namespace dts::fleet::hub {

struct Clinic {
  std::string id;
  std::string title;
  std::string nkey;  ///< Public key.
  bool is_revoked = false;
  std::string added{};    ///< UTC, as text.
  std::string revoked{};  ///< Empty: not revoked.
};

struct SessionName {
  std::string clinic;
  std::string id;

  friend auto operator<=>(const SessionName&, const SessionName&) = default;
};

/// What the centre has of a session.
struct SessionContent {
  bool is_known = false;  ///< Its facts have arrived.
  bool is_erased = false;
  std::string started{};  ///< UTC, as text.
  std::string protocol{};
  std::int64_t recordings = 0;  ///< With a receipt.
  std::int64_t bytes = 0;       ///< Of them.
  std::int64_t rows = 0;        ///< Parts, trials and results, also those of workers.
};

/// The tables of the centre. All functions may be repeated: late, doubled and reordered calls change nothing. Messages must be checked
/// (wire/messages.h). Errors are those of `Database`. Thread: one at a time, as its database.
class Catalogue {
 public:
  /// Without `quota` nothing is limited.
  explicit Catalogue(database::Database& database, const std::optional<QuotaFigures>& quota = std::nullopt)
      : database_(&database), quota_(quota) {}

  [[nodiscard]] core::Result<std::vector<Clinic>> clinics();
  /// Fails with WrongState if the name or the key exists.
  [[nodiscard]] core::Status add_clinic(const Clinic& clinic, const std::string& who, std::int64_t utc_ns);
  /// Fails with NotFound, and with WrongState if the clinic is revoked already.
  [[nodiscard]] core::Status revoke_clinic(const std::string& clinic, const std::string& who, std::int64_t utc_ns);

  /// Replaces what is known of a session, unless a revision that is not smaller is known. Returns the revision that is known now. Fails
  /// with NotFound if the session was erased, and with WrongState if a recording belongs to another part or the clinic's quota is used up.
  [[nodiscard]] core::Result<std::uint64_t> put_session(const std::string& clinic, const v1::FleetSession& session);
  /// Removes a session and keeps its ID, so that it does not appear again. Its recordings are then `left_recordings`: those of its parts
  /// and receipts, and a receipt of the same recording under another session.
  [[nodiscard]] core::Status erase_session(const SessionName& name, const std::string& who, std::int64_t utc_ns);
  /// Returns the erased sessions of all clinics.
  [[nodiscard]] core::Result<std::set<SessionName>> erased_sessions();
  /// Fails with WrongState if the clinic has used up its quota of erasures.
  [[nodiscard]] core::Status check_room_for_erasure(const std::string& clinic);
  /// Returns what the centre has of a session.
  [[nodiscard]] core::Result<SessionContent> content_of(const SessionName& name);
  /// Returns the recordings that an erasure has left in the store: of a clinic, or of all if `clinic` is empty.
  [[nodiscard]] core::Result<std::vector<RecordingName>> left_recordings(const std::string& clinic);
  /// Removes one of them. Returns false if there was none, or if it has a receipt again and stays.
  [[nodiscard]] core::Result<bool> remove_left(const RecordingName& name, Store& store);
  /// Removes a recording without a receipt from the store. Returns false if there was no recording. Fails with WrongState if it has a
  /// receipt.
  [[nodiscard]] core::Result<bool> remove_recording(const RecordingName& name, Store& store);

  [[nodiscard]] core::Result<bool> is_erased(const std::string& clinic, const std::string& session);
  /// Fails with WrongState if the clinic has used up its quota of recordings.
  [[nodiscard]] core::Status check_room_for_recording(const std::string& clinic);
  [[nodiscard]] core::Result<std::optional<v1::Receipt>> find_receipt(const RecordingName& name);
  /// Enters a recording that is safe in the store, and its receipt; returns the first receipt if there is one. Fails with NotFound if the
  /// clinic has erased the session, with WrongState if the recording belongs to another session, and with DataDamaged if another hub has
  /// removed it from the store.
  [[nodiscard]] core::Result<v1::Receipt> put_recording(const RecordingName& name, const v1::UploadOffer& offer, const Store& store,
                                                        const std::string& hub, std::int64_t stored_utc_ns);
  /// Enters what the header of a recording holds of its session, unless the session is known: with revision 0, which every fact replaces.
  [[nodiscard]] core::Status put_header(const std::string& clinic, const record::SessionFacts& facts);

  /// Returns the newest hash of the audit trail, 32 bytes; empty: no entry.
  [[nodiscard]] core::Result<std::string> put_beat(const std::string& clinic, const v1::Beat& beat, std::int64_t received_utc_ns);
  /// Removes days of `beat_history` that are older than 90 days.
  [[nodiscard]] core::Status prune_history();

 private:
  [[nodiscard]] core::Status lock_session(const std::string& clinic, const std::string& session);
  [[nodiscard]] core::Status lock_recording(const RecordingName& name);
  [[nodiscard]] core::Result<std::uint64_t> put_session_rows(const std::string& clinic, const v1::FleetSession& session, bool is_new);
  [[nodiscard]] core::Status put_parts(const std::string& clinic, const v1::FleetSession& session);
  [[nodiscard]] core::Status put_trials(const std::string& clinic, const v1::FleetSession& session, bool is_new);
  [[nodiscard]] core::Status put_results(const std::string& clinic, const v1::FleetSession& session, bool is_new);
  [[nodiscard]] core::Status put_rigs(const std::string& clinic, const v1::Beat& beat, std::int64_t received_utc_ns);
  [[nodiscard]] core::Result<std::vector<RecordingName>> names(const database::Rows& rows) const;

  database::Database* database_;
  std::optional<QuotaFigures> quota_;
};

}  // namespace dts::fleet::hub
