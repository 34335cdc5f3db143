// SPDX-License-Identifier: Apache-2.0
#include "ipc/reply_cache.h"

#include <utility>

namespace dts::ipc {

const ReplyCache::Entry* ReplyCache::find(const std::string& request_id) const {
  const auto found = replies_.find(request_id);
  return found == replies_.end() ? nullptr : &found->second;
}

void ReplyCache::store(const std::string& request_id, Entry entry) {
  if (!replies_.insert_or_assign(request_id, std::move(entry)).second) return;
  order_.push_back(request_id);
  if (order_.size() > capacity_) {
    replies_.erase(order_.front());
    order_.pop_front();
  }
}

}  // namespace dts::ipc
