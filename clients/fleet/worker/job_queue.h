// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fleet/database/database.h"
#include "fleet/worker/figures.h"

namespace dts::fleet::worker {

struct QueueOptions {
  std::string worker;                    ///< Differs from that of every other worker, also from those that have ended.
  std::string version;                   ///< Of this worker's dtslab: jobs for another version are left to other workers.
  std::chrono::seconds lease{60};        ///< Another worker takes the job if it was not renewed for so long.
  std::chrono::seconds retry_pause{10};  ///< After a failed try.
};

/// A job that this worker has, and its recording.
struct TakenJob {
  std::int64_t id = 0;
  std::string kind;
  std::string clinic;
  std::string session;
  std::uint32_t part = 0;
  std::int64_t tries = 0;  ///< This one included.
  std::string sha256;      ///< Hexadecimal; empty: the catalogue has no recording, as with the next.
  std::string store_key;
};

/// The worker's side of table `job`. A job that was taken by another worker meanwhile is not changed, and its results are not written:
/// `renew`, `finish`, `fail`, `postpone` and `give_back` then return false. They also do after the clinic has erased the session. All fail
/// as `Database` does, and may then be repeated. Thread: that of the database.
class JobQueue {
 public:
  static constexpr int kMostTries = 5;

  JobQueue(database::Database& database, QueueOptions options) : database_(database), options_(std::move(options)) {}

  /// Takes a job that waits, or whose worker has not renewed it: of those with the fewest tries the oldest. Returns nothing if there is
  /// none. Then also gives up jobs whose workers have ended in each of `kMostTries`.
  [[nodiscard]] core::Result<std::optional<TakenJob>> take();
  [[nodiscard]] core::Result<bool> renew(const TakenJob& job);
  /// Writes the results and ends the job, both or neither. Results of the same analysis are replaced, those of the clinic never.
  [[nodiscard]] core::Result<bool> finish(const TakenJob& job, const std::vector<Figure>& figures, const std::string& message);
  /// Ends this try. The job is tried again later, unless `is_final` or this was the last try.
  [[nodiscard]] core::Result<bool> fail(const TakenJob& job, const std::string& message, bool is_final);
  /// Ends this try as if it had not been one: the reason is not the recording. Then others have their turn, for as long as all tries of a
  /// job need pauses: a job for which this always happens does not hold up the others.
  [[nodiscard]] core::Result<bool> postpone(const TakenJob& job, const std::string& message);
  /// Gives the job to other workers, as if it had not been taken.
  [[nodiscard]] core::Result<bool> give_back(const TakenJob& job);

 private:
  [[nodiscard]] core::Result<bool> write(const TakenJob& job, const std::vector<Figure>& figures, const std::string& message);

  database::Database& database_;
  QueueOptions options_;
};

}  // namespace dts::fleet::worker
