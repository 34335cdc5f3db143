// SPDX-License-Identifier: Apache-2.0
// What a server sends to a link. However the bytes are cut, the operations are the same, and no letter is larger than it may be.
#include <string>
#include <vector>

#include "fleet/link/protocol.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::link {
namespace {

namespace link = dts::fleet::link;

void check_info(std::string_view json) {
  const auto info = link::info_of_json(json);
  promise(info ? info->max_payload <= link::kLargestMessage : info.error().code == core::ErrorCode::DataDamaged, "a limit or a reason");
}

void check_operation(const link::Operation& operation) {
  const bool is_message = operation.kind == link::Operation::Kind::Message;
  promise(is_message != operation.letter.subject.empty(), "only a message has a letter, and that has a subject");
  promise(operation.letter.data.size() <= link::kLargestMessage, "a letter within the limit");
  promise(operation.text.size() <= link::kLargestLine, "a text within the limit");
  if (operation.kind == link::Operation::Kind::Info) check_info(operation.text);
}

/// What the operations say, one after the other, and whether they end with an error.
std::vector<std::string> operations_of(std::string_view bytes, std::size_t size) {
  link::Parser parser;
  std::vector<std::string> found;
  for (std::size_t begin = 0; begin < bytes.size(); begin += size) {
    parser.append(bytes.substr(begin, size));
    while (true) {
      const auto operation = parser.next();
      if (!operation) {
        promise(operation.error().code == core::ErrorCode::DataDamaged && !operation.error().what.empty(), "a reason");
        found.emplace_back("failed");
        return found;
      }
      if (!*operation) break;
      check_operation(**operation);
      const link::Letter& letter = (*operation)->letter;
      found.push_back(std::to_string(static_cast<int>((*operation)->kind)) + " " + std::to_string((*operation)->subscription) + " " +
                      letter.subject + " " + letter.reply + (letter.has_no_listener ? " 503 " : " ") + letter.data + (*operation)->text);
    }
  }
  return found;
}

}  // namespace

/// [bytes in a piece][what the server sends]
void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0 || size > link::kLargestLine) return;  // a longer line is an error only in pieces
  const std::string text = text_of(bytes + 1, size - 1);
  check_info(text);
  promise(operations_of(text, text.size() + 1) == operations_of(text, 1U + *bytes), "operations in pieces are the same");
}

}  // namespace dts::fuzz::link

DTS_FUZZ_TARGET(link)
