// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/clock.h"
#include "core/log.h"
#include "core/token_bucket.h"
#include "dts/v1/fleet.pb.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/staging.h"
#include "fleet/hub/store.h"

namespace dts::fleet::hub {

struct IngestOptions {
  std::string hub;                               ///< Name of this hub.
  double full_at_percent = 95.0;                 ///< Of the store.
  std::uint64_t bytes_a_day = 200'000'000'000;   ///< Of a clinic, UTC days; counted since the hub started.
  std::uint64_t staged_bytes = 100'000'000'000;  ///< Of a clinic: the sizes of its files that are not whole yet.
  std::function<void(std::string_view step)> reached = [](std::string_view /*step*/) {};  ///< For tests: after each step of a commit.
};

struct IngestCounts {
  std::uint64_t bytes_total = 0;     ///< Of chunks that were written.
  std::uint64_t receipts_total = 0;  ///< That this process wrote.
  std::uint64_t torn_total = 0;      ///< Files whose SHA-256 was not the offered one.
  std::uint64_t later_total = 0;     ///< Answers "later".
  std::uint64_t uploads = 0;         ///< Not whole yet.
  std::uint64_t staged_bytes = 0;    ///< Of them, received so far.
};

/// Receives recordings. The order of a commit: synchronise the file, compute its SHA-256 from the disk, move it into the store, synchronise
/// the folder, write part and receipt in one transaction, answer. So a receipt never exists without its recording, at whatever step the
/// process or the power ends. A recording in the store without a row is found when the clinic sends its commit again.
/// Thread: `open`, `take`, `commit`, `drop_session` and `clean` each on one thread at a time; different ones at the same time.
class Ingest {
 public:
  static constexpr std::int64_t kAbandonedNs = 7LL * 24 * 3600 * core::kNanosecondsPerSecond;

  /// Continues the uploads in `staging`. `store`, `clock` and `log` must outlive this object.
  [[nodiscard]] static core::Result<std::unique_ptr<Ingest>> create(IngestOptions options, std::unique_ptr<Staging> staging, Store& store,
                                                                    const core::Clock& clock, const core::Log& log);

  /// Answers an offer.
  [[nodiscard]] v1::UploadAnswer open(const std::string& clinic, const v1::UploadOffer& offer, Catalogue& catalogue);
  /// Writes a chunk if it is the next one. Never waits for a commit.
  [[nodiscard]] v1::UploadAnswer take(const std::string& clinic, const v1::UploadChunk& chunk);
  /// Takes as long as reading the whole file from the disk; `stop` ends it.
  [[nodiscard]] v1::UploadAnswer commit(const std::string& clinic, const v1::UploadCommit& commit, Catalogue& catalogue,
                                        const std::stop_token& stop);
  /// Drops the uploads of an erased session, also from the store if they are there without a receipt. Fails as the catalogue does, as the
  /// next.
  [[nodiscard]] core::Status drop_session(const SessionName& session, Catalogue& catalogue);
  /// Drops the uploads whose session was erased by way of another program, and those that have not changed for 7 days. Ends those that have
  /// a receipt: another hub has received the rest.
  [[nodiscard]] core::Status clean(Catalogue& catalogue);

  [[nodiscard]] IngestCounts counts() const;

 private:
  struct Upload {
    v1::UploadOffer offer;
    std::uint64_t have = 0;
    std::int64_t changed_utc_ns = 0;
    bool is_in_store = false;    ///< The file is in the store already, and its row may be missing.
    bool is_committing = false;  ///< Its file must not change.
  };
  /// What a clinic may use of the thread that commits.
  struct Share {
    core::TokenBucket failures{1.0 / 60.0, 10.0};  ///< Files that are not what was offered.
    core::TokenBucket seconds{0.5, 30.0};          ///< Half of the time; 30 s at once.
  };
  struct Day {
    std::int64_t number = 0;
    std::uint64_t bytes = 0;
  };

  Ingest(IngestOptions options, std::unique_ptr<Staging> staging, Store& store, const core::Clock& clock, const core::Log& log)
      : options_(std::move(options)), staging_(std::move(staging)), store_(store), clock_(clock), log_(log) {}
  [[nodiscard]] std::int64_t utc_ns() const noexcept { return clock_.now_ns() + clock_.utc_minus_monotonic_ns(); }
  /// Continues an upload. `is_store_away`: then it does not ask the store; it also sets it.
  [[nodiscard]] core::Status adopt(Staging::Upload found, bool& is_store_away);
  [[nodiscard]] v1::UploadAnswer begin(const RecordingName& name, const v1::UploadOffer& offer);
  [[nodiscard]] v1::UploadAnswer commit_whole(const RecordingName& name, const Upload& upload, Catalogue& catalogue,
                                              const std::stop_token& stop);
  [[nodiscard]] core::Result<bool> verify(const RecordingName& name, const Upload& upload, const std::stop_token& stop);
  void start_again(const RecordingName& name, bool is_in_store, Catalogue& catalogue);
  void finish(const RecordingName& name);
  /// Drops the uploads that `is_chosen` returns true for, called with `mutex_`.
  [[nodiscard]] core::Status drop(const std::function<bool(const RecordingName&, const Upload&)>& is_chosen, Catalogue& catalogue);
  [[nodiscard]] bool is_full() const { return store_.used_percent() >= options_.full_at_percent; }
  [[nodiscard]] std::uint64_t offered_bytes(const std::string& clinic) const;  ///< Requires `mutex_`.
  [[nodiscard]] core::TokenBucket::Time steady_time() const { return core::TokenBucket::Time(std::chrono::nanoseconds(clock_.now_ns())); }
  [[nodiscard]] bool is_day_spent(const std::string& clinic, std::uint64_t bytes);  ///< Requires `mutex_`.
  [[nodiscard]] v1::UploadAnswer upload_answer(std::uint64_t have) const;
  [[nodiscard]] v1::UploadAnswer later(const std::string& reason, std::uint32_t wait_s);
  /// Logs the error of the store. Returns "later".
  [[nodiscard]] v1::UploadAnswer store_failed(const core::Error& error);

  IngestOptions options_;
  std::unique_ptr<Staging> staging_;
  Store& store_;
  const core::Clock& clock_;
  const core::Log& log_;

  mutable std::mutex mutex_;  ///< Protects all members below, and the files of uploads that are not being committed.
  std::map<RecordingName, Upload> uploads_{};
  std::map<std::string, Day> days_{};
  std::map<std::string, Share> shares_{};
  IngestCounts counts_{};
};

}  // namespace dts::fleet::hub
