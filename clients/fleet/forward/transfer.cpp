// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/transfer.h"

#include <sodium.h>

#include <algorithm>
#include <utility>

#include "core/split_mix.h"
#include "fleet/wire/messages.h"

namespace dts::fleet::forward {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kShortestPause{1000};
constexpr milliseconds kLongestPause{5 * 60 * 1000};
constexpr int kMostDoublings = 9;
constexpr milliseconds kLongestSilence{5000};
constexpr std::uint64_t kCommittedBytesPerMs = 20'000;  // the hub synchronises the file and reads it again
constexpr std::size_t kLargestWindow = 16;
constexpr int kMostDamagedCommits = 2;
constexpr std::size_t kSmallestChunk = 16 * 1024;

}  // namespace

std::chrono::milliseconds Backoff::next() noexcept {
  const milliseconds whole = std::min(kShortestPause * (1 << std::min(failures_, kMostDoublings)), kLongestPause);
  ++failures_;
  state_ = core::split_mix(state_);
  return whole - milliseconds(static_cast<std::int64_t>(state_ % static_cast<std::uint64_t>(whole.count() / 2 + 1)));
}

std::uint64_t random_seed() { return (static_cast<std::uint64_t>(randombytes_random()) << 32U) | randombytes_random(); }

Transfer::Transfer(std::string clinic, std::string sha256, std::uint64_t bytes, std::uint64_t seed)
    : clinic_(std::move(clinic)), sha256_(std::move(sha256)), bytes_(bytes), backoff_(seed), chunk_(wire::kLargestChunk) {}

Transfer::Step Transfer::next(Time now, bool is_chunk_allowed) {
  const bool is_due = now >= deadline_;
  if (state_ == State::Waiting && is_due) state_ = State::Open;
  const bool expects_answer = state_ == State::Opening || state_ == State::Committing || (state_ == State::Sending && next_ > have_);
  if (expects_answer && is_due) {
    if (state_ == State::Sending) chunk_ = std::max(chunk_ / 2, kSmallestChunk);
    window_ = 1;
    wait(backoff_.next(), "the centre does not answer", now);
  }
  const auto sent = [this, now](Step step, milliseconds silence) {
    deadline_ = now + silence;
    return step;
  };
  switch (state_) {
    case State::Open:
      state_ = State::Opening;
      sent_.clear();
      ++tries_;
      return sent({.kind = Step::Kind::Open}, kLongestSilence);
    case State::Sending:
      if (is_chunk_allowed && next_ < bytes_ && next_ - have_ < window_ * chunk_) {
        const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(chunk_, bytes_ - next_));
        Step step{.kind = Step::Kind::Chunk, .worker = worker_, .offset = next_, .count = count};
        if (next_ == have_) deadline_ = now + kLongestSilence;  // nothing was under way
        next_ += count;
        sent_.push_back({.end = next_});
        return step;
      }
      if (have_ == bytes_) {
        state_ = State::Committing;
        return sent({.kind = Step::Kind::Commit, .worker = worker_}, kLongestSilence + milliseconds(bytes_ / kCommittedBytesPerMs));
      }
      break;
    case State::Ended: return {.kind = Step::Kind::Ended};
    case State::Opening:
    case State::Committing:
    case State::Waiting: break;
  }
  return {.kind = Step::Kind::Wait, .until = deadline_};
}

void Transfer::handle(const v1::UploadAnswer& answer, Time now) {
  if (state_ == State::Ended) return;
  switch (answer.answer_case()) {
    case v1::UploadAnswer::kStored: return handle_receipt(answer.stored(), now);
    case v1::UploadAnswer::kUpload: return handle_upload(answer.upload(), now);
    case v1::UploadAnswer::kLater:
      return wait(std::chrono::seconds(std::clamp(answer.later().wait_s(), 1U, 300U)),
                  "the centre cannot take it now: " + answer.later().reason(), now);
    case v1::UploadAnswer::kRefusal:
      state_ = State::Ended;
      end_ = End{.refusal = answer.refusal().reason().empty() ? "the centre rejected it" : answer.refusal().reason()};
      return;
    case v1::UploadAnswer::ANSWER_NOT_SET: return;
  }
}

void Transfer::handle_receipt(const v1::Receipt& receipt, Time now) {
  if (receipt.sha256() != sha256_ || receipt.bytes() != bytes_ || receipt.clinic() != clinic_) {
    return wait(backoff_.next(), "the centre has sent a receipt for something else", now);
  }
  have_ = bytes_;
  state_ = State::Ended;
  end_ = End{.receipt = receipt};
}

void Transfer::handle_upload(const v1::Upload& upload, Time now) {
  const std::uint64_t have = upload.have();
  if (have > bytes_) return wait(backoff_.next(), "the centre has more bytes than the recording", now);
  switch (state_) {
    case State::Opening:
      worker_ = upload.worker();
      go_back(have);
      state_ = State::Sending;
      deadline_ = now + kLongestSilence;
      problem_.clear();
      return;
    case State::Committing:  // the bytes at the centre were not those of the recording, or are gone
      if (have == bytes_) return;
      if (++damaged_commits_ < kMostDamagedCommits) return wait(backoff_.next(), "the centre has to receive the recording again", now);
      state_ = State::Ended;
      end_ = End{.is_damaged = true};
      return;
    case State::Sending: {
      if (upload.worker() != worker_) return;  // a late answer of another one
      const Sent chunk = sent_.empty() ? Sent() : sent_.front();
      if (!sent_.empty()) sent_.pop_front();
      if (have > have_) {
        have_ = have;
        next_ = std::max(next_, have_);
        window_ = std::min(window_ + 1, kLargestWindow);
        chunk_ = std::min(chunk_ * 2, wire::kLargestChunk);
        deadline_ = now + kLongestSilence;
        backoff_.reset();
      } else if (have < have_ || (have < chunk.end && !chunk.was_overtaken)) {  // the hub lost what it had, or one before was lost
        go_back(have);
      }
      return;
    }
    case State::Open:
    case State::Waiting:
    case State::Ended: return;
  }
}

void Transfer::go_back(std::uint64_t have) noexcept {
  have_ = have;
  next_ = have;
  for (Sent& chunk : sent_) chunk.was_overtaken = true;
}

void Transfer::wait(milliseconds pause, std::string problem, Time now) {
  state_ = State::Waiting;
  deadline_ = now + pause;
  problem_ = std::move(problem);
}

void Transfer::retry() noexcept {
  if (state_ == State::Waiting) restart();
}

void Transfer::restart() noexcept {
  if (state_ == State::Ended) return;
  state_ = State::Open;
  backoff_.reset();
}

}  // namespace dts::fleet::forward
