// SPDX-License-Identifier: Apache-2.0
#include "session/record_sync.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "core/thread.h"

namespace dts::session {

/// The two files of a recording; closed when their last user releases them.
struct RecordSync::Files {
  ~Files() {
    for (const int descriptor : descriptors) {
      if (descriptor >= 0) ::close(descriptor);
    }
  }
  [[nodiscard]] core::Status open() {
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      // The kernel reports a write-back error once to every descriptor that was open at the time, so these see it like the writer's.
      descriptors[i] = ::open(names[i].c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
      if (descriptors[i] < 0) return core::fail_errno(errno, "cannot open " + names[i] + " to synchronise it");
    }
    return {};
  }
  [[nodiscard]] core::Status synchronise() const {
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      if (::fdatasync(descriptors[i]) != 0) return core::fail_errno(errno, "cannot synchronise " + names[i]);
    }
    return {};
  }

  std::array<std::string, 2> names{};  ///< The recording, then its index.
  std::array<int, 2> descriptors{-1, -1};
  bool is_due = false;
  std::int64_t asked_ns = 0;
  std::int64_t done_ns = 0;
  std::optional<core::Error> error{};
};

void RecordSync::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread("record-sync", {}));  // default policy, cannot be rejected
    run(stop);
  });
}

void RecordSync::stop() noexcept {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

core::Status RecordSync::add(const std::string& rig, const std::string& name) {
  auto files = std::make_shared<Files>();
  files->names = {name + ".part", name + ".idx"};
  DTS_TRY(files->open());
  const std::lock_guard lock(mutex_);
  files_[rig] = std::move(files);
  return {};
}

void RecordSync::remove(const std::string& rig) {
  std::shared_ptr<Files> last;  // closes the files after the lock is released
  const std::lock_guard lock(mutex_);
  const auto found = files_.find(rig);
  if (found == files_.end()) return;
  last = std::move(found->second);
  files_.erase(found);
}

core::Status RecordSync::request(const std::string& rig, std::int64_t taken_ns) {
  const std::lock_guard lock(mutex_);
  const auto found = files_.find(rig);
  if (found == files_.end()) return core::fail(core::ErrorCode::WrongState, "no thread synchronises the recording of rig '" + rig + "'");
  if (found->second->error) return tl::make_unexpected(*found->second->error);
  found->second->is_due = true;
  found->second->asked_ns = taken_ns;
  is_asked_.notify_one();
  return {};
}

std::int64_t RecordSync::done_ns(const std::string& rig) {
  const std::lock_guard lock(mutex_);
  const auto found = files_.find(rig);
  return found == files_.end() ? 0 : found->second->done_ns;
}

/// Takes turns: on a slow disk, every rig is due again before the others are done.
std::map<std::string, std::shared_ptr<RecordSync::Files>>::iterator RecordSync::next_due() {
  const auto is_due = [](const auto& entry) { return entry.second->is_due; };
  const auto after = files_.upper_bound(last_);
  const auto found = std::find_if(after, files_.end(), is_due);
  if (found != files_.end()) return found;
  const auto wrapped = std::find_if(files_.begin(), after, is_due);
  return wrapped != after ? wrapped : files_.end();
}

void RecordSync::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const auto due = next_due();
    if (due == files_.end()) {
      is_asked_.wait(lock, stop, [this] { return next_due() != files_.end(); });
      continue;
    }
    last_ = due->first;
    const std::shared_ptr<Files> files = due->second;
    files->is_due = false;
    const std::int64_t asked_ns = files->asked_ns;
    lock.unlock();
    const auto synchronised = files->synchronise();
    lock.lock();
    if (!synchronised && !files->error) files->error = synchronised.error();
    if (synchronised) files->done_ns = asked_ns;
  }
}

}  // namespace dts::session
