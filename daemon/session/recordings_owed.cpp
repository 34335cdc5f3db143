// SPDX-License-Identifier: Apache-2.0
// Entries that the catalogue rejected: kept, and retried later.
#include <utility>

#include "session/recordings.h"

namespace dts::session {
namespace {

constexpr std::size_t kMostOwed = 1000;
constexpr int kCallsToRetry = 20;  // about a second

}  // namespace

/// Makes an entry, or keeps it for a retry: a full disk makes the catalogue fail too, and it must be complete once there is room again.
/// Keeps the order, because a later entry may depend on an earlier one.
void Recordings::enter_or_owe(std::function<core::Status()> entry) {
  core::Status entered;
  if (owed_.empty()) entered = entry();
  if (!entered && !is_written_again(entered.error())) complain(entered);
  if (entered && owed_.empty()) return;
  if (owed_.size() == kMostOwed) owed_.pop_front();
  owed_.push_back(std::move(entry));
}

/// Returns whether the catalogue is only busy, because an erasure writes it again: a retry in some seconds succeeds.
bool Recordings::is_written_again(const core::Error& error) const {
  return error.code == core::ErrorCode::Timeout && erasing_thread_.joinable();
}

tl::unexpected<core::Error> Recordings::written_again() {
  return core::fail(core::ErrorCode::WrongState, "dtsd is writing its catalogue again, because a subject was erased",
                    "try again in some seconds");
}

/// Replaces the error of a busy catalogue by one that says what to do.
core::Status Recordings::explained(core::Status status) const {
  if (status || !is_written_again(status.error())) return status;
  return written_again();
}

void Recordings::enter_owed() {
  const bool is_owed = !owed_.empty() || !audit_problem_.empty();
  if (!is_owed || --calls_to_retry_ > 0) return;
  enter_owed_now();
}

void Recordings::enter_owed_now() {
  calls_to_retry_ = kCallsToRetry;
  enter_owed_audit();
  while (!owed_.empty() && owed_.front()()) owed_.pop_front();
  if (owed_.empty()) owed_ends_.clear();
}

/// Fails only if the entry is missing in the trail. A failed copy to the second trail (full disk) must not enter it twice.
core::Status Recordings::append_audit(const record::AuditEntry& entry) {
  auto entered = catalogue_->append_audit(entry);
  if (entered) return entered;
  const auto newest = catalogue_->audit(1);
  const bool is_there = newest && !newest->empty() && newest->front().utc_ns == entry.utc_ns && newest->front().what == entry.what &&
                        newest->front().target == entry.target;
  if (!is_there) return entered;
  complain(entered);
  return {};
}

void Recordings::enter_audit(record::AuditEntry entry) {
  core::Status entered;
  if (audit_problem_.empty()) entered = append_audit(entry);
  if (entered && audit_problem_.empty()) return;
  if (!entered && !is_written_again(entered.error())) complain(entered);
  if (!entered) audit_problem_ = core::to_string(entered.error());
  if (owed_audit_.size() < kMostOwed) {
    owed_audit_.push_back(std::move(entry));
  } else {
    ++unwritten_audit_;
  }
}

void Recordings::enter_owed_audit() {
  if (audit_problem_.empty()) return;
  for (; !owed_audit_.empty(); owed_audit_.pop_front()) {
    if (!append_audit(owed_audit_.front())) return;
  }
  const std::string target = std::to_string(unwritten_audit_) + " entries";
  const std::int64_t utc_ns = clock_.now_ns() + clock_.utc_minus_monotonic_ns();
  if (unwritten_audit_ > 0 && !append_audit({.utc_ns = utc_ns, .who = "dtsd", .what = "audit_lost", .target = target, .result = "failed"}))
    return;
  unwritten_audit_ = 0;
  audit_problem_.clear();
}

}  // namespace dts::session
