// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/ingest.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "fleet/hub/durable_file.h"
#include "fleet/wire/messages.h"

namespace dts::fleet::hub {
namespace {

constexpr std::uint32_t kDatabaseWaitS = 5;
constexpr std::uint32_t kStoreWaitS = 5;
constexpr std::uint32_t kFullWaitS = 300;
constexpr std::uint32_t kFailedWaitS = 60;
constexpr std::uint32_t kShareWaitS = 2;
constexpr std::int64_t kDayNs = 24LL * 3600 * core::kNanosecondsPerSecond;
constexpr std::size_t kMostUploads = 64;  // of a clinic
constexpr const char* kDatabaseAway = "the catalogue of the centre does not answer";
constexpr const char* kDiskFull = "the disk of the centre is full";
constexpr std::uint32_t kUnknownWaitS = 1;
constexpr const char* kUnknown = "the hub does not know this file: offer it again";  // for example after its staging was removed
constexpr const char* kDiskFailed = "the disk of the centre failed";
constexpr const char* kStoreAway = "the store of the centre does not answer";

v1::UploadAnswer upload_refusal(const std::string& reason) {
  v1::UploadAnswer answer;
  answer.mutable_refusal()->set_reason(reason);
  return answer;
}

v1::UploadAnswer stored(v1::Receipt receipt) {
  v1::UploadAnswer answer;
  *answer.mutable_stored() = std::move(receipt);
  return answer;
}

std::string described(const RecordingName& name) { return "recording " + wire::hex_of(name.sha256) + " of " + name.clinic; }

}  // namespace

core::Result<std::unique_ptr<Ingest>> Ingest::create(IngestOptions options, std::unique_ptr<Staging> staging, Store& store,
                                                     const core::Clock& clock, const core::Log& log) {
  std::unique_ptr<Ingest> ingest(new Ingest(std::move(options), std::move(staging), store, clock, log));
  DTS_TRY_ASSIGN(auto found, ingest->staging_->load());
  bool is_store_away = false;
  for (auto& upload : found) DTS_TRY(ingest->adopt(std::move(upload), is_store_away));
  return ingest;
}

core::Status Ingest::adopt(Staging::Upload found, bool& is_store_away) {
  Upload upload{.offer = std::move(found.offer), .have = found.have, .changed_utc_ns = found.changed_utc_ns};
  if (upload.have == 0) {
    // If the store does not answer now, the offer is repeated: the next one looks again. Each question may take long.
    if (is_store_away) return {};
    const auto is_stored = store_.has(found.name);
    is_store_away = !is_stored && is_stored.error().code == core::ErrorCode::Unreachable;
    if (is_store_away) return {};
    DTS_TRY(is_stored);
    upload.is_in_store = *is_stored;
    if (*is_stored) upload.have = upload.offer.bytes();
  }
  uploads_.emplace(std::move(found.name), std::move(upload));
  return {};
}

v1::UploadAnswer Ingest::upload_answer(std::uint64_t have) const {
  v1::UploadAnswer answer;
  answer.mutable_upload()->set_worker(options_.hub);
  answer.mutable_upload()->set_have(have);
  return answer;
}

v1::UploadAnswer Ingest::later(const std::string& reason, std::uint32_t wait_s) {
  {
    const std::lock_guard lock(mutex_);
    ++counts_.later_total;
  }
  v1::UploadAnswer answer;
  answer.mutable_later()->set_reason(reason);
  answer.mutable_later()->set_wait_s(wait_s);
  return answer;
}

v1::UploadAnswer Ingest::store_failed(const core::Error& error) {
  log_.error(core::to_string(error));
  return error.code == core::ErrorCode::Unreachable ? later(kStoreAway, kStoreWaitS) : later(kDiskFailed, kFullWaitS);
}

std::uint64_t Ingest::offered_bytes(const std::string& clinic) const {
  std::uint64_t bytes = 0;
  for (auto upload = uploads_.lower_bound({.clinic = clinic, .sha256 = ""}); upload != uploads_.end() && upload->first.clinic == clinic;
       ++upload) {
    bytes += upload->second.offer.bytes();
  }
  return bytes;
}

bool Ingest::is_day_spent(const std::string& clinic, std::uint64_t bytes) {
  Day& day = days_[clinic];
  const std::int64_t today = utc_ns() / kDayNs;
  if (day.number != today) day = {.number = today, .bytes = 0};
  if (day.bytes + bytes > options_.bytes_a_day) return true;
  day.bytes += bytes;
  return false;
}

v1::UploadAnswer Ingest::open(const std::string& clinic, const v1::UploadOffer& offer, Catalogue& catalogue) {
  const RecordingName name{.clinic = clinic, .sha256 = offer.sha256()};
  auto receipt = catalogue.find_receipt(name);
  if (!receipt) return later(kDatabaseAway, kDatabaseWaitS);
  if (*receipt) {
    finish(name);
    return stored(**std::move(receipt));
  }
  const auto is_gone = catalogue.is_erased(clinic, offer.session_id());
  if (!is_gone) return later(kDatabaseAway, kDatabaseWaitS);
  if (*is_gone) return upload_refusal("this session was erased");
  const auto room = catalogue.check_room_for_recording(clinic);
  if (!room && room.error().code == core::ErrorCode::WrongState) return upload_refusal(room.error().what);
  if (!room) return later(kDatabaseAway, kDatabaseWaitS);
  if (offer.bytes() > options_.staged_bytes) return upload_refusal("the centre does not accept files of this size");
  return begin(name, offer);
}

v1::UploadAnswer Ingest::begin(const RecordingName& name, const v1::UploadOffer& offer) {
  const auto kept = store_.has(name);
  if (!kept) return store_failed(kept.error());
  if (!*kept && is_full()) return later(kDiskFull, kFullWaitS);
  std::unique_lock lock(mutex_);
  const auto known = uploads_.find(name);
  if (known != uploads_.end() && (known->second.is_committing || known->second.offer.SerializeAsString() == offer.SerializeAsString())) {
    return upload_answer(known->second.have);
  }
  std::uint64_t have = known == uploads_.end() ? 0 : known->second.have;
  const std::uint64_t offered_before = known == uploads_.end() ? 0 : known->second.offer.bytes();
  if (known == uploads_.end() || offer.bytes() > offered_before) {
    const auto first = uploads_.lower_bound({.clinic = name.clinic, .sha256 = ""});
    const bool is_many = known == uploads_.end() && std::count_if(first, uploads_.end(), [&](const auto& one) {
                                                      return one.first.clinic == name.clinic;
                                                    }) >= static_cast<std::ptrdiff_t>(kMostUploads);
    if (is_many || offered_bytes(name.clinic) - offered_before + offer.bytes() > options_.staged_bytes) {
      lock.unlock();
      return later("this clinic has too many files that are not whole; the centre removes them 7 days after their last change", kFullWaitS);
    }
  }
  if (*kept) have = offer.bytes();
  if (have > offer.bytes()) {
    have = 0;
    if (const auto emptied = staging_->restart(name); !emptied) log_.error(core::to_string(emptied.error()));
  }
  if (const auto begun = staging_->begin(name, offer); !begun) {
    lock.unlock();
    log_.error(core::to_string(begun.error()));
    return later(kDiskFailed, kFullWaitS);
  }
  uploads_[name] = {.offer = offer, .have = have, .changed_utc_ns = utc_ns(), .is_in_store = *kept};
  return upload_answer(have);
}

v1::UploadAnswer Ingest::take(const std::string& clinic, const v1::UploadChunk& chunk) {
  const RecordingName name{.clinic = clinic, .sha256 = chunk.sha256()};
  if (is_full()) return later(kDiskFull, kFullWaitS);
  std::unique_lock lock(mutex_);
  const auto found = uploads_.find(name);
  if (found == uploads_.end()) {
    lock.unlock();
    return later(kUnknown, kUnknownWaitS);
  }
  Upload& upload = found->second;
  if (upload.is_committing || upload.is_in_store || chunk.offset() != upload.have) return upload_answer(upload.have);
  if (chunk.data().size() > upload.offer.bytes() - upload.have) return upload_refusal("the file is longer than its offer");
  if (is_day_spent(clinic, chunk.data().size())) {
    lock.unlock();
    return later("this clinic has sent as much as the centre accepts in a day", kFullWaitS);
  }
  if (const auto written = staging_->write(name, upload.have, chunk.data()); !written) {
    lock.unlock();
    log_.error(core::to_string(written.error()));
    return later(kDiskFailed, kFullWaitS);
  }
  upload.have += chunk.data().size();
  upload.changed_utc_ns = utc_ns();
  counts_.bytes_total += chunk.data().size();
  return upload_answer(upload.have);
}

v1::UploadAnswer Ingest::commit(const std::string& clinic, const v1::UploadCommit& commit, Catalogue& catalogue,
                                const std::stop_token& stop) {
  const RecordingName name{.clinic = clinic, .sha256 = commit.sha256()};
  auto receipt = catalogue.find_receipt(name);
  if (!receipt) return later(kDatabaseAway, kDatabaseWaitS);
  if (*receipt) {  // the answer was lost, or another hub was faster
    finish(name);
    return stored(**std::move(receipt));
  }
  Upload upload;
  {
    std::unique_lock lock(mutex_);
    const auto found = uploads_.find(name);
    if (found == uploads_.end()) {
      lock.unlock();
      return later(kUnknown, kUnknownWaitS);
    }
    if (found->second.have < found->second.offer.bytes()) return upload_answer(found->second.have);
    const Share& share = shares_[clinic];
    const bool has_failures = !share.failures.has_one(steady_time());
    if (has_failures || !share.seconds.has_one(steady_time())) {
      lock.unlock();
      return has_failures ? later("too many files of this clinic were not what was offered", kFailedWaitS)
                          : later("the centre now stores files of other clinics", kShareWaitS);
    }
    found->second.is_committing = true;
    upload = found->second;
  }
  const std::int64_t begun_ns = clock_.now_ns();
  auto answer = commit_whole(name, upload, catalogue, stop);
  const std::lock_guard lock(mutex_);
  shares_[clinic].seconds.spend(steady_time(), static_cast<double>(clock_.now_ns() - begun_ns) * 1e-9);
  if (const auto found = uploads_.find(name); found != uploads_.end()) found->second.is_committing = false;
  return answer;
}

/// Returns whether the file is what was offered. An error says nothing about the file in the store: the disk may be full, or its copy lost.
core::Result<bool> Ingest::verify(const RecordingName& name, const Upload& upload, const std::stop_token& stop) {
  std::string file = staging_->file(name);
  std::optional<LocalFile> kept;
  if (upload.is_in_store) {
    DTS_TRY_ASSIGN(auto found, store_.file(name));
    if (!found) return false;
    file = kept.emplace(*std::move(found)).path();
    // An earlier hub may have ended after it had moved the file, before it synchronised the folder.
    DTS_TRY(synchronise(std::filesystem::path(file).parent_path().string()));
  }
  DTS_TRY(synchronise(file));
  options_.reached("synchronised");
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) return core::fail(core::ErrorCode::Failed, "cannot read '" + file + "': " + error.message(), "check the disk");
  if (bytes != upload.offer.bytes()) return false;
  DTS_TRY_ASSIGN(const std::string sum, sha256_from_disk(file, stop));
  return sum == name.sha256;
}

v1::UploadAnswer Ingest::commit_whole(const RecordingName& name, const Upload& upload, Catalogue& catalogue, const std::stop_token& stop) {
  const auto is_sound = verify(name, upload, stop);
  if (!is_sound && is_sound.error().code == core::ErrorCode::Timeout) return later("the hub ends", 1);
  if (!is_sound && upload.is_in_store) return store_failed(is_sound.error());  // the next commit verifies it again
  if (!is_sound || !*is_sound) {
    log_.warning(described(name) +
                 (is_sound ? ": the SHA-256 differs, the clinic sends it again" : ": " + core::to_string(is_sound.error())));
    if (is_sound) {
      const std::lock_guard lock(mutex_);
      shares_[name.clinic].failures.spend(steady_time(), 1.0);
    }
    start_again(name, upload.is_in_store, catalogue);
    return is_sound ? upload_answer(0) : later(kDiskFailed, kDatabaseWaitS);
  }
  options_.reached("verified");
  if (!upload.is_in_store) {
    if (const auto put = store_.put(name, staging_->file(name)); !put) {
      if (put.error().code == core::ErrorCode::Unreachable) return store_failed(put.error());
      log_.error(core::to_string(put.error()));
      start_again(name, false, catalogue);
      return later(kDiskFailed, kDatabaseWaitS);
    }
    const std::lock_guard lock(mutex_);
    if (const auto found = uploads_.find(name); found != uploads_.end()) found->second.is_in_store = true;
  }
  options_.reached("stored");
  auto receipt = catalogue.put_recording(name, upload.offer, store_, options_.hub, utc_ns());
  if (!receipt && receipt.error().code == core::ErrorCode::DataDamaged) {
    start_again(name, true, catalogue);
    return upload_answer(0);
  }
  if (!receipt && (receipt.error().code == core::ErrorCode::NotFound || receipt.error().code == core::ErrorCode::WrongState)) {
    if (const auto removed = catalogue.remove_recording(name, store_); !removed) log_.error(core::to_string(removed.error()));
    finish(name);
    return upload_refusal(receipt.error().code == core::ErrorCode::NotFound ? "this session was erased"
                                                                            : "this recording is known as part of another session");
  }
  if (!receipt) {
    log_.warning(described(name) + ": " + core::to_string(receipt.error()));
    return later(kDatabaseAway, kDatabaseWaitS);
  }
  options_.reached("entered");
  finish(name);
  const std::lock_guard lock(mutex_);
  ++counts_.receipts_total;
  return stored(*std::move(receipt));
}

/// The file is not what was offered: the clinic sends it again.
void Ingest::start_again(const RecordingName& name, bool is_in_store, Catalogue& catalogue) {
  if (is_in_store) {
    if (const auto removed = catalogue.remove_recording(name, store_); !removed) {
      log_.error(core::to_string(removed.error()));
      return;  // the next commit finds it again
    }
  }
  const std::lock_guard lock(mutex_);
  ++counts_.torn_total;
  if (const auto emptied = staging_->restart(name); !emptied) log_.error(core::to_string(emptied.error()));
  if (const auto found = uploads_.find(name); found != uploads_.end()) {
    found->second.have = 0;
    found->second.is_in_store = false;
  }
}

void Ingest::finish(const RecordingName& name) {
  const std::lock_guard lock(mutex_);
  const auto found = uploads_.find(name);
  if (found == uploads_.end()) return;
  uploads_.erase(found);
  staging_->remove(name);
}

core::Status Ingest::drop(const std::function<bool(const RecordingName&, const Upload&)>& is_chosen, Catalogue& catalogue) {
  std::map<RecordingName, bool> chosen;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, upload] : uploads_) {
      if (!upload.is_committing && is_chosen(name, upload)) chosen.emplace(name, upload.is_in_store);
    }
  }
  for (const auto& [name, is_in_store] : chosen) {
    if (is_in_store) {  // without a row; it stays if a receipt was entered meanwhile
      const auto removed = catalogue.remove_recording(name, store_);
      if (!removed && removed.error().code != core::ErrorCode::WrongState) return tl::make_unexpected(removed.error());
    }
    const std::lock_guard lock(mutex_);
    const auto found = uploads_.find(name);
    if (found == uploads_.end() || found->second.is_committing || found->second.is_in_store != is_in_store) continue;
    uploads_.erase(found);
    staging_->remove(name);
  }
  return {};
}

core::Status Ingest::drop_session(const SessionName& session, Catalogue& catalogue) {
  return drop([&](const RecordingName& name,
                  const Upload& upload) { return name.clinic == session.clinic && upload.offer.session_id() == session.id; },
              catalogue);
}

core::Status Ingest::clean(Catalogue& catalogue) {
  std::set<SessionName> sessions;
  std::vector<RecordingName> names;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, upload] : uploads_) {
      sessions.insert({.clinic = name.clinic, .id = upload.offer.session_id()});
      if (!upload.is_committing) names.push_back(name);
    }
  }
  for (const SessionName& session : sessions) {
    DTS_TRY_ASSIGN(const bool is_gone, catalogue.is_erased(session.clinic, session.id));
    if (is_gone) DTS_TRY(drop_session(session, catalogue));
  }
  for (const RecordingName& name : names) {
    DTS_TRY_ASSIGN(const auto receipt, catalogue.find_receipt(name));
    if (receipt) finish(name);
  }
  const std::int64_t now = utc_ns();
  return drop([&](const RecordingName& /*name*/, const Upload& upload) { return now - upload.changed_utc_ns > kAbandonedNs; }, catalogue);
}

IngestCounts Ingest::counts() const {
  const std::lock_guard lock(mutex_);
  IngestCounts counts = counts_;
  counts.uploads = uploads_.size();
  for (const auto& [name, upload] : uploads_) counts.staged_bytes += upload.have;
  return counts;
}

}  // namespace dts::fleet::hub
