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

/// The publish thread: sends frames of all rigs, events and the status to the data socket.
///
///     rig frames rings --bell--> encode --> DataSocket
///     control thread --post()--> outbox ---^
///
/// A new subscription triggers a repeat of the retained messages (status, last session event and last device event of each rig), so that
/// the subscriber knows the current state at once. Streams are not repeated. At most one repeat per 100 ms, however many subscriptions
/// arrive.
class PublishThread {
 public:
  /// `bell` is the doorbell that the rigs ring. `bell` and the rigs must outlive this object.
  PublishThread(std::unique_ptr<DataSocket> socket, core::Doorbell& bell, const std::vector<session::Rig*>& rigs, core::Clock& clock,
                std::uint64_t instance_id);
  ~PublishThread() { stop(); }
  PublishThread(const PublishThread&) = delete;
  PublishThread& operator=(const PublishThread&) = delete;

  /// Starts the thread. Returns the scheduling requests that the system rejected.
  [[nodiscard]] std::vector<std::string> start(const core::ThreadPolicy& policy);
  void stop() noexcept;

  /// Queues an event of a rig, or a status. Retains the status and events with a retained topic until a newer one replaces them, to repeat
  /// them for new subscribers. If 1000 messages are queued, drops the oldest one, first those that are not retained. Thread: any but the
  /// sample threads.
  void post(const std::string& rig, dts::v1::Event event);
  void post(dts::v1::StatusSnapshot status);
  /// Returns a counter that rises several times a second while the thread works. Thread: any.
  [[nodiscard]] std::uint64_t turns() const noexcept { return turns_.load(std::memory_order_relaxed); }

 private:
  struct Outgoing {
    std::string topic;
    std::shared_ptr<const google::protobuf::MessageLite> message;
    bool is_retained = false;
  };
  struct Source {
    session::Rig* rig;
    std::string trigger_channel;                                 ///< Name of the channel.
    std::vector<std::pair<std::size_t, StreamEncoder>> streams;  ///< Index in the frame, encoder; published streams only.
    session::LatencyReport latency{};
  };
  void run(const std::stop_token& stop);
  void publish(Source& source);
  void send_streams(Source& source, const core::Frame& frame);
  void note_latency(Source& source, const core::Frame& frame);
  void send_next_event(const Source& source, std::uint32_t& left);
  void post(Outgoing outgoing);
  void send_event(const Source& source, dts::v1::Event event);
  void send_outbox();
  void send_retained();

  std::unique_ptr<DataSocket> socket_;
  core::Doorbell& bell_;
  std::vector<Source> sources_;
  core::Clock& clock_;
  std::uint64_t instance_id_;
  std::atomic<std::uint64_t> turns_{0};
  bool is_retained_due_ = false;
  std::int64_t retained_sent_ns_ = 0;
  std::mutex outbox_mutex_;  ///< Locked only to move pointers, never during a send.
  std::vector<Outgoing> outbox_;
  std::vector<Outgoing> retained_;
  std::jthread thread_;
};

}  // namespace dts::ipc
