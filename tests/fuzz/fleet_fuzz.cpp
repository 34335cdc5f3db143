// SPDX-License-Identifier: Apache-2.0
// Messages between a clinic and the centre, and their subjects. What is accepted is within its limits, and the same when written and read.
#include <google/protobuf/stubs/logging.h>
#include <google/protobuf/util/message_differencer.h>

#include <limits>

#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::fleet {
namespace {

namespace wire = dts::fleet::wire;

template <class Decode>
auto check(Decode decode, std::string_view bytes) {
  const auto message = decode(bytes);
  if (!message) {
    promise(message.error().code == core::ErrorCode::DataDamaged && !message.error().what.empty(), "a reason");
    return message;
  }
  const auto again = decode(message->SerializeAsString());
  promise(again && google::protobuf::util::MessageDifferencer::Equals(*again, *message), "the message read is the one written");
  return message;
}

void check_subject(std::string_view text) {
  const auto subject = wire::parse_subject(text);
  if (!subject) return;
  promise(wire::is_clinic_name(subject->clinic), "a valid clinic");
  promise(wire::to_text(*subject) == text, "the subject read is the one written");
  promise(!wire::is_inbox_of(subject->clinic, text), "no subject is an inbox");
}

}  // namespace

/// [which message][bytes], or [12][subject].
void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  google::protobuf::SetLogHandler(nullptr);  // what is no UTF-8 is no news here
  if (size == 0) return;
  const std::string text = text_of(bytes + 1, size - 1);
  switch (*bytes % 13) {
    case 0: {
      const auto offer = check(wire::decode_offer, text);
      promise(!offer || (offer->sha256().size() == wire::kSha256Bytes && offer->bytes() <= wire::kLargestFile), "limits of an offer");
      break;
    }
    case 1: {
      const auto chunk = check(wire::decode_chunk, text);
      promise(!chunk || (chunk->data().size() <= wire::kLargestChunk && chunk->offset() <= wire::kLargestFile), "limits of a chunk");
      break;
    }
    case 2: static_cast<void>(check(wire::decode_commit, text)); break;
    case 3: static_cast<void>(check(wire::decode_upload_answer, text)); break;
    case 4: {
      const auto session = check(wire::decode_session, text);
      promise(!session || session->revision() <= std::numeric_limits<std::int64_t>::max(), "a revision that the database can hold");
      break;
    }
    case 5: static_cast<void>(check(wire::decode_facts_answer, text)); break;
    case 6: static_cast<void>(check(wire::decode_erase, text)); break;
    case 7: static_cast<void>(check(wire::decode_erase_answer, text)); break;
    case 8: static_cast<void>(check(wire::decode_beat, text)); break;
    case 9: static_cast<void>(check(wire::decode_beat_answer, text)); break;
    case 10: static_cast<void>(check(wire::decode_live_request, text)); break;
    case 11: static_cast<void>(check(wire::decode_live_answer, text)); break;
    default: check_subject(text); break;
  }
}

}  // namespace dts::fuzz::fleet

DTS_FUZZ_TARGET(fleet)
