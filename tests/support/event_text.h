// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <string>

#include "dts/v1/stream.pb.h"

namespace dts::test {

/// The event that a text in protobuf's form says: "segment: 1 scan: 20 marker { text: 'hello' }".
inline v1::Event event_of(const std::string& text) {
  v1::Event event;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &event)) << text;
  return event;
}

}  // namespace dts::test
