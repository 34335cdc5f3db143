// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "core/thread.h"
#include "record/recorder.h"
#include "session/record_sync.h"
#include "session/record_tap.h"
#include "session/storage.h"

namespace dts::session {

/// A recording that came to its end, one way or another.
struct FinishedRecording {
  std::string rig;
  std::string file;    ///< What is on the disk now.
  std::string sha256;  ///< Empty when it could not be closed.
  std::uint64_t bytes = 0;
  std::uint64_t scans = 0;
  double duration_s = 0.0;
  core::Losses losses{};
  std::string incomplete;  ///< Why something is missing; empty: whole.
  bool is_closed = false;  ///< false: the .part file stays and waits for its recovery.
};

/// How a recording under way stands.
struct RecordingView {
  bool is_recording = false;
  std::string file;
  std::uint64_t bytes = 0;
  std::uint64_t lost_scans = 0;
  std::string problem;
  double lag_s = 0.0;  ///< What a power cut now would take; 0: nothing is recorded.
};

/// The record thread: takes frames from the taps of all rigs, writes chunks, has them synchronised twice a second, and closes recordings.
/// It may wait for the disk as long as the taps hold; nobody waits for it. A recording that fails, or that meets a disk nearly full, is
/// closed as incomplete at once; its frames are then thrown away until the control thread ends the take. So is one whose file was removed.
class RecordThread {
 public:
  /// `stop_below_mib` of `storage` is watched every second.
  RecordThread(core::Clock& clock, StorageConfig storage) : clock_(clock), storage_(std::move(storage)) {}
  ~RecordThread() { stop(); }
  RecordThread(const RecordThread&) = delete;
  RecordThread& operator=(const RecordThread&) = delete;

  /// Before `start`. The tap outlives the thread.
  void add(const std::string& rig, RecordTap& tap);
  void start();
  /// Closes what is still open as incomplete.
  void stop() noexcept;

  /// Hands a recording over, before its take is opened: it consists of the frames of `take`. Thread: control.
  void begin(const std::string& rig, std::unique_ptr<record::Recorder> recorder, std::string file, std::uint64_t take);
  /// Something that happened during the recording. Thread: control.
  void post(const std::string& rig, record::RecordedEvent event);
  /// The recording under way lacks something that its frames do not show: it will be closed as incomplete. Thread: control.
  void mark_incomplete(const std::string& rig, std::string reason);
  /// Thread: control.
  [[nodiscard]] std::vector<FinishedRecording> take_finished();
  [[nodiscard]] RecordingView view(const std::string& rig);
  /// Waits until no recording is open any more, or for `limit`. Thread: control.
  void wait_until_closed(std::chrono::milliseconds limit);

 private:
  /// What a rig's recording is made of. The first part belongs to the thread, the second to whoever holds the mutex.
  struct Line {
    RecordTap* tap = nullptr;
    std::unique_ptr<record::Recorder> recorder;  ///< Absent: nothing is recorded, or it has failed.
    std::string file;
    std::uint64_t take = 0;
    bool has_frames = false;
    std::uint64_t lost_scans = 0;   ///< As the tap says.
    std::uint64_t lost_events = 0;  ///< The same.
    bool is_new = false;            ///< Its files are not known to the synchronising thread yet.
    bool is_synced_aside = false;   ///< They are; otherwise this thread does it.
    std::int64_t emptied_ns = 0;    ///< The last time that nothing waited in the tap.
    std::int64_t written_ns = 0;    ///< The same at the last flush: what was taken up to then has left this process.
    std::int64_t flushed_ns = 0;
    std::int64_t synchronised_ns = 0;
    std::int64_t on_disk_ns = 0;  ///< What was taken up to then is on the disk, but for what `sync_` knows better.

    std::unique_ptr<record::Recorder> next_recorder;
    std::string next_file;
    std::uint64_t next_take = 0;
    std::vector<record::RecordedEvent> events;
    RecordingView view;
    std::int64_t safe_until_ns = 0;  ///< What was taken up to then is on the disk.
  };
  void run(const std::stop_token& stop);
  void receive(const std::string& rig, Line& line);
  [[nodiscard]] std::vector<record::RecordedEvent> take_orders(const std::string& rig, Line& line);
  [[nodiscard]] bool serve(const std::string& rig, Line& line);
  void serve_rest(const std::string& rig, Line& line);
  [[nodiscard]] bool drain(const std::string& rig, Line& line);
  void take_slot(const std::string& rig, Line& line, const RecordTap::Slot& slot);
  void keep_up(const std::string& rig, Line& line);
  void finish(const std::string& rig, Line& line, const std::string& incomplete);
  void watch_disk();

  core::Clock& clock_;
  StorageConfig storage_;
  std::condition_variable one_closed_;
  std::mutex mutex_;  ///< Held for moving values only, never across I/O.
  std::map<std::string, Line> lines_;
  std::vector<FinishedRecording> finished_;
  std::int64_t looked_at_disk_ns_ = 0;
  bool is_disk_full_ = false;
  std::vector<core::Event> events_;  ///< Of the slot under way.
  RecordSync sync_;
  std::jthread thread_;
};

}  // namespace dts::session
