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

/// The control loop: answers commands from the ROUTER sockets, drives the timers of sessions and devices, and passes their events and the
/// status to the publish thread. Everything here runs on one thread, the daemon's control thread.
///
/// A message is [identity] [empty, from REQ clients] [Request]. The server counts every other message (too large or malformed) and, if the
/// sender is known, answers with a typed error. The gate decides whether a message gets an answer.
class ControlServer {
 public:
  /// Serves `sockets` in turns. The references must outlive the server.
  ControlServer(std::vector<ControlSocket> sockets, access::Gate gate, session::Supervisor& supervisor, CommandHandler& handler,
                PublishThread& publisher, core::Clock& clock, core::Log log);

  /// Serves for up to `ms` milliseconds, then returns; call it in a loop. Thread: control.
  void serve(int ms);
  /// Passes the supervisor's notices to the publish thread. Call it once more after all sessions have stopped.
  void publish_notices();
  /// Answers the waiting commands that have an answer now. Call it once more after all sessions have stopped.
  void answer_waiting();
  /// Ends all connections from other machines soon. Clients that are still authorised reconnect by themselves.
  void drop_remote_peers();

 private:
  struct Waiting {
    Incoming asked;
    access::Peer peer;
    dts::v1::Request request;
    Pending pending;
    std::int64_t deadline_ns = 0;
    ControlSocket* socket = nullptr;
  };
  void renew_remote(std::int64_t now_ns);
  void receive(ControlSocket& socket);
  /// Answers a message if its sender is below its message limit.
  void admit(ControlSocket& socket, Incoming asked);
  void answer(ControlSocket& socket, Incoming asked, access::Peer peer);
  /// Answers a repeated request from the cache, or rejects a different request with the same ID. Returns true if it did one of these.
  [[nodiscard]] bool answer_repeat(ControlSocket& socket, Incoming& asked, const access::Peer& peer, const std::string& id);
  void refuse(ControlSocket& socket, const Incoming& asked, const access::Peer& peer, const dts::v1::Request& request,
              const core::Error& why);
  void enter_audit(const access::Peer& peer, const dts::v1::Request& request, const dts::v1::Response& response);
  void reject(ControlSocket& socket, const Incoming& asked, const access::Peer& peer, const std::string& why);
  void count_rejected();
  void log_rejected(std::int64_t now_ns);
  void publish_status();

  std::vector<ControlSocket> sockets_;
  access::Gate gate_;
  session::Supervisor& supervisor_;
  CommandHandler& handler_;
  PublishThread& publisher_;
  core::Clock& clock_;
  core::Log log_;
  ReplyCache replies_;
  std::vector<Waiting> waiting_;
  bool is_drop_due_ = false;
  std::int64_t next_drop_ns_ = 0;
  std::int64_t next_tick_ns_ = 0;
  std::int64_t next_status_ns_ = 0;
  std::int64_t next_log_ns_ = 0;
  std::uint64_t unlogged_rejections_ = 0;
  std::string last_rejected_;  ///< Sender of the newest rejected message whose sender was looked up.
};

}  // namespace dts::ipc
