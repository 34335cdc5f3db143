// SPDX-License-Identifier: Apache-2.0
#include "ctl/silence.h"

#include <algorithm>

#include "cli/suggestion.h"
#include "dts/wire/options.h"

namespace dts::ctl {
namespace {

using client::ErrorCode;

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

bool is_asked_for(const std::string& topic, const std::vector<std::string>& prefixes) {
  return std::ranges::any_of(prefixes, [&](const std::string& prefix) { return topic.starts_with(prefix); });
}

std::vector<std::string> streams_of(const v1::RigInfo& rig) {
  std::vector<std::string> topics;
  for (const std::string& stream : rig.published()) topics.push_back(rig.name() + "/" + stream);
  return topics;
}

std::vector<std::string> events_of(const v1::RigInfo& rig) {
  std::vector<std::string> topics;
  for (const v1::Topic& topic : wire::event_topics()) topics.push_back(rig.name() + "/" + topic.name());
  return topics;
}

client::Error nothing_published(const v1::StatusSnapshot& status, const std::vector<std::string>& prefixes) {
  std::vector<std::string> topics;
  for (const v1::RigStatus& rig : status.rigs()) {
    for (const std::string& topic : streams_of(rig.rig())) topics.push_back(topic);
  }
  std::vector<std::string> candidates = topics;
  for (const v1::RigStatus& rig : status.rigs()) {
    for (const std::string& topic : events_of(rig.rig())) candidates.push_back(topic);
  }
  const std::string meant = prefixes.empty() ? "" : cli::nearest(prefixes.front(), candidates);
  const std::string hint = meant.empty() ? "the published streams are: " + joined(topics, " ") : "did you mean " + meant + "?";
  return {ErrorCode::NotFound, "no topic begins with '" + joined(prefixes, "', '") + "'",
          topics.empty() ? "add a [[rig]] to the daemon's configuration" : hint};
}

bool is_any_asked_for(const std::vector<std::string>& topics, const std::vector<std::string>& prefixes) {
  return std::ranges::any_of(topics, [&](const std::string& topic) { return is_asked_for(topic, prefixes); });
}

}  // namespace

bool asks_for_events_only(const v1::StatusSnapshot* status, const std::vector<std::string>& prefixes) {
  if (status == nullptr) return false;
  bool has_event = false;
  for (const v1::RigStatus& rig : status->rigs()) {
    if (is_any_asked_for(streams_of(rig.rig()), prefixes)) return false;
    has_event = has_event || is_any_asked_for(events_of(rig.rig()), prefixes);
  }
  return has_event;
}

client::Error explain_silence(const v1::StatusSnapshot* status, const std::vector<std::string>& prefixes, const std::string& endpoint) {
  if (status == nullptr) {
    return {ErrorCode::Unreachable, "no data from the daemon at " + endpoint,
            "check that dtsd runs: dtsctl status; check the address: --data URI"};
  }
  bool has_stream = false;
  bool has_event = false;
  for (const v1::RigStatus& rig : status->rigs()) {
    const bool wants_stream = is_any_asked_for(streams_of(rig.rig()), prefixes);
    has_event = has_event || is_any_asked_for(events_of(rig.rig()), prefixes);
    if (wants_stream && rig.device() != v1::DEVICE_STATE_STREAMING) {
      const std::string why = rig.device_message().empty() ? "its device does not stream" : rig.device_message();
      return {ErrorCode::DeviceGone, "rig '" + rig.rig().name() + "' sends no scans: " + why, "dtsctl device list; dtsctl doctor"};
    }
    has_stream = has_stream || wants_stream;
  }
  if (has_stream) return {ErrorCode::Timeout, "no data, although the daemon reports a streaming device", "dtsctl status; dtsctl doctor"};
  if (has_event) return {ErrorCode::Timeout, "no event yet; the daemon is OK", "wait: events occur only when something happens"};
  return nothing_published(*status, prefixes);
}

}  // namespace dts::ctl
