// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "core/doorbell.h"
#include "core/frame_ring.h"
#include "core/log.h"
#include "core/thread.h"
#include "ipc/data_socket.h"
#include "ipc/encode.h"
#include "ipc/local_publisher.h"
#include "session/rig.h"

namespace dts::ipc {

/// Publishes frames of all rigs, events and the status on the data socket.
///
///     rig thread:  frame without events --> encode --> DataSocket (if no other thread uses it) --> first subscribers
///                        '--bell--.
///     publish thread: [ring of frames] --> encode ----> DataSocket --> all subscribers
///     control thread --post()--> outbox ----^
///
/// A rig's thread sends its frames itself, because waking another thread costs more than all else. It leaves to the publish thread what
/// could make it wait or allocate: events, subscriptions, frames while another thread uses the socket, subscribers above `kPeersOfARig`.
/// Each frame of a rig is published once, in order: both threads continue with the same reader.
///
/// A new subscription triggers a repeat of the retained messages (status, last session event and last device event of each rig), so that
/// the subscriber knows the current state at once. Streams are not repeated. At most one repeat per 100 ms, however many subscriptions
/// arrive.
class PublishThread {
 public:
  /// Subscribers that a rig's thread serves; each costs it a system call per block.
  static constexpr std::size_t kPeersOfARig = 16;
  /// Frames that a rig's thread sends at once. It leaves a longer burst to the publish thread.
  static constexpr std::size_t kFramesOfARig = 8;
  /// Longest messages of a frame that a rig's thread sends. They find room in the queue of each subscriber who reads.
  static constexpr std::size_t kFrameBytesOfARig = LocalPublisher::kSmallQueueBytes * 3 / 4;

  /// `bell` is the doorbell that the rigs ring. `bell` and the rigs must outlive this object.
  PublishThread(std::unique_ptr<DataSocket> socket, core::Doorbell& bell, const std::vector<session::Rig*>& rigs, core::Clock& clock,
                std::uint64_t instance_id);
  /// Ends the rigs' threads, which use this object.
  ~PublishThread();
  PublishThread(const PublishThread&) = delete;
  PublishThread& operator=(const PublishThread&) = delete;

  /// Starts the thread. Returns the scheduling requests that the system rejected.
  [[nodiscard]] std::vector<std::string> start(const core::ThreadPolicy& policy);
  void stop() noexcept;

  /// Queues an event of a rig, or a status. Retains the status and events with a retained topic until a newer one replaces them, to repeat
  /// them for new subscribers. If 1000 messages are queued, drops the oldest one, first those that are not retained. Thread: any but the
  /// rigs' threads.
  void post(const std::string& rig, dts::v1::Event event);
  void post(dts::v1::StatusSnapshot status);
  /// Returns a counter that rises several times a second while the thread works. Thread: any.
  [[nodiscard]] std::uint64_t turns() const noexcept { return turns_.load(std::memory_order_relaxed); }

 private:
  /// Most frames of one rig per turn; then the other rigs, subscriptions and stop requests are handled.
  static constexpr std::size_t kFramesPerTurn = 64;

  struct Outgoing {
    std::string topic;
    std::shared_ptr<const google::protobuf::MessageLite> message;
    bool is_retained = false;
  };
  struct Source final : session::FramePublisher {
    Source(PublishThread& owner, session::Rig& rig, std::uint64_t instance_id);
    [[nodiscard]] bool publish() noexcept override { return owner.publish_from_rig(*this); }

    PublishThread& owner;
    session::Rig& rig;
    core::FrameReader frames;
    std::string trigger_channel;                                 ///< Name of the channel.
    std::vector<std::pair<std::size_t, StreamEncoder>> streams;  ///< Index in the frame, encoder; published streams only.
    bool is_short = true;                                        ///< Its frames have at most `kFrameBytesOfARig`.
    std::array<std::int64_t, kFramesPerTurn> newest_ns{};        ///< Newest scans of the frames that are sent but not flushed.
    std::size_t unflushed = 0;
    session::PublishReport report{};
  };
  enum class Caller : std::uint8_t { Rig, Publish };

  void run(const std::stop_token& stop);
  [[nodiscard]] bool publish_from_rig(Source& source) noexcept;
  [[nodiscard]] bool publish(Source& source, Caller caller);
  [[nodiscard]] bool flush(Source& source, std::size_t most_peers);
  void publish_all();
  void send_streams(Source& source, const core::Frame& frame);
  static void note_newest(Source& source, const core::Frame& frame);
  void post(Outgoing outgoing);
  void send_event(const Source& source, const core::Event& event);
  void send_event(const Source& source, dts::v1::Event event);
  void send_outbox();
  void send_retained();

  std::mutex socket_mutex_;  ///< For the socket, apart from its `wait`, and for the sources. A rig's thread only tries to lock it.
  std::unique_ptr<DataSocket> socket_;
  core::Doorbell& bell_;
  std::deque<Source> sources_;
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
