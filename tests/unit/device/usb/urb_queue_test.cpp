// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/urb_queue.h"

#include <gtest/gtest.h>

#include <deque>
#include <limits>
#include <utility>

namespace dts::emulator {
namespace {

using device::usb::UsbStatus;

/// Hands out the packets that the test put in.
class PacketList final : public EmulatedDevice {
 public:
  std::deque<Packet> packets;
  void add(std::size_t bytes) { packets.push_back({false, std::vector<std::uint8_t>(bytes, ++fill_)}); }

  const Descriptors& descriptors() const override { return descriptors_; }
  void power_up(std::int64_t) override {}
  ControlReply control(const Setup&, std::span<const std::uint8_t>, std::int64_t) override { return {}; }
  void bulk_out(std::uint8_t, std::span<const std::uint8_t>, std::int64_t) override {}
  std::optional<Packet> take_packet(std::uint8_t, std::int64_t) override {
    if (packets.empty()) return std::nullopt;
    Packet packet = std::move(packets.front());
    packets.pop_front();
    return packet;
  }
  void clear_halt(std::uint8_t) override {}
  std::int64_t next_packet_ns(std::int64_t) const override { return std::numeric_limits<std::int64_t>::max(); }

 private:
  Descriptors descriptors_;
  std::uint8_t fill_ = 0;
};

class UrbQueueTest : public testing::Test {
 protected:
  std::vector<FinishedUrb> advance() { return queue_.advance(device_, 0); }

  PacketList device_;
  UrbQueue queue_{0x81, 64};
};

TEST_F(UrbQueueTest, TransferEndsWhenFullOrWithAShortOrEmptyPacket) {
  device_.add(64);
  EXPECT_TRUE(advance().empty());
  EXPECT_EQ(device_.packets.size(), 1U) << "no transfer waits: it stays in the device";
  for (const std::uint64_t id : {1U, 3U, 4U}) queue_.submit(id, 128);
  for (const std::size_t bytes : {64U, 64U, 10U, 0U}) device_.add(bytes);

  const auto finished = advance();

  ASSERT_EQ(finished.size(), 3U);
  EXPECT_EQ(finished[0].id, 1U);
  EXPECT_EQ(finished[0].bytes.size(), 128U);
  EXPECT_EQ(finished[0].bytes[127], 2);
  EXPECT_EQ(finished[1].id, 3U);
  EXPECT_EQ(finished[1].bytes.size(), 74U);
  EXPECT_EQ(finished[1].bytes[0], 3);
  EXPECT_EQ(finished[2].bytes.size(), 0U);
  EXPECT_EQ(finished[2].status, UsbStatus::Completed);
  EXPECT_FALSE(queue_.is_waiting());
}

TEST_F(UrbQueueTest, Stall_AllWaitingStallUntilCleared) {
  queue_.submit(1, 128);
  queue_.submit(2, 128);
  device_.add(64);
  device_.packets.push_back({true, {}});
  device_.add(64);

  const auto finished = advance();
  ASSERT_EQ(finished.size(), 2U);
  EXPECT_EQ(finished[0].status, UsbStatus::Stall);
  EXPECT_EQ(finished[0].bytes.size(), 64U);
  EXPECT_EQ(finished[1].status, UsbStatus::Stall);

  queue_.submit(3, 64);
  EXPECT_EQ(advance().front().status, UsbStatus::Stall);
  queue_.clear_halt();
  queue_.submit(4, 64);
  EXPECT_EQ(advance().front().status, UsbStatus::Completed);
}

TEST_F(UrbQueueTest, PacketThatDoesNotFitOrIsTooLong_Overflow) {
  queue_.submit(1, 32);
  queue_.submit(2, 128);
  device_.add(64);
  device_.add(66);

  const auto finished = advance();

  ASSERT_EQ(finished.size(), 2U);
  EXPECT_EQ(finished[0].status, UsbStatus::Overflow);
  EXPECT_EQ(finished[0].bytes.size(), 32U);
  EXPECT_EQ(finished[1].status, UsbStatus::Overflow);
}

TEST_F(UrbQueueTest, CancelOrEndAll_WithTheStatusAndWhatItHeld) {
  for (const std::uint64_t id : {1U, 2U, 3U}) queue_.submit(id, 128);
  device_.add(64);
  ASSERT_TRUE(advance().empty());

  const auto cancelled = queue_.cancel(1);

  ASSERT_TRUE(cancelled.has_value());
  EXPECT_EQ(cancelled->status, UsbStatus::Cancelled);
  EXPECT_EQ(cancelled->bytes.size(), 64U);
  EXPECT_FALSE(queue_.cancel(1).has_value());
  const auto finished = queue_.end_all(UsbStatus::NoDevice);
  ASSERT_EQ(finished.size(), 2U);
  EXPECT_EQ(finished[1].status, UsbStatus::NoDevice);
  EXPECT_FALSE(queue_.is_waiting());
}

}  // namespace
}  // namespace dts::emulator
