// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "core/doorbell.h"
#include "core/log.h"
#include "core/thread.h"
#include "ipc/data_socket.h"
#include "ipc/encode.h"
#include "session/rig.h"

namespace dts::ipc {

/// The publish thread: frames of all rigs, events and status onto the data socket.
///
///     rig frames rings --bell--> encode --> DataSocket
///     control thread --post()--> outbox ---^
///
/// A new subscriber triggers a repeat of the retained messages (status, last session and device event of each rig), so
/// that it knows at once where things stand; live streams start at now. A flood of subscriptions gets one repeat per 100 ms.
class PublishThread {
 public:
  /// `bell` is the one given to the rigs; it and the rigs outlive this object.
  PublishThread(std::unique_ptr<DataSocket> socket, core::Doorbell& bell, const std::vector<session::Rig*>& rigs, core::Clock& clock,
                std::uint64_t instance_id);
  ~PublishThread() { stop(); }
  PublishThread(const PublishThread&) = delete;
  PublishThread& operator=(const PublishThread&) = delete;

  /// Refused scheduling wishes are returned.
  [[nodiscard]] std::vector<std::string> start(const core::ThreadPolicy& policy);
  void stop() noexcept;

  /// Queues an event of that rig, or a status. The status and events whose topic is retained are repeated for new subscribers until
  /// another replaces them. Bounded: beyond 1000 queued messages the oldest that is not retained is dropped. Thread: any but the sample
  /// threads.
  void post(const std::string& rig, dts::v1::Event event);
  void post(dts::v1::StatusSnapshot status);
  /// Ends all connections from other machines soon: a key was revoked. Thread: any but the sample threads.
  void drop_remote_peers();
  /// They cannot come again, since their address could not be bound. Thread: any.
  [[nodiscard]] bool is_remote_down() const noexcept { return is_remote_down_.load(std::memory_order_relaxed); }
  /// Counts up several times a second while the thread lives. Thread: any.
  [[nodiscard]] std::uint64_t turns() const noexcept { return turns_.load(std::memory_order_relaxed); }

 private:
  struct Outgoing {
    std::string topic;
    std::shared_ptr<const google::protobuf::MessageLite> message;
    bool is_retained = false;
  };
  struct Source {
    session::Rig* rig;
    std::string trigger_channel;                                 ///< Its name.
    std::vector<std::pair<std::size_t, StreamEncoder>> streams;  ///< Index in the frame, encoder; published streams only.
    session::LatencyReport latency{};
  };
  void run(const std::stop_token& stop);
  void publish(Source& source);
  void send_streams(Source& source, const core::Frame& frame);
  void note_latency(Source& source, const core::Frame& frame);
  void send_next_event(const Source& source, std::uint32_t& left);
  void post(Outgoing outgoing);
  void send_event(const Source& source, const dts::v1::Event& event);
  void send_outbox();
  void send_retained();

  std::unique_ptr<DataSocket> socket_;
  core::Doorbell& bell_;
  std::vector<Source> sources_;
  core::Clock& clock_;
  std::uint64_t instance_id_;
  std::atomic<bool> is_drop_due_{false};
  std::atomic<bool> is_remote_down_{false};
  std::atomic<std::uint64_t> turns_{0};
  bool is_retained_due_ = false;
  std::int64_t retained_sent_ns_ = 0;
  std::mutex outbox_mutex_;  ///< Held for moving pointers only, never across a send.
  std::vector<Outgoing> outbox_;
  std::vector<Outgoing> retained_;
  std::jthread thread_;
};

}  // namespace dts::ipc
