// SPDX-License-Identifier: Apache-2.0
#include "dts/wire/event_json.h"

#include <google/protobuf/util/json_util.h>

#include <map>
#include <nlohmann/json.hpp>

namespace dts::wire {
namespace {

namespace util = google::protobuf::util;
using Json = nlohmann::ordered_json;

/// Sorts the keys of all maps. protobuf writes them in an order that changes from call to call, and recordings and exports of the same
/// event must have the same bytes.
void sort_maps(const google::protobuf::Descriptor& type, Json& object) {
  for (auto& [key, value] : object.items()) {
    const auto* field = type.FindFieldByName(key);
    if (field == nullptr || field->message_type() == nullptr) continue;
    if (field->is_map()) {
      const std::map<std::string, Json> sorted(value.get<std::map<std::string, Json>>());
      value = Json::object();
      for (const auto& [name, entry] : sorted) value[name] = entry;
    } else if (value.is_array()) {
      for (Json& element : value) sort_maps(*field->message_type(), element);
    } else {
      sort_maps(*field->message_type(), value);
    }
  }
}

}  // namespace

std::string to_json(const google::protobuf::Message& message) {
  util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  std::string text;
  if (!util::MessageToJsonString(message, &text, options).ok()) return {};
  Json json = Json::parse(text, nullptr, false);
  sort_maps(*message.GetDescriptor(), json);
  return json.dump();
}

std::optional<v1::Event> event_of_json(std::string_view text) {
  if (text.size() > kLongestEventJson || !Json::accept(text)) return std::nullopt;  // protobuf accepts more than JSON: {a:'b'}
  util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  v1::Event event;
  const bool is_read = util::JsonStringToMessage({text.data(), text.size()}, &event, options).ok();
  if (!is_read || event.body_case() == v1::Event::BODY_NOT_SET) return std::nullopt;
  return event;
}

}  // namespace dts::wire
