// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/log.h"
#include "core/result.h"
#include "fleet/link/link.h"

namespace dts::fleet::forward {

/// Answers wait here until they are read. Thread: one.
class Mailbox {
 public:
  Mailbox() = default;
  virtual ~Mailbox() = default;
  Mailbox(const Mailbox&) = delete;
  Mailbox& operator=(const Mailbox&) = delete;

  /// The subject to which answers must be sent.
  [[nodiscard]] virtual const std::string& address() const = 0;
  /// Returns nothing if none arrives within `timeout`. See link::Letter for that of a request without a listener.
  [[nodiscard]] virtual std::optional<link::Letter> next(std::chrono::milliseconds timeout) = 0;
};

/// The way to the centre. A seam: the tests have one without a server. Thread: any.
class Uplink {
 public:
  Uplink() = default;
  virtual ~Uplink() = default;
  Uplink(const Uplink&) = delete;
  Uplink& operator=(const Uplink&) = delete;

  [[nodiscard]] virtual bool is_connected() const = 0;
  /// Little waits to be written: for those who can send later or not at all.
  [[nodiscard]] virtual bool has_room() const = 0;
  /// Number of connections so far.
  [[nodiscard]] virtual std::uint64_t connections() const = 0;
  /// Why there is no connection; empty: there is one.
  [[nodiscard]] virtual std::string problem() const = 0;
  [[nodiscard]] virtual core::Status publish(const link::Letter& letter) = 0;
  /// For answers.
  [[nodiscard]] virtual core::Result<std::unique_ptr<Mailbox>> open_mailbox() = 0;
  /// For what the centre sends to a subject.
  [[nodiscard]] virtual core::Result<std::unique_ptr<Mailbox>> listen(const std::string& subject) = 0;
};

/// Opens a connection to the centre, see link::Link. Fails with InvalidArgument for wrong options.
[[nodiscard]] core::Result<std::unique_ptr<Uplink>> open_uplink(const link::LinkOptions& options, const core::Log& log);

/// Sends a request and waits for its answer. Fails with Unreachable while there is no connection or no hub, with Timeout, and with Failed
/// within 0.1 s after a stop is requested.
[[nodiscard]] core::Result<std::string> ask(Uplink& uplink, const std::string& subject, std::string_view data,
                                            std::chrono::milliseconds timeout, const std::stop_token& stop);

}  // namespace dts::fleet::forward
