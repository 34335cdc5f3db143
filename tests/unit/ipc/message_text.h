// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <string>

namespace dts::ipc {

/// All fields of a message on one line: a field that is missing, swapped or wrong shows.
inline std::string text(const google::protobuf::Message& message) {
  google::protobuf::TextFormat::Printer printer;
  printer.SetSingleLineMode(true);
  printer.SetUseShortRepeatedPrimitives(true);
  std::string out;
  EXPECT_TRUE(printer.PrintToString(message, &out));
  while (out.ends_with(' ')) out.pop_back();
  return out;
}

template <class Message>
Message message_of(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

}  // namespace dts::ipc
