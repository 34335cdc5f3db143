// SPDX-License-Identifier: Apache-2.0
#include "lsl/event_text.h"

#include <nlohmann/json.hpp>

#include "dts/wire/event_json.h"

namespace dts::lsl {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string event_text(const v1::Event& event) {
  v1::Event offered = event;
  offered.clear_instance_id();
  if (offered.has_device()) offered.mutable_device()->clear_uri();  // may be a command line
  if (offered.has_session()) {
    offered.mutable_session()->clear_subject();
    offered.mutable_session()->clear_label();
  }
  return wire::to_json(offered);
}

std::string loss_text(const client::Block& block) {
  v1::Event event;
  event.set_segment(block.segment);
  event.set_scan(block.first_scan);
  event.set_host_time_ns(block.host_time_ns);
  event.mutable_loss()->set_scans(block.lost_scans);
  Json json = Json::parse(wire::to_json(event));
  json["stream"] = block.stream;
  json["is_exact"] = block.is_lost_exact;
  return json.dump();
}

std::string restart_text(std::int64_t host_ns) {
  return Json{{"host_time_ns", std::to_string(host_ns)}, {"restart", Json::object()}}.dump();
}

bool is_offered(const v1::Event& event) noexcept { return !event.has_sway() || !event.sway().is_preliminary(); }

}  // namespace dts::lsl
