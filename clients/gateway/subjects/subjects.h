// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "dts/error.h"
#include "dts/v1/control.pb.h"
#include "gateway/archive/worker.h"
#include "gateway/http/http_message.h"

namespace dts::gateway {

/// Sends a command to the daemon; answers on the io thread.
using AskDaemon = std::function<void(v1::Request request, std::function<void(client::Result<v1::Response>)>)>;

/// Trends and plain words of a subject, for users who may see subjects:
///
///     GET /api/subjects/ID?language=de    the document of visits::document_of
///
/// Nothing is cached: a subject that was erased has no answer any more. Errors are JSON: {"what","hint"}. Thread: io; a thread of its own
/// makes the document.
class Subjects {
 public:
  Subjects(boost::asio::io_context& io, AskDaemon ask) : ask_(std::move(ask)), worker_(io) {}
  /// Handles a path below /api/subjects/; the caller has checked that the user may see subjects.
  void handle(const HttpRequest& request, const Respond& respond);

 private:
  void make(v1::SubjectRecord subject, v1::ListProtocolsResponse protocols, const std::string& language, const Respond& respond);

  AskDaemon ask_;
  std::shared_ptr<bool> is_alive_ = std::make_shared<bool>(true);
  Worker worker_;  // last: its thread ends before the other members are destroyed
};

}  // namespace dts::gateway
