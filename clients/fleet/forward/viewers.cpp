// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/viewers.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "core/join.h"
#include "dts/wire/options.h"

namespace dts::fleet::forward {
namespace {

constexpr std::chrono::seconds kLease{10};
constexpr std::chrono::minutes kLogRefusals{1};
constexpr std::size_t kMostViewers = 64;

/// Returns true for dtsd's status, for a stream that a rig publishes, and for its events.
bool is_topic(const std::string& topic, const v1::StatusSnapshot& status) {
  if (topic == kStatusTopic) return true;
  const std::size_t slash = topic.find('/');
  if (slash == std::string::npos) return false;
  const std::string name = topic.substr(slash + 1);
  return std::ranges::any_of(status.rigs(), [&](const v1::RigStatus& rig) {
    if (rig.rig().name() != topic.substr(0, slash)) return false;
    return std::ranges::find(rig.rig().published(), name) != rig.rig().published().end() || dts::wire::is_event_topic(name);
  });
}

v1::LiveAnswer refusal(const std::string& reason) {
  v1::LiveAnswer answer;
  answer.mutable_refusal()->set_reason(reason);
  return answer;
}

std::vector<std::string> keys_of(const std::map<std::string, Viewers::Time>& leases) {
  std::vector<std::string> keys;
  for (const auto& [key, until] : leases) keys.push_back(key);
  return keys;
}

}  // namespace

v1::LiveAnswer Viewers::handle(const v1::LiveRequest& request, const v1::StatusSnapshot* status, Time now) {
  if (!is_allowed_) {
    if (refused_at_ == Time() || now - refused_at_ >= kLogRefusals) {
      log_.info(request.who() + " at the centre wants to watch, which [live] does not allow");
      refused_at_ = now;
    }
    return refusal("the clinic does not allow it");
  }
  if (status == nullptr) return refusal("dtsd of the clinic does not run");
  for (const std::string& topic : request.topics()) {
    if (!is_topic(topic, *status)) return refusal("the clinic has no topic " + topic);
  }
  if (names_.size() >= kMostViewers && !names_.contains(request.who()))
    return refusal(std::to_string(kMostViewers) + " others watch already");
  const std::vector<std::string> wanted(request.topics().begin(), request.topics().end());
  if (!names_.contains(request.who())) log_.info(request.who() + " at the centre watches " + core::join(wanted, ", "));
  for (const std::string& topic : wanted) topics_[topic] = now + kLease;
  names_[request.who()] = now + kLease;
  v1::LiveAnswer answer;
  answer.set_lease_s(static_cast<std::uint32_t>(kLease.count()));
  return answer;
}

void Viewers::expire(Time now) {
  std::erase_if(topics_, [now](const auto& lease) { return lease.second <= now; });
  std::erase_if(names_, [this, now](const auto& lease) {
    if (lease.second > now) return false;
    log_.info(lease.first + " at the centre does not watch any more");
    return true;
  });
}

std::vector<std::string> Viewers::topics() const { return keys_of(topics_); }
std::vector<std::string> Viewers::names() const { return keys_of(names_); }

}  // namespace dts::fleet::forward
