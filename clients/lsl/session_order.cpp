// SPDX-License-Identifier: Apache-2.0
#include "lsl/session_order.h"

#include <algorithm>

namespace dts::lsl {
namespace {

bool is_under_way(v1::SessionState state) {
  return state == v1::SESSION_STATE_STARTING || state == v1::SESSION_STATE_SETTLING || state == v1::SESSION_STATE_RUNNING ||
         state == v1::SESSION_STATE_STOPPING;
}

}  // namespace

void SessionOrder::take(std::string_view rig, const v1::SessionChange& change) {
  if (!rigs_.empty() && std::ranges::find(rigs_, rig) == rigs_.end()) return;
  if (is_under_way(change.state())) {
    of_rig_.insert_or_assign(std::string(rig), change.session_id());
    if (std::ranges::find(order_, change.session_id()) == order_.end()) order_.push_back(change.session_id());
  } else if (const auto found = of_rig_.find(rig); found != of_rig_.end()) {
    of_rig_.erase(found);
  }
  std::erase_if(order_, [this](const std::string& id) {
    return std::ranges::none_of(of_rig_, [&id](const auto& entry) { return entry.second == id; });
  });
}

}  // namespace dts::lsl
