// SPDX-License-Identifier: Apache-2.0
#include "relay/fresh_keys.h"

#include <sys/stat.h>

#include <cerrno>

namespace dts::relay {

core::Result<std::unique_ptr<FreshKeys>> FreshKeys::open(const std::string& directory, core::Log log) {
  if (struct stat found{}; ::stat((directory + "/server.toml").c_str(), &found) != 0 && errno == ENOENT) {
    return core::fail(core::ErrorCode::NotFound, "there is no key of the server in " + directory,
                      "start dtsd first, which makes it; dts-relay must read the same dtsd.toml");
  }
  DTS_TRY_ASSIGN(auto store, access::KeyStore::open(directory));
  std::unique_ptr<FreshKeys> keys(new FreshKeys(directory + "/clients.toml", std::move(store), std::move(log)));
  keys->look();  // the file may have changed since the store has read it
  return keys;
}

bool FreshKeys::Stamp::is_same(const Stamp& other) const noexcept {
  return inode == other.inode && bytes == other.bytes && modified.tv_sec == other.modified.tv_sec &&
         modified.tv_nsec == other.modified.tv_nsec;
}

FreshKeys::Stamp FreshKeys::stamp() const {
  struct stat found {};
  if (::stat(file_.c_str(), &found) != 0) return {};
  return {.inode = found.st_ino, .bytes = found.st_size, .modified = found.st_mtim};
}

void FreshKeys::look() {
  const std::lock_guard lock(mutex_);
  const Stamp now = stamp();  // before the file is read: a later change is then seen at the next look
  if (now.is_same(seen_)) return;
  if (auto reloaded = store_->reload(); !reloaded) {  // tried again at every look: a revoked key must not stay valid
    if (!now.is_same(failed_)) log_.error(core::to_string(reloaded.error()));
    failed_ = now;
    return;
  }
  seen_ = now;
  log_.info(std::to_string(store_->keys().size()) + " client key(s)");
}

}  // namespace dts::relay
