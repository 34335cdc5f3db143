// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/uploader.h"

#include <algorithm>
#include <ctime>
#include <memory>
#include <utility>

#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::forward {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kUploadTurn{50};  // longest wait for an answer before the limits and the end are looked at
constexpr std::int64_t kReadAgainNs = 600 * core::kNanosecondsPerSecond;
constexpr std::chrono::seconds kMeasure{3};
constexpr std::chrono::milliseconds kBurst{100};

std::chrono::minutes time_of_day(std::int64_t utc_ns) {
  const std::time_t seconds = utc_ns / core::kNanosecondsPerSecond;
  std::tm local{};
  ::localtime_r(&seconds, &local);
  return std::chrono::hours(local.tm_hour) + std::chrono::minutes(local.tm_min);
}

std::string named(const FileRow& file) { return "part " + std::to_string(file.part) + " of session " + file.session; }

}  // namespace

void Pace::add(std::size_t count, std::optional<double> rate, Time now) noexcept {
  if (!rate) return;
  const auto needed = std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(static_cast<double>(count) / *rate));
  free_at_ = std::max(free_at_, now - kBurst) + needed;
}

Uploader::Uploader(UploaderOptions options, Uplink& uplink, Store& store, core::Clock& clock, core::Log log)
    : options_(std::move(options)), uplink_(uplink), store_(store), clock_(clock), log_(std::move(log)) {}

std::optional<double> Uploader::rate() const noexcept {
  const bool is_low = is_session_running_.load(std::memory_order_relaxed) && options_.limits.rate_in_session;
  return is_low ? options_.limits.rate_in_session : options_.limits.rate;
}

bool Uploader::is_time() const { return !options_.limits.hours || options_.limits.hours->contains(time_of_day(utc_ns())); }

UploadProgress Uploader::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

void Uploader::set_problem(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  progress_ = {.bytes_per_s = progress_.bytes_per_s, .problem = problem};
}

void Uploader::show(const FileRow& file, const Transfer& transfer) {
  const auto now = steady_clock::now();
  const std::lock_guard lock(mutex_);
  if (progress_.session != file.session || progress_.part != file.part || transfer.have() < measured_have_) {
    measured_at_ = now;
    measured_have_ = transfer.have();
  } else if (now - measured_at_ >= kMeasure) {
    progress_.bytes_per_s =
        static_cast<double>(transfer.have() - measured_have_) / std::chrono::duration<double>(now - measured_at_).count();
    measured_at_ = now;
    measured_have_ = transfer.have();
  }
  progress_ = {.session = file.session,
               .part = file.part,
               .bytes = file.bytes,
               .have = transfer.have(),
               .bytes_per_s = progress_.bytes_per_s,
               .problem = transfer.problem()};
}

void Uploader::complain(const core::Status& status) {
  if (!status) log_.error(core::to_string(status.error()));
}

void Uploader::put_off(const FileRow& file, const std::string& why_not) {
  log_.warning(named(file) + " is not sent now, but in 10 min: " + why_not);
  complain(store_.postpone(file, utc_ns() + kReadAgainNs, why_not));
}

bool Uploader::work(const std::stop_token& stop) {
  const auto file = store_.next_file(utc_ns());
  if (!file) complain(tl::make_unexpected(file.error()));
  if (!file || !*file) {
    set_problem({});
    return false;
  }
  const FileRow& next = **file;
  if (next.sent_sha256.empty()) {
    read(next, stop);
    return true;
  }
  const bool is_connected = uplink_.is_connected();
  if (is_connected && next.is_session_sent && is_time()) {
    send(next, stop);
    return true;
  }
  if (!is_connected) {
    set_problem("no connection to the centre: " + uplink_.problem());
  } else {
    set_problem(next.is_session_sent ? "it is outside the hours of only_between" : "the facts of the session come first");
  }
  return false;
}

/// Compares the file with dtsd's checksum, and computes that of the bytes that leave.
void Uploader::read(const FileRow& file, const std::stop_token& stop) {
  const auto hashes = hashes_of(file.file, options_.rules, stop);
  if (stop.stop_requested()) return;
  if (!hashes) {
    // A file that dtsd does not write so is held; one that cannot be read now, for example on a disk that is away, is read again.
    if (hashes.error().code != core::ErrorCode::DataDamaged) return put_off(file, hashes.error().what);
    log_.error(named(file) + " cannot be sent: " + core::to_string(hashes.error()));
    return complain(store_.hold(file, hashes.error().what));
  }
  if (wire::hex_of(hashes->recorded_sha256) != file.recorded_sha256) {
    const std::string why_not = file.file + " is not what dtsd has recorded: its SHA-256 differs";
    log_.error(named(file) + " is not sent: " + why_not + ". Restore the file from a backup, then restart dts-forward");
    return complain(store_.hold(file, why_not));
  }
  complain(store_.set_sent_sha256(file, *hashes, utc_ns()));
}

core::Status Uploader::do_step(const Transfer::Step& step, const FileRow& file, SentBytes& bytes, const std::string& reply) {
  DTS_TRY_ASSIGN(const std::string sha256, wire::bytes_of_hex(file.sent_sha256));
  link::Letter letter{.subject = {}, .reply = reply};
  wire::Subject subject{.clinic = options_.clinic, .matter = wire::Matter::Open, .worker = step.worker};
  switch (step.kind) {
    case Transfer::Step::Kind::Open: {
      v1::UploadOffer offer;
      offer.set_sha256(sha256);
      offer.set_bytes(file.bytes);
      offer.set_session_id(file.session);
      offer.set_part(file.part);
      letter.data = offer.SerializeAsString();
      break;
    }
    case Transfer::Step::Kind::Chunk: {
      v1::UploadChunk chunk;
      DTS_TRY_ASSIGN(*chunk.mutable_data(), bytes.read(step.offset, step.count));
      if (chunk.data().size() != step.count) return core::fail(core::ErrorCode::Failed, file.file + " has become shorter");
      chunk.set_sha256(sha256);
      chunk.set_offset(step.offset);
      subject.matter = wire::Matter::Chunk;
      pace_.add(step.count, rate(), steady_clock::now());
      letter.data = chunk.SerializeAsString();
      break;
    }
    case Transfer::Step::Kind::Commit: {
      v1::UploadCommit commit;
      commit.set_sha256(sha256);
      subject.matter = wire::Matter::Commit;
      letter.data = commit.SerializeAsString();
      break;
    }
    case Transfer::Step::Kind::Wait:
    case Transfer::Step::Kind::Ended: return {};
  }
  letter.subject = wire::to_text(subject);
  (void)uplink_.publish(letter);  // what is lost is sent again: there is no answer to it
  return {};
}

void Uploader::send(const FileRow& file, const std::stop_token& stop) {
  auto bytes = SentBytes::open(file.file, options_.rules);
  if (!bytes) return put_off(file, bytes.error().what);
  if (bytes->size() != file.bytes) return put_off(file, file.file + " has another size than before");
  std::unique_ptr<Mailbox> mailbox;
  const auto sha256 = wire::bytes_of_hex(file.sent_sha256);
  if (!sha256) return complain(store_.hold(file, sha256.error().what));
  Transfer transfer(options_.clinic, *sha256, file.bytes, random_seed());
  std::uint64_t connections = uplink_.connections();
  is_retry_due_.store(false, std::memory_order_relaxed);
  auto looked_at = steady_clock::now();
  while (!stop.stop_requested() && !transfer.end() && is_time()) {
    const auto now = steady_clock::now();
    const std::uint64_t counted = uplink_.connections();
    if (is_retry_due_.exchange(false, std::memory_order_relaxed)) transfer.retry();
    if (std::exchange(connections, counted) != counted) transfer.restart();
    if (now - looked_at > std::chrono::seconds(1)) {
      looked_at = now;
      if (const auto wanted = store_.is_wanted(file); wanted && !*wanted) break;
      show(file, transfer);
    }
    const bool is_free = pace_.is_free(now) && uplink_.has_room();
    const Transfer::Step step = transfer.next(now, is_free);
    if (step.kind == Transfer::Step::Kind::Open) {  // late answers to the old address are not seen
      auto opened = uplink_.open_mailbox();
      if (!opened) return set_problem(opened.error().what);
      mailbox = std::move(*opened);
    }
    if (auto done = do_step(step, file, *bytes, mailbox->address()); !done) {
      put_off(file, done.error().what);
      break;
    }
    const bool is_busy = step.kind == Transfer::Step::Kind::Chunk;
    auto letter = mailbox->next(is_busy ? milliseconds(0) : kUploadTurn);
    for (; letter; letter = mailbox->next(milliseconds(0))) {
      if (letter->has_no_listener) continue;  // nobody listens: the silence decides
      if (const auto answer = wire::decode_upload_answer(letter->data)) transfer.handle(*answer, steady_clock::now());
      if (!is_busy) break;
    }
    show(file, transfer);
  }
  finish(file, transfer, stop);
}

void Uploader::finish(const FileRow& file, const Transfer& transfer, const std::stop_token& stop) {
  complain(store_.add_tries(file, transfer.tries()));
  set_problem({});
  if (!transfer.end()) return;
  if (transfer.end()->is_damaged) {
    read(file, stop);  // holds the file if it has changed
    if (const auto wanted = store_.is_wanted(file); wanted && !*wanted) return;
    return put_off(file, "what arrived at the centre was not what was sent");
  }
  if (!transfer.end()->receipt) {
    log_.error("the centre rejected " + named(file) + ": " + transfer.end()->refusal);
    return complain(store_.hold(file, "the centre rejected it: " + transfer.end()->refusal));
  }
  log_.info("the centre has " + named(file) + ", " + std::to_string(file.bytes) + " bytes");
  complain(store_.set_stored(file, *transfer.end()->receipt));
}

}  // namespace dts::fleet::forward
