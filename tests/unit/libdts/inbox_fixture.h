// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../clients/libdts/inbox.h"

#include <gtest/gtest.h>

#include "unit/libdts/fake_daemon.h"

namespace dts::client {

inline constexpr std::int64_t kNowNs = 1'000'000'000'000;
inline constexpr std::int64_t kMillisecond = 1'000'000;

class InboxTest : public ::testing::Test {
 protected:
  static Inbox inbox(Mode mode, bool hands_out_status = false) { return {mode, hands_out_status, "this-boot"}; }
  static void give(Inbox& inbox, const std::string& topic, const google::protobuf::MessageLite& message, std::int64_t now_ns = kNowNs) {
    give_raw(inbox, topic, message.SerializeAsString(), now_ns);
  }
  static void give_raw(Inbox& inbox, const std::string& topic, const std::string& body, std::int64_t now_ns = kNowNs) {
    inbox.accept(topic, std::as_bytes(std::span(body)), now_ns);
  }
  static void learn(Inbox& inbox) { give(inbox, "dtsd/status", testing::floor_status()); }
  static Inbox learnt(Mode mode) {
    Inbox made = inbox(mode);
    learn(made);
    return made;
  }
  /// Scans are written as SEGMENT:FIRST+COUNT.
  static std::string text_of(const Block& block) {
    std::string text = std::string(block.topic) + " " + std::to_string(block.segment) + ":" + std::to_string(block.first_scan) + "+" +
                       std::to_string(block.scan_count);
    if (block.lost_scans > 0 || !block.is_lost_exact) {
      text += std::string(" lost ") + (block.is_lost_exact ? "" : "at least ") + std::to_string(block.lost_scans);
    }
    return text + (block.age_ns ? " age " + std::to_string(*block.age_ns) + " ns" : "");
  }
  static std::string text_of(const Event& event) { return std::string(event.topic) + " " + event.body->marker().text(); }
  static std::string text_of(const Status& status) { return "status " + std::to_string(status.snapshot->instance_id()); }
  static std::string text_of(const Restart& restart) {
    return "restart " + std::to_string(restart.old_instance_id) + " " + std::to_string(restart.new_instance_id);
  }
  /// All that is handed out now.
  static std::vector<std::string> told(Inbox& inbox) {
    std::vector<std::string> lines;
    while (const auto message = inbox.next(kNowNs)) lines.push_back(std::visit([](const auto& one) { return text_of(one); }, *message));
    return lines;
  }
  static std::string counts(const Inbox& inbox) {
    const SubscriberStatistics& counted = inbox.statistics();
    std::string text;
    for (const auto& [name, count] : {std::pair("messages", counted.messages),
                                      {"malformed", counted.malformed},
                                      {"unknown", counted.unknown_topics},
                                      {"inconsistent", counted.inconsistent},
                                      {"dropped events", counted.dropped_events},
                                      {"restarts", counted.restarts}}) {
      if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + name;
    }
    return text;
  }
  using Lines = std::vector<std::string>;
};

}  // namespace dts::client
