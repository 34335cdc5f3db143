// SPDX-License-Identifier: Apache-2.0
// The bytes of a ZMTP peer, as libdts reads them: greeting, then frames; commands are split, READY is searched, PING is answered.
#include "dts/zmtp/zmtp.h"

#include "fuzz/fuzz_support.h"

namespace dts::fuzz::zmtp {
namespace {

namespace wire = dts::zmtp;

constexpr std::size_t kLimit = 1000;

std::string_view text(std::span<const std::byte> bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

void check_command(std::span<const std::byte> body) {
  const auto command = wire::command_of(body);
  if (!command) return;
  promise(1 + command->name.size() + command->data.size() == body.size(), "name and data are the whole command");
  if (const auto type = wire::property_of(command->data, "Socket-Type")) promise(type->size() <= body.size(), "a property is part of it");
  std::string pong;
  wire::append_pong(pong, command->data);
  promise(pong.size() <= 2 + 5 + 16, "an answer is no larger than a ping may be");
}

void check_frame(const wire::Frame& frame) {
  promise(frame.body.size() <= kLimit && frame.size > frame.body.size(), "a frame within the limit");
  if (frame.is_command) return check_command(frame.body);
  std::string again;
  wire::append_frame(again, text(frame.body), frame.has_more);
  const wire::FrameResult result = wire::next_frame(std::as_bytes(std::span(again)), kLimit);
  const auto* read = std::get_if<std::optional<wire::Frame>>(&result);
  promise(read != nullptr && *read && text((*read)->body) == text(frame.body) && (*read)->has_more == frame.has_more, "read as written");
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  std::span<const std::byte> rest = std::as_bytes(std::span(bytes, size));
  promise(!wire::fault_of_greeting(rest).empty() || wire::fault_of_greeting(rest.first(rest.size() / 2)).empty(), "a fault stays one");
  if (rest.size() >= wire::kGreetingBytes && wire::fault_of_greeting(rest).empty()) rest = rest.subspan(wire::kGreetingBytes);
  while (true) {
    const wire::FrameResult result = wire::next_frame(rest, kLimit);
    const auto* frame = std::get_if<std::optional<wire::Frame>>(&result);
    if (frame == nullptr || !*frame) return;
    promise((*frame)->size <= rest.size(), "a frame is part of the bytes");
    check_frame(**frame);
    rest = rest.subspan((*frame)->size);
  }
}

}  // namespace dts::fuzz::zmtp

DTS_FUZZ_TARGET(zmtp)
