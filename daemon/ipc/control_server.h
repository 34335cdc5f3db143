// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "core/clock.h"
#include "core/log.h"
#include "ipc/command_handler.h"
#include "ipc/publish_thread.h"
#include "ipc/reply_cache.h"

namespace dts::ipc {

/// The control loop: commands from the ROUTER socket, the passing of time for sessions and devices, and their events
/// and the status towards the bus. Everything here runs on one thread, the daemon's control thread.
///
/// A message is [identity] [empty, from REQ clients] [Request]; anything else, oversized or malformed, is counted and,
/// where a sender is known, answered with a typed error.
class ControlServer {
 public:
  /// Binds. Fails with the endpoint and the reason. The references outlive the server.
  [[nodiscard]] static core::Result<std::unique_ptr<ControlServer>> bind(zmq::context_t& context, const std::string& endpoint,
                                                                         session::Supervisor& supervisor, CommandHandler& handler,
                                                                         PublishThread& publisher, core::Clock& clock,
                                                                         std::uint64_t instance_id);

  /// Serves for up to `ms` milliseconds, then returns; call it in a loop. Thread: control.
  void serve(int ms);
  /// Hands what the supervisor noticed to the bus; also called once more when all sessions were stopped.
  void publish_notices();
  /// Answers the commands that were waited for, as far as there is an answer now; also called once more when all sessions were stopped.
  void answer_waiting();

 private:
  struct Waiting {
    std::vector<std::string> envelope;
    std::string request_id;
    std::string payload;
    dts::v1::Request request;
    Pending pending;
    std::int64_t deadline_ns = 0;
  };
  ControlServer(zmq::socket_t socket, session::Supervisor& supervisor, CommandHandler& handler, PublishThread& publisher,
                core::Clock& clock, std::uint64_t instance_id);
  void receive();
  void answer(std::vector<std::string> envelope, const std::string& payload);
  /// Serves a repeat of a known request, or refuses another request under its id; true when it did either.
  [[nodiscard]] bool answer_repeat(std::vector<std::string>& envelope, const std::string& id, const std::string& payload);
  void reply(const std::vector<std::string>& envelope, const std::string& bytes);
  void reject(const std::vector<std::string>& envelope, const std::string& why);
  void publish_status();

  zmq::socket_t socket_;
  session::Supervisor& supervisor_;
  CommandHandler& handler_;
  PublishThread& publisher_;
  core::Clock& clock_;
  std::uint64_t instance_id_;
  ReplyCache replies_;
  std::vector<Waiting> waiting_;
  std::int64_t next_tick_ns_ = 0;
  std::int64_t next_status_ns_ = 0;
};

}  // namespace dts::ipc
