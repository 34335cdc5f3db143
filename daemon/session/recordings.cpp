// SPDX-License-Identifier: Apache-2.0
#include "session/recordings.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "record/xdf/recovery.h"
#include "session/rig_pipeline.h"

namespace dts::session {
namespace {

constexpr double kScalarBytes = 8.0;

std::vector<record::RecordedStream> streams_of(const Rig& rig) { return recorded_streams(rig.config(), rig.device(), rig.formats()); }

double bytes_per_second(const Rig& rig) {
  double sum = 0.0;
  for (const record::RecordedStream& stream : streams_of(rig)) {
    const double bytes = stream.info.value_type == record::ValueType::Float32 ? kScalarBytes / 2.0 : kScalarBytes;
    sum += stream.info.rate->hz() * static_cast<double>(stream.info.channels.size()) * bytes;
  }
  return sum;
}

std::string file_of(const StorageConfig& config, const record::SessionFacts& facts) {
  const std::string part = facts.part > 1 ? "." + std::to_string(facts.part) : "";
  return sessions_directory(config) + "/" + facts.session_id + part + ".xdf";
}

/// A daemon that died between closing a file and saying so in the catalogue left a whole recording.
bool is_closed_already(record::PartRow& part) {
  const std::string closed = part.file.substr(0, part.file.rfind(".part"));
  if (std::filesystem::exists(part.file) || !std::filesystem::exists(closed)) return false;
  const auto verified = record::verify(closed);
  if (!verified || !verified->is_closed) return false;
  part.file = closed;
  part.sha256 = verified->sha256;
  part.bytes = verified->bytes;
  part.scans = verified->scans;
  part.duration_s = verified->duration_s;
  part.reason = verified->incomplete;
  part.state = verified->incomplete.empty() ? record::PartState::Complete : record::PartState::Incomplete;
  return true;
}

}  // namespace

core::Result<std::unique_ptr<Recordings>> Recordings::open(const StorageConfig& config, core::Clock& clock, core::Log log) {
  if (auto prepared = prepare_storage(config); !prepared) return tl::make_unexpected(prepared.error());
  auto catalogue = record::Catalogue::open(config.directory + "/catalogue.sqlite");
  if (!catalogue) return tl::make_unexpected(catalogue.error());
  std::unique_ptr<Recordings> recordings(new Recordings(config, clock, std::move(log), std::move(*catalogue)));
  if (auto entered = recordings->enter_interrupted(); !entered) return tl::make_unexpected(entered.error());
  return recordings;
}

/// What was being written when the last daemon ended, and what lies in the folder without being known.
core::Status Recordings::enter_interrupted() {
  auto unfinished = catalogue_->unfinished_parts();
  if (!unfinished) return tl::make_unexpected(unfinished.error());
  for (record::PartRow& part : *unfinished) {
    if (!is_closed_already(part)) {
      part.state = record::PartState::Interrupted;
      part.reason = "the daemon or the power ended while it was written";
    }
    if (auto updated = catalogue_->update_part(part); !updated) return updated;
    complain(catalogue_->end_session(part.session_id, "interrupted", "the daemon or the power ended", part.started_utc_ns));
  }
  const auto rebuilt = record::rebuild(*catalogue_, sessions_directory(config_));
  if (!rebuilt) return tl::make_unexpected(rebuilt.error());
  for (const std::string& problem : rebuilt->unreadable) log_.warning("recording not entered into the catalogue: " + problem);
  if (rebuilt->added > 0) log_.info(std::to_string(rebuilt->added) + " recordings entered into the catalogue");
  auto sessions = catalogue_->sessions({.limit = 10'000});
  if (!sessions) return tl::make_unexpected(sessions.error());
  for (const record::SessionRow& session : *sessions) {
    for (const record::PartRow& part : session.parts) {
      if (part.state == record::PartState::Interrupted) interrupted_.push_back(part);
    }
  }
  return {};
}

void Recordings::add(Rig& rig) {
  bytes_per_s_ += bytes_per_second(rig);
  thread_.add(rig.config().name, rig.tap());
}

void Recordings::start() {
  thread_.start();
  if (interrupted_.empty()) return;
  log_.warning(std::to_string(interrupted_.size()) + " interrupted recording(s) found; repaired copies are being made");
  recovery_thread_ = std::jthread([this](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread("recover", {}));  // asks for nothing that could be refused
    recover_all(stop);
  });
}

void Recordings::stop() noexcept {
  recovery_thread_.request_stop();
  if (recovery_thread_.joinable()) recovery_thread_.join();
  thread_.stop();
}

/// Thread: recovery. Hours of data take a while, and the daemon is to be up at once.
void Recordings::recover_all(const std::stop_token& stop) {
  for (record::PartRow part : interrupted_) {
    const std::string copy = record::recovered_name(part.file);
    auto recovered = record::recover(part.file, copy, [&](std::uint64_t, std::uint64_t) { return !stop.stop_requested(); });
    if (stop.stop_requested()) return;
    if (recovered) {
      part.state = record::PartState::Recovered;
      part.file = recovered->file;
      part.sha256 = recovered->sha256;
      part.bytes = recovered->kept_bytes;
      part.duration_s = recovered->duration_s;
      part.lost_s_at_most = recovered->lost_s_at_most;
      part.reason = recovered->reason;
    } else {
      part.reason = core::to_string(recovered.error());
    }
    const std::lock_guard lock(recovered_mutex_);
    recovered_.push_back(std::move(part));
  }
}

void Recordings::collect_recovered() {
  std::vector<record::PartRow> recovered;
  {
    const std::lock_guard lock(recovered_mutex_);
    recovered = std::exchange(recovered_, {});
  }
  for (const record::PartRow& part : recovered) {
    complain(catalogue_->update_part(part));
    const std::string which = "session " + part.session_id + " part " + std::to_string(part.part) + ": ";
    if (part.state == record::PartState::Recovered) {
      log_.info(which + "recovered in " + part.file);
    } else {
      log_.error(which + "not recovered: " + part.reason);
    }
  }
}

core::Status Recordings::begin(Rig& rig, record::SessionFacts facts) {
  const DiskView view = disk();
  if (view.state == DiskState::Full) return core::fail(core::ErrorCode::LimitExceeded, "no session can start: " + view.problem);
  if (view.state == DiskState::Unusable) return core::fail(core::ErrorCode::Failed, "no session can start: " + view.problem);
  if (view.state == DiskState::Low) log_.warning(view.problem);
  const std::string file = file_of(config_, facts);
  auto recorder = record::Recorder::create(file, facts, streams_of(rig));
  if (!recorder) return tl::make_unexpected(recorder.error());
  if (auto entered = catalogue_->begin_part(facts, file + ".part"); !entered) {
    static_cast<void>((*recorder)->close("the catalogue cannot be written"));  // nothing is in it; the error that counts is returned
    return entered;
  }
  if (!facts.calibration_id.empty()) complain(catalogue_->put_calibration(facts.calibration_id, facts.rig, "cop", facts.rig_definition));
  under_way_[facts.rig] = {
      .session_id = facts.session_id, .part = facts.part, .file = file + ".part", .started_utc_ns = facts.started_utc_ns};
  thread_.begin(facts.rig, std::move(*recorder), file, rig.tap().next_take());
  rig.tap().open();
  return {};
}

void Recordings::end(Rig& rig) { rig.tap().close(); }

std::uint32_t Recordings::part(const std::string& rig) const {
  const auto found = under_way_.find(rig);
  return found != under_way_.end() ? found->second.part : 0;
}

std::vector<FinishedRecording> Recordings::take_finished() {
  collect_recovered();
  std::vector<FinishedRecording> finished = thread_.take_finished();
  for (const FinishedRecording& recording : finished) enter(recording);
  return finished;
}

void Recordings::enter(const FinishedRecording& finished) {
  record::PartRow& part = under_way_[finished.rig];
  part.file = finished.file;
  part.sha256 = finished.sha256;
  part.bytes = finished.bytes;
  part.scans = finished.scans;
  part.duration_s = finished.duration_s;
  part.reason = finished.incomplete;
  part.state = finished.incomplete.empty() ? record::PartState::Complete : record::PartState::Incomplete;
  if (!finished.is_closed) part.state = record::PartState::Interrupted;  // the next start makes a repaired copy
  complain(catalogue_->update_part(part));
  if (!finished.incomplete.empty()) log_.error("recording " + finished.file + " is incomplete: " + finished.incomplete);
}

/// The file is the truth and stays; that the catalogue does not know is mended at the next start.
void Recordings::complain(const core::Status& status) {
  if (!status) log_.error("catalogue: " + core::to_string(status.error()));
}

}  // namespace dts::session
