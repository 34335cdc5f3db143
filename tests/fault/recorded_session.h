// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/clock.h"
#include "core/doorbell.h"
#include "core/worker.h"
#include "fault/reference.h"
#include "pipeline/rig_config.h"
#include "session/recordings.h"
#include "session/supervisor.h"

namespace dts::fault {

/// A state folder whose recordings no limit of room stops.
[[nodiscard]] session::StorageConfig storage_in(const std::string& folder);

/// How a session went, as its operator saw it.
struct SessionCourse {
  bool has_started = false;  ///< `start_session` said so: from then on the session must be found again.
  std::string session_id;
  bool is_over = false;   ///< Its recording is closed, or given up.
  std::string refusal{};  ///< Why it did not start.
  std::string hang{};     ///< What did not come to an end.
};

/// The parts of the daemon that record, in this process: supervisor, rig with its threads, record thread, catalogue.
class RecordedSession {
 public:
  /// Fails as Recordings::open.
  [[nodiscard]] static core::Result<std::unique_ptr<RecordedSession>> open(const std::string& folder, pipeline::RigConfig rig,
                                                                           core::Clock& clock);
  ~RecordedSession();
  RecordedSession(const RecordedSession&) = delete;
  RecordedSession& operator=(const RecordedSession&) = delete;

  [[nodiscard]] SessionCourse start(const std::string& subject = "P001");
  /// Lets the daemon's control thread do its work for so long by `clock`; `between` is called every turn.
  void run_for(double seconds, const std::function<void()>& between = {});
  void stop(SessionCourse& course);

 private:
  RecordedSession(core::Clock& clock, std::unique_ptr<session::Recordings> recordings);
  [[nodiscard]] bool tick_until(const std::function<bool()>& condition);
  void tick();
  void audit(const std::string& what, const std::string& target);

  core::Clock& clock_;
  core::Doorbell bell_;
  core::Worker worker_{"analyse"};
  std::unique_ptr<session::Recordings> recordings_;
  session::Supervisor supervisor_;
};

/// Starts the recording part of a daemon on what an earlier one left, on a sound disk, and looks whether it keeps its promises: the
/// catalogue opens; every interrupted recording is recovered; no part is listed as what its file does not bear out; recorded scans are the
/// simulator's. Returns what is wrong, or nothing.
struct Afterwards {
  std::string problem;
  std::vector<record::SessionRow> sessions{};  ///< With parts.
};
[[nodiscard]] Afterwards look_afterwards(const std::string& folder, const Reference& reference);

}  // namespace dts::fault
