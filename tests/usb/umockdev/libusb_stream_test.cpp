// SPDX-License-Identifier: Apache-2.0
// Streams through unmodified libusb, in lock-step: nothing here depends on how fast the machine is.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "device/usb/bulk_stream.h"
#include "usb/umockdev/usb_fixture.h"

namespace dts::emulator {
namespace {

using device::usb::BulkStream;
using device::usb::Chunk;
using device::usb::UsbStatus;

constexpr int kStopMs = 60'000;
constexpr int kTransfers = 8;
constexpr std::size_t kTransferBytes = 256;  // four packets
constexpr device::usb::StreamShape kShape{
    .endpoint = 0x81, .transfer_bytes = kTransferBytes, .transfer_count = kTransfers, .buffer_chunks = 1024};  // the device does not wait

class LibusbStreamTest : public UsbFixture {
 protected:
  void begin() {
    host_.plug(device_);
    ASSERT_TRUE(eventually([&] { return units().size() == 1; }));
    port_ = open_port();
    start();
  }
  void start() {
    expected_ = 0;
    stream_ = BulkStream::create(*port_, kShape, clock_).value();
    ASSERT_EQ(stream_->start(), UsbStatus::Completed);
    ASSERT_TRUE(port_->control_out({CountingDevice::kStart}, {}, kTimeoutMs));
  }
  [[nodiscard]] Chunk* next_chunk() {
    static_cast<void>(eventually([&] {
      if (stream_->front() == nullptr) port_->wait(clock_.now_ns() + 50 * core::kNanosecondsPerMillisecond);
      return stream_->front() != nullptr;
    }));
    return stream_->front();
  }
  /// Codes of the next completed chunks that are not what was sent; stops at a chunk with another status.
  [[nodiscard]] int wrong_codes(std::size_t chunk_count) {
    int wrong = 0;
    for (std::size_t i = 0; i < chunk_count; ++i) {
      Chunk* chunk = next_chunk();
      if (chunk == nullptr || chunk->status != UsbStatus::Completed) return ++wrong;
      for (std::size_t at = 0; at + 1 < chunk->length; at += 2) {
        wrong += static_cast<std::uint16_t>(chunk->bytes[at] | chunk->bytes[at + 1] << 8) == expected_ ? 0 : 1;
        ++expected_;
      }
      stream_->release();
    }
    return wrong;
  }
  /// Reads until a chunk ends otherwise than `Completed`.
  [[nodiscard]] std::optional<UsbStatus> next_trouble() {
    while (Chunk* chunk = next_chunk()) {
      const UsbStatus status = chunk->status;
      stream_->release();
      if (status != UsbStatus::Completed) return status;
    }
    return std::nullopt;
  }
  void make_trouble(CountingDevice::Trouble trouble) {
    host_.locked(device_, [&] { device_.trouble = trouble; });
  }
  void end() {
    EXPECT_TRUE(stream_->stop(kStopMs));
    EXPECT_EQ(stream_->in_flight(), 0);
    stream_.reset();
  }

  std::unique_ptr<device::usb::UsbPort> port_;
  std::unique_ptr<BulkStream> stream_;
  std::uint16_t expected_ = 0;
};

TEST_F(LibusbStreamTest, EveryCodeArrivesOnceAndInOrder) {
  begin();

  EXPECT_EQ(wrong_codes(500), 0);

  EXPECT_EQ(stream_->dropped(), 0U);
  end();
}

TEST_F(LibusbStreamTest, StampsNeverGoBack) {
  begin();
  std::int64_t newest_ns = 0;
  for (int i = 0; i < 50; ++i) {
    Chunk* chunk = next_chunk();
    ASSERT_NE(chunk, nullptr);
    EXPECT_GE(chunk->stamp_ns, newest_ns);
    EXPECT_LE(chunk->stamp_ns, clock_.raw_ns());
    newest_ns = chunk->stamp_ns;
    stream_->release();
  }
  end();
}

TEST_F(LibusbStreamTest, AShortPacketEndsItsTransferAndTheStreamGoesOn) {
  begin();
  ASSERT_EQ(wrong_codes(20), 0);

  make_trouble(CountingDevice::Trouble::Short);

  bool was_short = false;
  for (int i = 0; i < 40 && !was_short; ++i) {
    Chunk* chunk = next_chunk();
    ASSERT_NE(chunk, nullptr);
    ASSERT_EQ(chunk->status, UsbStatus::Completed);
    was_short = chunk->length < kTransferBytes;
    stream_->release();
  }
  EXPECT_TRUE(was_short);
  EXPECT_NE(next_chunk(), nullptr);
  end();
}

TEST_F(LibusbStreamTest, AStallEndsAllTransfersAndTheStreamWorksAgainAfterClearing) {
  begin();
  ASSERT_EQ(wrong_codes(20), 0);

  make_trouble(CountingDevice::Trouble::Stall);

  EXPECT_EQ(next_trouble(), UsbStatus::Stall);
  EXPECT_TRUE(eventually([&] { return stream_->in_flight() == 0; }));
  end();
  EXPECT_TRUE(port_->clear_halt(0x81));
  host_.locked(device_, [&] { EXPECT_EQ(device_.halts_cleared, 1U); });
  ASSERT_TRUE(port_->control_out({CountingDevice::kStop}, {}, kTimeoutMs));  // or it goes on where it halted
  start();
  EXPECT_EQ(wrong_codes(20), 0);
  end();
}

TEST_F(LibusbStreamTest, BabbleIsAnOverflow) {
  begin();

  make_trouble(CountingDevice::Trouble::Babble);

  EXPECT_EQ(next_trouble(), UsbStatus::Overflow);
  end();
}

TEST_F(LibusbStreamTest, ABadCableIsAFailure) {
  begin();
  ASSERT_EQ(wrong_codes(20), 0);

  host_.locked(device_, [&] { device_.is_mute = true; });
  ASSERT_TRUE(eventually([&] {  // there are transfers to end, and room to tell of it
    while (stream_->front() != nullptr) stream_->release();
    return host_.urbs_in_flight(device_) == kTransfers;
  }));
  host_.end_transfers(device_, UsbStatus::Failed);  // -EPROTO

  EXPECT_EQ(next_trouble(), UsbStatus::Failed);
  end();
}

TEST_F(LibusbStreamTest, StoppingASilentDeviceCancelsEverything) {
  begin();
  host_.locked(device_, [&] { device_.is_mute = true; });
  ASSERT_TRUE(eventually([&] { return host_.urbs_in_flight(device_) == kTransfers; }));

  end();

  EXPECT_EQ(host_.urbs_in_flight(device_), 0U);
}

TEST_F(LibusbStreamTest, AWaitOnASilentDeviceEndsAtItsDeadlineAndNotBefore) {
  begin();
  host_.locked(device_, [&] { device_.is_mute = true; });
  ASSERT_TRUE(eventually([&] {
    while (stream_->front() != nullptr) stream_->release();
    return host_.urbs_in_flight(device_) == kTransfers && stream_->front() == nullptr;
  }));
  // Two waits may end early: one by the rings of earlier transfers, one by the ring of the last, which follows its new submission.
  std::int64_t deadline_ns = 0;
  for (int wait = 0; wait < 3 && (wait == 0 || clock_.now_ns() < deadline_ns); ++wait) {
    deadline_ns = clock_.now_ns() + 20 * core::kNanosecondsPerMillisecond;
    port_->wait(deadline_ns);
  }

  EXPECT_GE(clock_.now_ns(), deadline_ns);
  end();
}

TEST_F(LibusbStreamTest, UnpluggingEndsAllTransfersWithNoDevice) {
  begin();
  ASSERT_EQ(wrong_codes(20), 0);

  host_.unplug(device_);

  EXPECT_EQ(next_trouble(), UsbStatus::NoDevice);
  EXPECT_TRUE(eventually([&] { return stream_->in_flight() == 0; }));
  EXPECT_EQ(port_->submit(0), UsbStatus::NoDevice);
  end();
}

TEST_F(LibusbStreamTest, UnpluggingWhileStoppingEndsCleanly) {
  for (int round = 0; round < 10; ++round) {
    begin();
    ASSERT_NE(next_chunk(), nullptr);
    std::thread hand([&] { host_.unplug(device_); });
    EXPECT_TRUE(stream_->stop(kStopMs)) << "round " << round;
    hand.join();
    stream_.reset();
    port_.reset();
    ASSERT_TRUE(eventually([&] { return units().empty(); }));
  }
}

TEST_F(LibusbStreamTest, TwentyUnplugsInMidStreamLoseNothingButTheStream) {
  for (int cycle = 0; cycle < 20; ++cycle) {
    begin();
    EXPECT_EQ(wrong_codes(5), 0) << "cycle " << cycle;
    host_.unplug(device_);
    EXPECT_EQ(next_trouble(), UsbStatus::NoDevice) << "cycle " << cycle;
    end();
    port_.reset();
    ASSERT_TRUE(eventually([&] { return units().empty(); }));
  }
}

TEST_F(LibusbStreamTest, ASuspendedMachineEndsTheStreamAndTheDeviceIsThereAfterwards) {
  begin();
  ASSERT_EQ(wrong_codes(5), 0);

  host_.suspend(device_);

  EXPECT_EQ(next_trouble(), UsbStatus::NoDevice);
  end();
  port_.reset();
  ASSERT_TRUE(eventually([&] {
    const auto found = units();
    return found.size() == 1 && found[0].address == 3;
  }));
  port_ = open_port();
  start();
  EXPECT_EQ(wrong_codes(5), 0);
  end();
}

TEST_F(LibusbStreamTest, RequestsAreAnsweredWhileAStreamRuns) {
  begin();
  std::array<std::uint8_t, 4> bytes{};
  for (int i = 0; i < 50; ++i) {
    EXPECT_TRUE(port_->control_in({CountingDevice::kEcho}, bytes, kTimeoutMs));
    EXPECT_EQ(wrong_codes(2), 0);
  }
  end();
}

TEST_F(LibusbStreamTest, TwoDevicesStreamSideBySide) {
  CountingDevice second("SN0002");
  begin();
  host_.plug(second);
  ASSERT_TRUE(eventually([&] { return units().size() == 2; }));
  const auto other_port = open_port(1);
  auto other = BulkStream::create(*other_port, kShape, clock_).value();
  ASSERT_EQ(other->start(), UsbStatus::Completed);
  ASSERT_TRUE(other_port->control_out({CountingDevice::kStart}, {}, kTimeoutMs));

  EXPECT_EQ(wrong_codes(100), 0);
  EXPECT_TRUE(eventually([&] { return other->front() != nullptr; }));

  EXPECT_TRUE(other->stop(kStopMs));
  other.reset();
  end();
  host_.unplug(second);
}

TEST_F(LibusbStreamTest, AReaderThatIsTooSlowIsToldHowMuchFoundNoRoom) {
  begin();

  EXPECT_TRUE(eventually([&] { return stream_->dropped() > 0; }));

  end();
}

}  // namespace
}  // namespace dts::emulator
