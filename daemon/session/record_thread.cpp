// SPDX-License-Identifier: Apache-2.0
#include "session/record_thread.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "record/xdf/recovery.h"

namespace dts::session {
namespace {

constexpr std::int64_t kTurnNs = 40'000'000;  // with two turns and kFlushNs, data are written within kLongestUnwrittenS
constexpr auto kSynchroniseNs = static_cast<std::int64_t>(record::kLongestUnsynchronisedS * 0.9e9);
constexpr auto kFlushNs = static_cast<std::int64_t>(record::kLongestUnwrittenS * 0.6e9);
constexpr std::int64_t kLookAtDiskNs = 1'000'000'000;
constexpr std::size_t kItemsPerTurn = 256;  // after that, the other rigs have their turn

/// Fails with NotFound if the file was deleted: later writes would vanish when it is closed.
core::Status check_there(const std::string& file) {
  if (::access(file.c_str(), F_OK) == 0 || errno != ENOENT) return {};
  return core::fail(core::ErrorCode::NotFound, file + " was deleted or moved during the recording",
                    "start a new session; do not touch a file while dtsd records into it");
}

/// Closes a recording. If a complete recording cannot be closed as complete, stores the error in `reason` and tries again with this reason
/// in the footers.
core::Result<record::XdfWriter::Closed> close(record::Recorder& recorder, std::string& reason) {
  auto closed = recorder.close(reason);
  if (closed || !reason.empty()) return closed;
  reason = core::to_string(closed.error());
  return recorder.close(reason);
}

/// Reports lost scans to the recorder that no jump between two frames shows.
void note_unseen_loss(record::Recorder& recorder, std::uint64_t lost_scans) {
  if (lost_scans > recorder.lost_scans()) recorder.note_loss(lost_scans - recorder.lost_scans());
}

}  // namespace

void RecordThread::add(const std::string& rig, RecordTap& tap) { lines_[rig].tap = &tap; }

void RecordThread::start() {
  sync_.start();
  thread_ = std::jthread([this](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread("record", {}));  // default policy, cannot be rejected
    run(stop);
  });
}

void RecordThread::stop() noexcept {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  sync_.stop();
}

void RecordThread::begin(const std::string& rig, std::unique_ptr<record::Recorder> recorder, std::string file, std::uint64_t take) {
  const std::lock_guard lock(mutex_);
  Line& line = lines_.at(rig);
  line.view = {.is_recording = true, .file = file + ".part"};
  line.next_recorder = std::move(recorder);
  line.next_file = std::move(file);
  line.next_take = take;
  line.events.clear();
  line.safe_until_ns = clock_.now_ns();
}

void RecordThread::post(const std::string& rig, v1::Event event) {
  const std::lock_guard lock(mutex_);
  Line& line = lines_.at(rig);
  if (line.view.is_recording) line.events.push_back(std::move(event));
}

void RecordThread::mark_incomplete(const std::string& rig, std::string reason) {
  const std::lock_guard lock(mutex_);
  RecordingView& view = lines_.at(rig).view;
  if (view.is_recording) view.problem = std::move(reason);
}

std::vector<FinishedRecording> RecordThread::take_finished() {
  const std::lock_guard lock(mutex_);
  return std::exchange(finished_, {});
}

RecordingView RecordThread::view(const std::string& rig) {
  const std::lock_guard lock(mutex_);
  const Line& line = lines_.at(rig);
  RecordingView view = line.view;
  if (view.is_recording) view.lag_s = std::max(0.0, static_cast<double>(clock_.now_ns() - line.safe_until_ns) * 1e-9);
  return view;
}

void RecordThread::forget(const std::string& rig) {
  const std::lock_guard lock(mutex_);
  RecordingView& view = lines_.at(rig).view;
  if (!view.is_recording) view = {};
}

void RecordThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const std::int64_t turn_ns = clock_.now_ns();
    bool has_more = false;
    for (auto& [rig, line] : lines_) has_more |= serve(rig, line);
    watch_disk();
    if (!has_more) clock_.sleep_until_ns(turn_ns + kTurnNs);
  }
  for (auto& [rig, line] : lines_) serve_rest(rig, line);
}

/// Writes only what is in the tap now: a rig that still streams must not keep the daemon from ending.
void RecordThread::serve_rest(const std::string& rig, Line& line) {
  receive(rig, line);
  for (std::size_t read = 0; read <= line.tap->capacity() && drain(rig, line);) read += kItemsPerTurn;
  if (line.recorder) finish(rig, line, "the daemon stopped before the recording ended");
}

/// Receives a new recording and events from the control thread.
void RecordThread::receive(const std::string& rig, Line& line) {
  const auto events = take_orders(rig, line);
  if (std::exchange(line.is_new, false)) line.is_synced_aside = sync_.add(rig, line.file).has_value();
  for (const v1::Event& event : events) {
    if (!line.recorder) return;
    if (auto taken = line.recorder->take(event); !taken) finish(rig, line, core::to_string(taken.error()));
  }
}

std::vector<v1::Event> RecordThread::take_orders(const std::string& rig, Line& line) {
  const std::lock_guard lock(mutex_);
  if (line.next_recorder) {
    line.recorder = std::move(line.next_recorder);
    line.file = std::move(line.next_file);
    line.take = line.next_take;
    line.has_frames = false;
    line.lost_scans = 0;
    line.lost_events = 0;
    line.is_new = true;
    line.emptied_ns = line.written_ns = line.flushed_ns = line.synchronised_ns = line.on_disk_ns = clock_.now_ns();
  }
  if (line.recorder) {
    line.view.bytes = line.recorder->bytes();
    line.view.lost_scans = std::max(line.lost_scans, line.recorder->lost_scans());
    line.safe_until_ns = std::max(line.on_disk_ns, line.is_synced_aside ? sync_.done_ns(rig) : 0);
  }
  return std::exchange(line.events, {});
}

/// Returns true if there may be more items.
bool RecordThread::serve(const std::string& rig, Line& line) {
  receive(rig, line);
  const bool has_more = drain(rig, line);
  keep_up(rig, line);
  return has_more;
}

/// Returns true if there may be more items.
bool RecordThread::drain(const std::string& rig, Line& line) {
  line.tap->note_waiting(clock_.now_ns());
  for (std::size_t read = 0; read < kItemsPerTurn; ++read) {
    const auto item = line.tap->front();
    if (!item) {
      line.emptied_ns = clock_.now_ns();
      return false;
    }
    const bool is_end = item->frame == nullptr;
    if (is_end) line.tap->release();  // first: then the next take may be opened as soon as this recording is reported
    record(rig, line, *item);
    if (!is_end) line.tap->release();
  }
  return true;
}

void RecordThread::record(const std::string& rig, Line& line, const RecordTap::Item& item) {
  if (item.take != line.take || item.frame == nullptr) receive(rig, line);
  if (!line.recorder || item.take != line.take) return;  // its recording has failed: drop the item
  line.lost_scans = item.lost_scans;
  line.lost_events = item.lost_events;
  if (item.frame == nullptr) return finish(rig, line, "");
  if (!std::exchange(line.has_frames, true)) {
    if (item.lost_scans == 0) line.recorder->set_stage_state(line.tap->state());  // the state before the first frame of the take
  } else if (item.frame->segment != line.recorder->segment()) {
    note_unseen_loss(*line.recorder, line.lost_scans);  // scan indices restart here, so a later jump cannot show this loss
  }
  if (auto recorded = line.recorder->take(*item.frame, item.events); !recorded) finish(rig, line, core::to_string(recorded.error()));
}

void RecordThread::keep_up(const std::string& rig, Line& line) {
  if (!line.recorder) return;
  const std::int64_t now_ns = clock_.now_ns();
  core::Status kept;
  if (now_ns - line.flushed_ns >= kFlushNs) {
    line.flushed_ns = now_ns;
    kept = line.recorder->flush();
    line.written_ns = line.emptied_ns;
  }
  if (kept && now_ns - line.synchronised_ns >= kSynchroniseNs) {
    line.synchronised_ns = now_ns;
    kept = line.is_synced_aside ? sync_.request(rig, line.written_ns) : line.recorder->synchronise();
    if (kept && !line.is_synced_aside) line.on_disk_ns = line.written_ns;
    if (kept) kept = check_there(line.file + ".part");
  }
  if (!kept) finish(rig, line, core::to_string(kept.error()));
  if (kept && is_disk_full_) finish(rig, line, "the disk is nearly full");
}

void RecordThread::finish(const std::string& rig, Line& line, const std::string& incomplete) {
  sync_.remove(rig);
  const auto recorder = std::move(line.recorder);
  std::string reason = incomplete;
  note_unseen_loss(*recorder, line.lost_scans);
  const auto flushed = recorder->flush();
  if (reason.empty() && !flushed) reason = core::to_string(flushed.error());
  const std::uint64_t lost_scans = recorder->lost_scans();
  if (reason.empty() && lost_scans > 0) reason = std::to_string(lost_scans) + " scans were dropped: the queue to the recorder was full";
  if (reason.empty() && line.lost_events > 0)
    reason = std::to_string(line.lost_events) + " events were dropped: the queue to the recorder was full";
  if (reason.empty()) {
    const std::lock_guard lock(mutex_);
    reason = line.view.problem;
  }
  if (reason.empty() && recorder->scans() == 0) reason = "the device delivered no scan";
  FinishedRecording finished{.rig = rig,
                             .file = line.file + ".part",
                             .scans = recorder->scans(),
                             .duration_s = recorder->duration_s(),
                             .losses = recorder->losses()};
  const auto closed = close(*recorder, reason);
  if (closed) {
    finished.file = closed->file;
    finished.sha256 = closed->sha256;
    finished.bytes = closed->bytes;
    finished.is_closed = true;
  }
  finished.incomplete = reason;
  const std::lock_guard lock(mutex_);
  line.view = {.is_recording = false, .file = finished.file, .bytes = finished.bytes, .lost_scans = lost_scans, .problem = reason};
  finished_.push_back(std::move(finished));
  one_closed_.notify_all();
}

void RecordThread::wait_until_closed(std::chrono::milliseconds limit) {
  std::unique_lock lock(mutex_);
  one_closed_.wait_for(lock, limit,
                       [this] { return std::ranges::none_of(lines_, [](const auto& line) { return line.second.view.is_recording; }); });
}

void RecordThread::watch_disk() {
  const std::int64_t now_ns = clock_.now_ns();
  if (now_ns - looked_at_disk_ns_ < kLookAtDiskNs) return;
  looked_at_disk_ns_ = now_ns;
  const DiskView disk = look_at_disk(storage_, 0.0);
  is_disk_full_ = disk.state != DiskState::Unusable && static_cast<double>(disk.free_bytes) < storage_.stop_below_mib * 1024.0 * 1024.0;
}

}  // namespace dts::session
