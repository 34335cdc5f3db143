// SPDX-License-Identifier: Apache-2.0
#include "lsl/marker_inlets.h"

#include <gtest/gtest.h>

#include <set>

namespace dts::lsl {
namespace {

TEST(MarkerRequest, SameMarker_HasTheSameId) {
  const ReceivedMarker marker{
      .stream_uid = "1f0c7a52-6e1d-4b7e-9a63-0a3c5d7e9b11", .stream_name = "Task", .text = "go", .sender_time_s = 12.5};
  ReceivedMarker again = marker;
  again.host_time_ns = 1;  // the estimate of the other clock may differ
  EXPECT_EQ(request_id(marker), request_id(again));
  EXPECT_LE(request_id(marker).size(), 64U);
}

TEST(MarkerRequest, OtherStreamTimeOrText_HasAnotherId) {
  const ReceivedMarker marker{
      .stream_uid = "1f0c7a52-6e1d-4b7e-9a63-0a3c5d7e9b11", .stream_name = "Task", .text = "go", .sender_time_s = 12.5};
  std::set<std::string> ids{request_id(marker)};
  ReceivedMarker other = marker;
  other.stream_uid.back() = '2';
  ids.insert(request_id(other));
  other = marker;
  other.sender_time_s += 1e-9;
  ids.insert(request_id(other));
  other = marker;
  other.text = "stop";
  ids.insert(request_id(other));
  EXPECT_EQ(ids.size(), 4U);
}

}  // namespace
}  // namespace dts::lsl
