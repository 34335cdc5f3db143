// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <string_view>

#include "core/clock.h"
#include "core/descriptor.h"
#include "core/doorbell.h"
#include "device/bytes/byte_link.h"

namespace dts::device::bytes {

/// The common part of all links: waits for bytes on a non-blocking descriptor, writes with a time limit, remembers how the link ended.
class DescriptorLink : public ByteLink {
 public:
  [[nodiscard]] BytesRead read(std::span<std::uint8_t> buffer, std::int64_t deadline_ns) noexcept final;
  [[nodiscard]] core::Status write(std::span<const std::uint8_t> bytes) final;
  void interrupt() noexcept final { bell_.ring(); }

 protected:
  /// The descriptors of an open link.
  struct Ends {
    core::Descriptor in;       ///< Non-blocking.
    core::Descriptor out{-1};  ///< Non-blocking; negative: `in` has both directions.
    core::Descriptor end{-1};  ///< Becomes readable when the other end has ended (a pidfd); negative: `in` shows it.
    bool out_is_socket = false;
  };

  /// `name`: the link in messages, "serial port /dev/ttyACM0". `clock` must outlive the link.
  DescriptorLink(std::string name, core::Clock& clock) : clock_(clock), name_(std::move(name)) {}

  void attach(Ends ends) noexcept;
  void detach() noexcept { ends_.reset(); }
  [[nodiscard]] bool is_open() const noexcept { return ends_.has_value(); }
  [[nodiscard]] int in() const noexcept { return ends_ ? ends_->in.get() : -1; }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  /// Returns how the link was lost: an errno, or 0 if the other end closed it; nothing if it was not lost. Valid until `attach`.
  /// Thread: any.
  [[nodiscard]] std::optional<int> lost() const noexcept;
  [[nodiscard]] core::Clock& clock() const noexcept { return clock_; }

 private:
  [[nodiscard]] BytesRead lose(int system_errno) noexcept;

  core::Clock& clock_;
  std::string name_;
  core::Doorbell bell_;
  std::optional<Ends> ends_;
  std::atomic<int> lost_{kNotLost};

  static constexpr int kNotLost = -1;
};

}  // namespace dts::device::bytes
