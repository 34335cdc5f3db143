// SPDX-License-Identifier: Apache-2.0
#include "gateway/bus/command_pool.h"

#include <pthread.h>

#include <boost/asio/post.hpp>
#include <exception>
#include <utility>

#include "cli/try.h"
#include "dts/control_client.h"
#include "dts/wire/options.h"

namespace dts::gateway {

CommandPool::CommandPool(boost::asio::io_context& io, std::string endpoint) : io_(io), endpoint_(std::move(endpoint)) {}

CommandPool::~CommandPool() {
  stop_.request_stop();
  for (Lane* lane : {&looking_, &doing_}) lane->threads.stop();
  for (Lane* lane : {&looking_, &doing_}) lane->threads.join();
}

void CommandPool::submit(v1::Request request, Answered answered) {
  Lane& lane = wire::rules_of(request).role() == v1::ROLE_VIEWER ? looking_ : doing_;
  if (lane.taken == kMostWaiting) {
    answered(client::fail(client::ErrorCode::LimitExceeded, "too many commands are waiting for the daemon", "try again in a moment"));
    return;
  }
  ++lane.taken;
  boost::asio::post(lane.threads, [this, &lane, request = std::move(request), answered = std::move(answered)]() mutable {
    boost::asio::post(io_, [&lane, answer = send(request), answered = std::move(answered)]() mutable {
      --lane.taken;
      answered(std::move(answer));
    });
  });
}

/// Thread: command. Catches what libraries throw (for example if memory or descriptors run out): one answer fails, not the gateway.
client::Result<v1::Response> CommandPool::send(const v1::Request& request) const {
  try {
    ::pthread_setname_np(::pthread_self(), "command");
    // One client per command: a new socket needs a fraction of a millisecond, and a late answer to an earlier command cannot interfere.
    DTS_TRY_ASSIGN(auto client, client::ControlClient::open({.endpoint = endpoint_}));
    return client.forward(request, stop_.get_token());
  } catch (const std::exception& problem) {
    return client::fail(client::ErrorCode::Failed, std::string("the command cannot be sent: ") + problem.what(), "try again in a moment");
  }
}

}  // namespace dts::gateway
