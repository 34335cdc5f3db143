// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

#include "board/fake_link.h"
#include "core/clock.h"
#include "device/board/board_device.h"

namespace dts::test {

/// A fake board of its own behind a link in memory.
class OwnedFakeLink final : public device::bytes::ByteLink {
 public:
  OwnedFakeLink(FakeBoardSetup setup, core::Clock& clock) : board_(std::move(setup), clock.now_ns()), link_(board_, clock) {}

  [[nodiscard]] FakeBoard& board() noexcept { return board_; }
  [[nodiscard]] FakeLink& link() noexcept { return link_; }

  [[nodiscard]] core::Status open() override { return link_.open(); }
  void close() noexcept override { link_.close(); }
  [[nodiscard]] device::bytes::BytesRead read(std::span<std::uint8_t> buffer, std::int64_t deadline_ns) noexcept override {
    return link_.read(buffer, deadline_ns);
  }
  [[nodiscard]] core::Status write(std::span<const std::uint8_t> bytes) override { return link_.write(bytes); }
  void interrupt() noexcept override { link_.interrupt(); }
  [[nodiscard]] bool has_arrived() noexcept override { return link_.has_arrived(); }
  [[nodiscard]] Facts facts() const override { return link_.facts(); }
  [[nodiscard]] std::string why_lost() const override { return link_.why_lost(); }
  [[nodiscard]] bool restarts_the_board() const noexcept override { return link_.restarts_the_board(); }

 private:
  FakeBoard board_;
  FakeLink link_;
};

/// Makes the device of an address "serial:...", "tcp:..." or "exec:...", with a fake board as the address says, behind a link in memory.
/// "gapping" in the name: it loses 70 scans after 0.5 s. "unplugging": it is unplugged after 0.5 s, for 1 s.
[[nodiscard]] std::unique_ptr<device::Device> make_fake_board_device(std::string_view uri, core::Clock& clock);

}  // namespace dts::test
