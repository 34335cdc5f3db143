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

/// A recording that has ended, complete or not.
struct FinishedRecording {
  std::string rig;
  std::string file;    ///< The file as it is now on the disk.
  std::string sha256;  ///< Empty if the file could not be closed.
  std::uint64_t bytes = 0;
  std::uint64_t scans = 0;
  double duration_s = 0.0;
  core::Losses losses{};
  std::string incomplete;  ///< Why data are missing; empty: complete.
  bool is_closed = false;  ///< false: the .part file remains until it is recovered.
};

/// State of a recording.
struct RecordingView {
  bool is_recording = false;
  std::string file;
  std::uint64_t bytes = 0;
  std::uint64_t lost_scans = 0;
  std::string problem;
  double lag_s = 0.0;  ///< Length of data that a power cut now would lose; 0 while nothing is recorded.
};

/// The record thread: reads frames from the taps of all rigs, writes chunks, requests an fdatasync twice a second, and closes recordings.
/// It may wait for the disk as long as the taps have room; no other thread waits for it. A recording that fails, whose disk is nearly full,
/// or whose file was removed is closed as incomplete immediately; its remaining frames are dropped until the control thread ends the take.
class RecordThread {
 public:
  /// Checks the disk against `storage.stop_below_mib` every second.
  RecordThread(core::Clock& clock, StorageConfig storage) : clock_(clock), storage_(std::move(storage)) {}
  ~RecordThread() { stop(); }
  RecordThread(const RecordThread&) = delete;
  RecordThread& operator=(const RecordThread&) = delete;

  /// Call before `start`. The tap outlives the thread.
  void add(const std::string& rig, RecordTap& tap);
  void start();
  /// Closes open recordings as incomplete.
  void stop() noexcept;

  /// Starts a recording of the frames of `take`; call it before that take is opened. Thread: control.
  void begin(const std::string& rig, std::unique_ptr<record::Recorder> recorder, std::string file, std::uint64_t take);
  /// Adds an event to the recording. Thread: control.
  void post(const std::string& rig, v1::Event event);
  /// Marks the current recording as incomplete for a reason that its frames do not show. Thread: control.
  void mark_incomplete(const std::string& rig, std::string reason);
  /// Thread: control.
  [[nodiscard]] std::vector<FinishedRecording> take_finished();
  [[nodiscard]] RecordingView view(const std::string& rig);
  /// Forgets the state of the last recording, which was erased; has no effect while one is open. Thread: control.
  void forget(const std::string& rig);
  /// Waits until no recording is open, at most `limit`. Thread: control.
  void wait_until_closed(std::chrono::milliseconds limit);

 private:
  /// The recording of one rig. The first part belongs to the record thread, the second part is protected by the mutex.
  struct Line {
    RecordTap* tap = nullptr;
    std::unique_ptr<record::Recorder> recorder;  ///< Absent: nothing is recorded, or the recording failed.
    std::string file;
    std::uint64_t take = 0;
    bool has_frames = false;
    std::uint64_t lost_scans = 0;   ///< As reported by the tap.
    std::uint64_t lost_events = 0;  ///< As reported by the tap.
    bool is_new = false;            ///< Its files are not yet added to `sync_`.
    bool is_synced_aside = false;   ///< `sync_` synchronises its files; false: this thread does.
    std::int64_t emptied_ns = 0;    ///< Last time that the tap was empty.
    std::int64_t written_ns = 0;    ///< `emptied_ns` at the last flush: data received up to then were written to the file.
    std::int64_t flushed_ns = 0;
    std::int64_t synchronised_ns = 0;
    std::int64_t on_disk_ns = 0;  ///< Data received up to then are on the disk; `sync_` may know a later time.

    std::unique_ptr<record::Recorder> next_recorder;
    std::string next_file;
    std::uint64_t next_take = 0;
    std::vector<v1::Event> events;
    RecordingView view;
    std::int64_t safe_until_ns = 0;  ///< Data received up to then are on the disk.
  };
  void run(const std::stop_token& stop);
  void receive(const std::string& rig, Line& line);
  [[nodiscard]] std::vector<v1::Event> take_orders(const std::string& rig, Line& line);
  [[nodiscard]] bool serve(const std::string& rig, Line& line);
  void serve_rest(const std::string& rig, Line& line);
  [[nodiscard]] bool drain(const std::string& rig, Line& line);
  void record(const std::string& rig, Line& line, const RecordTap::Item& item);
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
  RecordSync sync_;
  std::jthread thread_;
};

}  // namespace dts::session
