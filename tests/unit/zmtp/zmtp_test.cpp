// SPDX-License-Identifier: Apache-2.0
#include "dts/zmtp/zmtp.h"

#include <gmock/gmock.h>

#include <string>
#include <tuple>
#include <vector>

namespace dts::zmtp {
namespace {

using testing::HasSubstr;

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }
std::string text_of(std::span<const std::byte> bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// "frame", "command" or "more" with its body; "incomplete"; or what is wrong.
std::string described(const std::string& bytes, std::size_t limit = 1000) {
  const FrameResult result = next_frame(bytes_of(bytes), limit);
  if (const auto* fault = std::get_if<std::string_view>(&result)) return std::string(*fault);
  const auto& frame = std::get<std::optional<Frame>>(result);
  if (!frame) return "incomplete";
  return std::string(frame->is_command ? "command "
                     : frame->has_more ? "more "
                                       : "frame ") +
         text_of(frame->body) + ", " + std::to_string(frame->size);
}

TEST(Greeting, OfThisLibrary_IsThatOfTheSpecification) {
  std::string expected = "\xff" + std::string(8, '\0') + "\x7f" + "\x03" + std::string(1, '\0') + "NULL";
  expected.resize(kGreetingBytes, '\0');
  EXPECT_EQ(greeting(), expected);
}

TEST(Greeting, OfAPeer_IsAcceptedOrItsFirstFaultIsFoundAsSoonAsItIsThere) {
  std::string libzmq = greeting();
  libzmq[8] = 1;   // libzmq 4.3 writes a length here
  libzmq[11] = 1;  // and speaks 3.1
  EXPECT_EQ(fault_of_greeting(bytes_of(libzmq)), "");
  for (const auto& [place, byte, fault] : std::vector<std::tuple<std::size_t, char, const char*>>{{0, 'H', "does not speak ZMTP"},
                                                                                                  {9, '\0', "does not speak ZMTP"},
                                                                                                  {10, 1, "older ZMTP"},
                                                                                                  {12, 'C', "another mechanism"},
                                                                                                  {16, 'X', "another mechanism"},
                                                                                                  {31, 'X', "another mechanism"}}) {
    std::string wrong = libzmq;
    wrong[place] = byte;
    EXPECT_THAT(std::string(fault_of_greeting(bytes_of(wrong))), HasSubstr(fault)) << place;
    EXPECT_EQ(fault_of_greeting(bytes_of(wrong.substr(0, place))), "") << place;
    EXPECT_NE(fault_of_greeting(bytes_of(wrong.substr(0, place + 1))), "") << place;
  }
}

TEST(Frame, WrittenFrames_AreReadBack) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{255}, std::size_t{256}, std::size_t{70'000}}) {
    const std::string body(size, 'x');
    for (const bool has_more : {false, true}) {
      std::string bytes;
      append_frame(bytes, body, has_more);
      EXPECT_EQ(bytes.size(), size + (size > 255 ? 9 : 2));
      EXPECT_EQ(described(bytes + "rest", size), (has_more ? "more " : "frame ") + body + ", " + std::to_string(bytes.size()));
      EXPECT_EQ(described(bytes, size - 1), size > 0 ? "a frame that is too long" : described(bytes)) << size;
    }
  }
  std::string command;
  append_command(command, "PING", "12");
  EXPECT_EQ(described(command), "command \x04PING12, 9");
}

TEST(Frame, EveryBeginning_IsIncomplete) {
  std::string bytes;
  append_frame(bytes, std::string(300, 'x'));
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_EQ(described(bytes.substr(0, size)), "incomplete") << size;
}

TEST(Frame, WrongFlags_AreFaults) {
  for (int flags = 0; flags < 256; ++flags) {
    const std::string bytes = std::string(1, static_cast<char>(flags)) + std::string(9, '\0');
    const bool is_known = flags < 8 && flags != 5 && flags != 7;  // no command is continued
    EXPECT_EQ(described(bytes) == "a frame with flags that ZMTP does not know", !is_known) << flags;
  }
}

TEST(Frame, AnnouncedGigabytes_AreRefusedBeforeTheyArrive) {
  RecordProperty("requirement", "SEC-9");
  EXPECT_EQ(described(std::string("\x02\xff\xff\xff\xff\xff\xff\xff\xff", 9)), "a frame that is too long");
  EXPECT_EQ(described(std::string("\x02\x00\x00\x00\x00\x00\x00\x03\xe9", 9)), "a frame that is too long");
  EXPECT_EQ(described(std::string("\x02\x00\x00\x00\x00\x00\x00\x03\xe8", 9)), "incomplete");
}

TEST(Command, BodiesOfEveryShape_AreSplitOrRefused) {
  const auto split = [](const std::string& body) {
    const auto command = command_of(bytes_of(body));
    return command ? std::string(command->name) + "|" + std::string(command->data) : "none";
  };
  EXPECT_EQ(split("\x05READY!"), "READY|!");
  EXPECT_EQ(split("\x05READY"), "READY|");
  EXPECT_EQ(split("\x05READ"), "none");
  EXPECT_EQ(split(std::string(1, '\0') + "x"), "none");
  EXPECT_EQ(split("\xff"), "none");
  EXPECT_EQ(split(""), "none");
}

TEST(Command, PropertiesOfReady_AreFoundByTheirNameAndDamagedOnesAreNot) {
  std::string ready;
  append_ready(ready, "SUB");
  const FrameResult frame = next_frame(bytes_of(ready), 100);
  const auto command = command_of(std::get<std::optional<Frame>>(frame)->body);
  ASSERT_TRUE(command);
  EXPECT_EQ(command->name, "READY");
  EXPECT_EQ(property_of(command->data, "socket-type"), "SUB");
  const std::string two = std::string("\x08Identity\0\0\0\0", 13) + std::string(command->data);
  EXPECT_EQ(property_of(two, "Socket-Type"), "SUB");
  EXPECT_EQ(property_of(two, "IDENTITY"), "");
  EXPECT_EQ(property_of(two, "Resource"), std::nullopt);
  for (std::size_t size = 0; size < two.size(); ++size) EXPECT_EQ(property_of(two.substr(0, size), "Socket-Type"), std::nullopt) << size;
  EXPECT_EQ(property_of(std::string("\0\0\0\0\0\0", 6), ""), std::nullopt);
  EXPECT_EQ(property_of(std::string("\x01x\xff\xff\xff\xff", 6), "x"), std::nullopt);
}

TEST(Command, Ping_IsAnsweredWithItsContext) {
  const auto pong = [](std::string_view ping) {
    std::string out;
    append_pong(out, ping);
    return out;
  };
  EXPECT_EQ(pong(std::string("\0\x0a", 2) + "context"), "\x04\x0c\x04PONGcontext");
  EXPECT_EQ(pong(std::string("\0\x0a", 2)), std::string("\x04\x05\x04PONG", 7));
  EXPECT_EQ(pong("x"), "") << "no time to live";
  EXPECT_EQ(pong(std::string(2 + 16, 'x')).size(), 2U + 5U + 16U);
  EXPECT_EQ(pong(std::string(2 + 17, 'x')), "") << "a context has at most 16 bytes";
}

}  // namespace
}  // namespace dts::zmtp
