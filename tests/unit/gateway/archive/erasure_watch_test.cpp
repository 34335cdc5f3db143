// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/erasure_watch.h"

#include <gtest/gtest.h>

#include "dts/v1/control.pb.h"

namespace dts::gateway {
namespace {

CarriedPointer status(std::uint64_t instance_id, std::uint64_t erasures) {
  v1::StatusSnapshot snapshot;
  snapshot.set_instance_id(instance_id);
  snapshot.set_erasures_total(erasures);
  return std::make_shared<const Carried>(
      Carried{.topic = "dtsd/status", .kind = Carried::Kind::Status, .bytes = snapshot.SerializeAsString()});
}

TEST(ErasureWatch, NoticesEachErasureAndEachRestart_Once) {
  ErasureWatch watch;
  EXPECT_FALSE(watch.has_erased(nullptr));
  EXPECT_FALSE(watch.has_erased(status(7, 3))) << "the first one: nothing is kept yet";
  EXPECT_FALSE(watch.has_erased(status(7, 3)));
  const CarriedPointer fourth = status(7, 4);
  EXPECT_TRUE(watch.has_erased(fourth));
  EXPECT_FALSE(watch.has_erased(fourth));
  EXPECT_TRUE(watch.has_erased(status(8, 0))) << "an erasure may have been completed at the start";
  EXPECT_FALSE(watch.has_erased(std::make_shared<const Carried>(Carried{.topic = "dtsd/status", .bytes = "\xff"})));
}

}  // namespace
}  // namespace dts::gateway
