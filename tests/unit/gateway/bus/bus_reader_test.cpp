// SPDX-License-Identifier: Apache-2.0
#include "gateway/bus/bus_reader.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "unit/libdts/fake_daemon.h"

namespace dts::gateway {
namespace {

class BusReaderTest : public ::testing::Test {
 protected:
  /// What a message of that topic and instance became; null when it does not come.
  CarriedPointer wait_for(const std::string& topic, std::uint64_t instance_id) {
    CarriedPointer found;
    std::unique_lock lock(mutex_);
    static_cast<void>(came_.wait_for(lock, testing::kDeadline, [&] {
      for (const BusItem& item : items_) {
        const auto* carried = std::get_if<CarriedPointer>(&item);
        if (carried != nullptr && (*carried)->topic == topic && (*carried)->instance_id == instance_id) found = *carried;
      }
      return found != nullptr;
    }));
    return found;
  }

  testing::TemporaryDirectory directory_;
  std::string endpoint_ = directory_.endpoint("data.sock");
  testing::FakePublisher daemon_{endpoint_};
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<BusItem> items_;
  client::Result<std::unique_ptr<BusReader>> reader_ = BusReader::start(endpoint_, [this](BusItem item) {
    const std::lock_guard lock(mutex_);
    items_.push_back(std::move(item));
    came_.notify_all();
  });
};

TEST_F(BusReaderTest, EachMessageSaysWhichDaemonSaidItAlsoAfterARestart) {
  ASSERT_TRUE(reader_.has_value());
  ASSERT_TRUE(daemon_.wait_for_subscription("dtsd/status"));
  daemon_.send("dtsd/status", testing::floor_status(7));
  ASSERT_TRUE(daemon_.wait_for_subscription("floor/device"));
  v1::Event device = testing::marker("", 5, 7);
  device.mutable_device()->set_state(v1::DEVICE_STATE_STREAMING);
  daemon_.send("floor/device", device);

  const CarriedPointer state = wait_for("floor/device", 7);
  daemon_.send("dtsd/status", testing::floor_status(8));
  const CarriedPointer status = wait_for("dtsd/status", 8);

  ASSERT_TRUE(state != nullptr && status != nullptr);
  EXPECT_TRUE(state->is_retained);
  EXPECT_EQ(state->kind, Carried::Kind::Event);
  EXPECT_TRUE(status->is_retained);
  EXPECT_EQ(status->kind, Carried::Kind::Status);
}

}  // namespace
}  // namespace dts::gateway
