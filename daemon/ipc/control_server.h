// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "access/gate.h"
#include "core/clock.h"
#include "core/log.h"
#include "ipc/command_handler.h"
#include "ipc/control_socket.h"
#include "ipc/publish_thread.h"
#include "ipc/reply_cache.h"

namespace dts::ipc {

/// The control loop: answers commands from the ROUTER socket, drives the timers of sessions and devices, and passes their events and the
/// status to the publish thread. Everything here runs on one thread, the daemon's control thread.
///
/// The server counts malformed messages and answers them with a typed error. The gate decides what a sender may do.
class ControlServer {
 public:
  /// The references must outlive the server.
  ControlServer(ControlSocket socket, access::Gate gate, session::Supervisor& supervisor, CommandHandler& handler, PublishThread& publisher,
                core::Clock& clock, core::Log log);

  /// Serves for up to `ms` milliseconds, then returns; call it in a loop. Thread: control.
  void serve(int ms);
  /// Passes the supervisor's notices to the publish thread. Call it once more after all sessions have stopped.
  void publish_notices();
  /// Answers the waiting commands that have an answer now. Call it once more after all sessions have stopped.
  void answer_waiting();

 private:
  struct Waiting {
    Incoming asked;
    access::Peer peer;
    dts::v1::Request request;
    Pending pending;
    std::int64_t deadline_ns = 0;
  };
  void receive();
  void answer(Incoming asked);
  /// Answers a repeated request from the cache, or rejects a different request with the same ID. Returns true if it did one of these.
  [[nodiscard]] bool answer_repeat(Incoming& asked, const access::Peer& peer, const std::string& id);
  void refuse(const Incoming& asked, const access::Peer& peer, const dts::v1::Request& request, const core::Error& why);
  void enter_audit(const access::Peer& peer, const dts::v1::Request& request, const dts::v1::Response& response);
  void reject(const Incoming& asked, const access::Peer& peer, const std::string& why);
  void log_rejected(std::int64_t now_ns);
  void publish_status();

  ControlSocket socket_;
  access::Gate gate_;
  session::Supervisor& supervisor_;
  CommandHandler& handler_;
  PublishThread& publisher_;
  core::Clock& clock_;
  core::Log log_;
  ReplyCache replies_;
  std::vector<Waiting> waiting_;
  std::int64_t next_tick_ns_ = 0;
  std::int64_t next_status_ns_ = 0;
  std::int64_t next_log_ns_ = 0;
  std::uint64_t unlogged_rejections_ = 0;
  std::string last_rejected_;  ///< Sender of the newest rejected message.
};

}  // namespace dts::ipc
