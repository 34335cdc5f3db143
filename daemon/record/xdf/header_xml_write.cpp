// SPDX-License-Identifier: Apache-2.0
#include <pugixml.hpp>

#include "record/utf8_text.h"
#include "record/xdf/header_xml.h"
#include "record/xdf/number_text.h"

namespace dts::record {
namespace {

class TextWriter : public pugi::xml_writer {
 public:
  void write(const void* bytes, std::size_t size) override { text.append(static_cast<const char*>(bytes), size); }
  std::string text{};
};

void add(pugi::xml_node node, const char* name, const std::string& text) { node.append_child(name).text().set(clean_text(text).c_str()); }

void set(pugi::xml_node node, const char* name, const std::string& text) { node.append_attribute(name).set_value(text.c_str()); }

void add_facts(pugi::xml_node ours, const Facts& facts) {
  for (const auto& [fact_name, text] : facts) {
    pugi::xml_node node = ours.append_child("fact");
    set(node, "name", clean_text(fact_name));
    node.text().set(clean_text(text).c_str());
  }
}

std::string to_text(const pugi::xml_document& document) {
  TextWriter writer;
  document.save(writer, "", pugi::format_raw | pugi::format_no_declaration, pugi::encoding_utf8);
  std::string text = "<?xml version=\"1.0\"?>";
  for (const char character : writer.text) {
    // A bare carriage return reads back as a line feed (XML 1.0, 2.11), and pugixml does not escape it.
    if (character == '\r') {
      text += "&#13;";
    } else {
      text += character;
    }
  }
  return text;
}

void add_channel(pugi::xml_node channels, const ChannelInfo& channel) {
  pugi::xml_node node = channels.append_child("channel");
  add(node, "label", channel.label);
  add(node, "unit", channel.unit);
  add(node, "type", channel.type);
  if (channel.device_channel >= 0) add(node, "device_channel", std::to_string(channel.device_channel));
  if (channel.minimum != 0.0 || channel.maximum != 0.0 || channel.resolution != 0.0) {
    add(node, "minimum", shortest_text(channel.minimum));
    add(node, "maximum", shortest_text(channel.maximum));
    add(node, "resolution", shortest_text(channel.resolution));
  }
  if (channel.is_sensor) add(node, "is_sensor", "true");
  if (channel.is_marker) add(node, "is_marker", "true");
}

}  // namespace

std::string_view name(ValueType type) noexcept {
  switch (type) {
    case ValueType::Float32: return "float32";
    case ValueType::Double64: return "double64";
    case ValueType::Int8: return "int8";
    case ValueType::Int16: return "int16";
    case ValueType::Int32: return "int32";
    case ValueType::Int64: return "int64";
    case ValueType::Text: return "string";
  }
  return "undefined";
}

std::string file_header_xml(const Facts& facts) {
  pugi::xml_document document;
  pugi::xml_node info = document.append_child("info");
  add(info, "version", "1.0");
  add_facts(info.append_child("desc").append_child("dts"), facts);
  return to_text(document);
}

std::string stream_header_xml(const StreamInfo& info, const StreamOrigin& origin) {
  pugi::xml_document document;
  pugi::xml_node node = document.append_child("info");
  add(node, "name", info.name);
  add(node, "type", info.content);
  add(node, "channel_count", std::to_string(info.channels.size()));
  add(node, "nominal_srate", info.rate ? text_of_double(info.rate->hz()) : "0");
  add(node, "channel_format", std::string(name(info.value_type)));
  add(node, "source_id", info.name);
  add(node, "version", "1.0");
  add(node, "created_at", shortest_text(origin.created_at_s));
  add(node, "uid", origin.session_id + "/" + std::to_string(origin.stream));
  add(node, "session_id", origin.session_id);
  add(node, "hostname", "");  // empty: a file must not identify the clinic
  pugi::xml_node description = node.append_child("desc");
  pugi::xml_node channels = description.append_child("channels");
  for (const auto& channel : info.channels) add_channel(channels, channel);
  pugi::xml_node ours = description.append_child("dts");
  if (info.rate) {
    pugi::xml_node rate = ours.append_child("rate");
    set(rate, "numerator", std::to_string(info.rate->numerator()));
    set(rate, "denominator", std::to_string(info.rate->denominator()));
  }
  add(ours, "delay_ns", std::to_string(info.delay_ns));
  add_facts(ours, info.facts);
  return to_text(document);
}

std::string stream_footer_xml(const StreamSummary& summary) {
  pugi::xml_document document;
  pugi::xml_node info = document.append_child("info");
  if (summary.sample_count > 0) {
    add(info, "first_timestamp", text_of_double(summary.first_time_s));
    add(info, "last_timestamp", text_of_double(summary.last_time_s));
  }
  add(info, "sample_count", std::to_string(summary.sample_count));
  pugi::xml_node offsets = info.append_child("clock_offsets");
  for (const auto& [time_s, offset_s] : summary.clock_offsets) {
    pugi::xml_node offset = offsets.append_child("offset");
    add(offset, "time", text_of_double(time_s));
    add(offset, "value", text_of_double(offset_s));
  }
  add_facts(info.append_child("desc").append_child("dts"), summary.facts);
  return to_text(document);
}

}  // namespace dts::record
