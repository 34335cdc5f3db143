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

/// The control loop: commands from the ROUTER sockets, the passing of time for sessions and devices, and their events
/// and the status towards the bus. Everything here runs on one thread, the daemon's control thread.
///
/// A message is [identity] [empty, from REQ clients] [Request]; anything else, oversized or malformed, is counted and,
/// where a sender is known, answered with a typed error. What may be answered at all is the gate's to say.
class ControlServer {
 public:
  /// `sockets` are asked in turns. The references outlive the server.
  ControlServer(std::vector<ControlSocket> sockets, access::Gate gate, session::Supervisor& supervisor, CommandHandler& handler,
                PublishThread& publisher, core::Clock& clock, core::Log log, std::uint64_t instance_id);

  /// Serves for up to `ms` milliseconds, then returns; call it in a loop. Thread: control.
  void serve(int ms);
  /// Hands what the supervisor noticed to the bus; also called once more when all sessions were stopped.
  void publish_notices();
  /// Answers the commands that were waited for, as far as there is an answer now; also called once more when all sessions were stopped.
  void answer_waiting();
  /// Ends all connections from other machines soon; those whose keys are still good come again by themselves.
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
  /// Answers a message if its sender may send one more.
  void admit(ControlSocket& socket, Incoming asked);
  void answer(ControlSocket& socket, Incoming asked, access::Peer peer);
  /// Serves a repeat of a known request, or refuses another request under its id; true when it did either.
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
  std::uint64_t instance_id_;
  ReplyCache replies_;
  std::vector<Waiting> waiting_;
  bool is_drop_due_ = false;
  std::int64_t next_drop_ns_ = 0;
  std::int64_t next_tick_ns_ = 0;
  std::int64_t next_status_ns_ = 0;
  std::int64_t next_log_ns_ = 0;
  std::uint64_t unlogged_rejections_ = 0;
  std::string last_rejected_;  ///< Who sent the newest one that was looked at.
};

}  // namespace dts::ipc
