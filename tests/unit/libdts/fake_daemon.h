// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "dts/v1/control.pb.h"
#include "dts/v1/stream.pb.h"

namespace dts::testing {

inline constexpr std::chrono::milliseconds kDeadline{60'000};  ///< For conditions that hold within milliseconds.

/// A directory of its own for sockets, gone with the object.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string pattern = (std::filesystem::temp_directory_path() / "dts-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::string endpoint(const std::string& name) const { return "ipc://" + (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// A message in protobuf's text format.
template <class Message>
Message from_text(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

/// The floor platform as dtsd would describe it: streams "cop" (ml_mm, ap_mm, load_n) and "raw" (w1_v), 100 Hz.
inline v1::StatusSnapshot floor_status(std::uint64_t instance_id = 7) {
  v1::StatusSnapshot status;
  status.set_instance_id(instance_id);
  status.set_version("0.1.0");
  status.set_uptime_s(12.5);
  v1::RigStatus& rig = *status.add_rigs();
  rig.mutable_rig()->set_name("floor");
  rig.mutable_rig()->set_kind("floor");
  rig.mutable_rig()->set_device_uri("sim:floor");
  rig.mutable_rig()->add_published("cop");
  rig.mutable_rig()->add_published("raw");
  rig.set_device(v1::DEVICE_STATE_STREAMING);
  rig.set_nominal_rate_hz(100.0);
  rig.set_measured_rate_hz(100.02);
  const auto add_stream = [&rig](const std::string& name, const std::vector<std::array<const char*, 2>>& channels) {
    v1::StreamFormat& stream = *rig.mutable_rig()->add_streams();
    stream.set_name(name);
    stream.mutable_rate()->set_numerator(100);
    stream.mutable_rate()->set_denominator(1);
    for (const auto& [channel, unit] : channels) {
      stream.add_channels()->set_name(channel);
      stream.mutable_channels()->rbegin()->set_unit(unit);
    }
  };
  add_stream("cop", {{"ml_mm", "mm"}, {"ap_mm", "mm"}, {"load_n", "N"}});
  add_stream("raw", {{"w1_v", "V"}});
  return status;
}

/// `scans` scans of `channels` channels; value = scan index + channel / 10.
inline v1::StreamBlock block(std::uint32_t segment, std::uint64_t first_scan, std::uint32_t scans, std::uint64_t sequence,
                             std::uint32_t channels = 3, std::uint64_t instance_id = 7) {
  v1::StreamBlock message;
  message.set_instance_id(instance_id);
  message.set_segment(segment);
  message.set_first_scan(first_scan);
  message.set_scan_count(scans);
  message.set_channel_count(channels);
  message.mutable_rate()->set_numerator(100);
  message.mutable_rate()->set_denominator(1);
  message.set_sequence(sequence);
  for (std::uint32_t channel = 0; channel < channels; ++channel) {
    for (std::uint32_t scan = 0; scan < scans; ++scan) {
      message.add_values(static_cast<float>(first_scan + scan) + static_cast<float>(channel) / 10.0F);
    }
  }
  message.set_quality(std::string(channels, '\0'));
  return message;
}

inline v1::Event marker(const std::string& text, std::uint64_t scan = 5, std::uint64_t instance_id = 7) {
  v1::Event event;
  event.set_instance_id(instance_id);
  event.set_scan(scan);
  event.mutable_marker()->set_text(text);
  return event;
}

/// The publishing half of a daemon: real XPUB socket, driven by the test's own thread.
class FakePublisher {
 public:
  explicit FakePublisher(const std::string& endpoint) : socket_(context_, zmq::socket_type::xpub) {
    socket_.set(zmq::sockopt::linger, 0);
    socket_.set(zmq::sockopt::sndhwm, 100'000);
    socket_.set(zmq::sockopt::xpub_verbose, true);
    socket_.set(zmq::sockopt::rcvtimeo, 5);
    socket_.bind(endpoint);
  }

  /// Where it listens, with the port that the system chose for "tcp://127.0.0.1:*".
  [[nodiscard]] std::string endpoint() const { return socket_.get(zmq::sockopt::last_endpoint); }

  /// True when a subscription to exactly `topic` has arrived before the deadline. `meanwhile` runs between the looks: a
  /// SUB socket sends its subscriptions again only while its owner calls it.
  [[nodiscard]] bool wait_for_subscription(
      std::string_view topic, const std::function<void()>& meanwhile = [] {}) {
    const auto deadline = std::chrono::steady_clock::now() + kDeadline;
    zmq::message_t message;
    while (std::chrono::steady_clock::now() < deadline) {
      if (!socket_.recv(message)) {
        meanwhile();
      } else if (message.size() == topic.size() + 1 && *message.data<char>() == 1 && message.to_string_view().substr(1) == topic) {
        return true;
      }
    }
    return false;
  }
  void send(const std::string& topic, const google::protobuf::MessageLite& message) { send_raw({topic, message.SerializeAsString()}); }
  void send_raw(const std::vector<std::string>& frames) {
    for (std::size_t index = 0; index < frames.size(); ++index) {
      socket_.send(zmq::buffer(frames[index]), index + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
    }
  }

 private:
  zmq::context_t context_{1};
  zmq::socket_t socket_;
};

/// The answering half of a daemon on a thread of its own. `answer` gets each request with its number (from 0) and says
/// what to send back, as payloads of separate messages; none means silence.
class FakeController {
 public:
  using Answer = std::function<std::vector<std::string>(const v1::Request& request, int number)>;

  FakeController(const std::string& endpoint, Answer answer) : answer_(std::move(answer)), socket_(context_, zmq::socket_type::router) {
    socket_.set(zmq::sockopt::linger, 0);
    socket_.bind(endpoint);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  ~FakeController() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
  }
  FakeController(const FakeController&) = delete;
  FakeController& operator=(const FakeController&) = delete;

  [[nodiscard]] int requests() const { return requests_.load(); }

 private:
  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      zmq::pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
      if (zmq::poll(&item, 1, std::chrono::milliseconds(20)) > 0) serve();
    }
  }
  void serve() {
    zmq::message_t identity;
    zmq::message_t frame;
    std::ignore = socket_.recv(identity);
    do {
      std::ignore = socket_.recv(frame);
    } while (frame.more());
    v1::Request request;
    if (!request.ParseFromArray(frame.data(), static_cast<int>(frame.size()))) return;
    for (const std::string& payload : answer_(request, requests_.fetch_add(1))) {
      socket_.send(zmq::buffer(identity.to_string_view()), zmq::send_flags::sndmore);
      socket_.send(zmq::message_t(), zmq::send_flags::sndmore);
      socket_.send(zmq::buffer(payload), zmq::send_flags::none);
    }
  }

  Answer answer_;
  std::atomic<int> requests_{0};
  zmq::context_t context_{1};
  zmq::socket_t socket_;
  std::jthread thread_;
};

/// A response to `request`, filled in by `fill`.
template <class Fill>
std::string reply(const v1::Request& request, Fill&& fill) {
  v1::Response response;
  response.set_request_id(request.request_id());
  fill(response);
  return response.SerializeAsString();
}

}  // namespace dts::testing
