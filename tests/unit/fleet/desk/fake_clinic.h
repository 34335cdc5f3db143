// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "dts/v1/control.pb.h"
#include "fleet/link/link.h"
#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::desk {

inline v1::StatusSnapshot status_of_kent() {
  v1::StatusSnapshot status;
  status.set_instance_id(7);
  status.set_utc_minus_monotonic_ns(5);
  v1::RigInfo& rig = *status.add_rigs()->mutable_rig();
  rig.set_name("floor");
  for (const char* stream : {"raw", "cop"}) rig.add_published(stream);
  return status;
}

inline v1::StreamBlock block_of_cop() {
  v1::StreamBlock block;
  block.set_instance_id(7);
  block.set_scan_count(4);
  return block;
}

/// A clinic that answers requests and publishes its status; "floor/cop" only if it was asked for.
class FakeClinic {
 public:
  FakeClinic(int port, std::string refusal = {}) : refusal_(std::move(refusal)) {
    link_ = *link::Link::open({.servers = {"nats://127.0.0.1:" + std::to_string(port)}, .name = "kent"}, core::Log());
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  [[nodiscard]] std::vector<v1::LiveRequest> requests() const {
    const std::lock_guard lock(mutex_);
    return requests_;
  }
  void publish(const std::string& topic, const std::string& bytes) {
    (void)link_->publish({.subject = wire::to_text({.clinic = "kent", .matter = wire::Matter::Live, .topic = topic}), .data = bytes});
  }

 private:
  void run(const std::stop_token& stop) {
    auto asked = link_->subscribe("dts.v1.kent.down.live");
    while (!stop.stop_requested()) {
      const auto letter = (*asked)->next(std::chrono::milliseconds(10));
      if (!letter) continue;
      const auto request = wire::decode_live_request(letter->data);
      if (!request) continue;
      {
        const std::lock_guard lock(mutex_);
        requests_.push_back(*request);
      }
      v1::LiveAnswer answer;
      if (refusal_.empty())
        answer.set_lease_s(10);
      else
        answer.mutable_refusal()->set_reason(refusal_);
      (void)link_->publish({.subject = letter->reply, .data = answer.SerializeAsString()});
      if (!refusal_.empty()) continue;
      publish("dtsd/status", status_of_kent().SerializeAsString());
      if (std::ranges::find(request->topics(), "floor/cop") != request->topics().end()) {
        publish("floor/cop", block_of_cop().SerializeAsString());
      }
    }
  }

  std::string refusal_;
  std::unique_ptr<link::Link> link_;
  mutable std::mutex mutex_;
  std::vector<v1::LiveRequest> requests_;
  std::jthread thread_;
};

}  // namespace dts::fleet::desk
