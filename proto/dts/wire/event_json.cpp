// SPDX-License-Identifier: Apache-2.0
#include "dts/wire/event_json.h"

#include <google/protobuf/util/json_util.h>

namespace dts::wire {

namespace util = google::protobuf::util;

std::string to_json(const google::protobuf::Message& message) {
  util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  std::string text;
  if (!util::MessageToJsonString(message, &text, options).ok()) text.clear();
  return text;
}

std::optional<v1::Event> event_of_json(std::string_view text) {
  if (text.size() > kLongestEventJson) return std::nullopt;
  util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  v1::Event event;
  const bool is_read = util::JsonStringToMessage({text.data(), text.size()}, &event, options).ok();
  if (!is_read || event.body_case() == v1::Event::BODY_NOT_SET) return std::nullopt;
  return event;
}

}  // namespace dts::wire
