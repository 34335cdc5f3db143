// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <pugixml.hpp>

#include "record/damaged.h"
#include "record/utf8_text.h"
#include "record/xdf/byte_codec.h"
#include "record/xdf/header_xml.h"
#include "record/xdf/number_text.h"

namespace dts::record {
namespace {

constexpr double kRateTolerance =
    1e-9;  ///< Largest relative difference between the exact rate and nominal_srate: allows only rounding of 17 digits.

std::string_view trimmed(std::string_view text) noexcept {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

std::string text_of_child(pugi::xml_node node, const char* name) { return clean_text(node.child(name).text().get()); }

/// Reads the number in a child node. Leaves `number` unchanged if the node is absent or empty. Fails if the text is no number.
template <class Number>
core::Status read_number(pugi::xml_node node, const char* name, std::optional<Number>& number) {
  const std::string_view text = trimmed(node.child(name).text().get());
  if (text.empty()) return {};
  number = number_of<Number>(text);
  if (!number) return core::fail(kDamaged, std::string("<") + name + "> is not a number: '" + clean_text(text.substr(0, 40)) + "'");
  return {};
}

core::Result<pugi::xml_node> parse(pugi::xml_document& document, std::string_view xml) {
  if (xml.size() > kMaxXmlBytes) return core::fail(kDamaged, "XML of " + std::to_string(xml.size()) + " bytes; at most 8 MiB are allowed");
  constexpr unsigned kOptions = pugi::parse_default | pugi::parse_ws_pcdata_single;  // a fact may be a single space
  const auto result = document.load_buffer(xml.data(), xml.size(), kOptions, pugi::encoding_utf8);
  if (!result) return core::fail(kDamaged, std::string("not XML: ") + result.description());
  const pugi::xml_node info = document.child("info");
  if (!info) return core::fail(kDamaged, "XML without <info>");
  return info;
}

Facts facts_of(pugi::xml_node description) {
  Facts facts;
  for (const pugi::xml_node node : description.child("dts").children("fact"))
    facts.emplace_back(clean_text(node.attribute("name").value()), clean_text(node.text().get()));
  for (const pugi::xml_node node : description.children())
    if (std::string_view(node.name()) != "dts" && !node.text().empty())
      facts.emplace_back(clean_text(node.name()), clean_text(node.text().get()));
  return facts;
}

core::Result<ValueType> type_of(pugi::xml_node info) {
  constexpr std::array kTypes = {ValueType::Float32, ValueType::Double64, ValueType::Int8, ValueType::Int16,
                                 ValueType::Int32,   ValueType::Int64,    ValueType::Text};
  const std::string_view text = trimmed(info.child("channel_format").text().get());
  for (const ValueType type : kTypes)
    if (name(type) == text) return type;
  return core::fail(kDamaged, "unknown channel_format '" + clean_text(text.substr(0, 40)) + "'");
}

core::Result<core::Rate> exact_rate(pugi::xml_node node, double nominal_hz) {
  const auto numerator = number_of<std::int64_t>(node.attribute("numerator").value());
  const auto denominator = number_of<std::int64_t>(node.attribute("denominator").value());
  const auto rate = core::Rate::create(numerator.value_or(0), denominator.value_or(0));
  if (!rate || !(std::abs(rate->hz() - nominal_hz) <= kRateTolerance * nominal_hz))
    return core::fail(kDamaged, "the exact rate contradicts nominal_srate " + shortest_text(nominal_hz));
  return *rate;
}

/// Returns the rate; nothing for an irregular stream. Files of other programs have only nominal_srate.
core::Result<std::optional<core::Rate>> rate_of(pugi::xml_node info) {
  std::optional<double> nominal_hz;
  DTS_TRY(read_number(info, "nominal_srate", nominal_hz));
  if (nominal_hz.value_or(0.0) == 0.0) return std::optional<core::Rate>();
  const pugi::xml_node exact = info.child("desc").child("dts").child("rate");
  const auto rate = exact ? exact_rate(exact, *nominal_hz) : core::Rate::from_hz(*nominal_hz);
  if (!rate) return core::fail(kDamaged, "impossible nominal_srate " + shortest_text(*nominal_hz) + ": " + rate.error().what);
  return std::optional<core::Rate>(*rate);
}

core::Result<ChannelInfo> channel_of(pugi::xml_node node) {
  ChannelInfo channel{.label = text_of_child(node, "label"), .unit = text_of_child(node, "unit"), .type = text_of_child(node, "type")};
  std::optional<int> device_channel;
  std::optional<double> minimum, maximum, resolution;
  for (const auto& status : {read_number(node, "device_channel", device_channel), read_number(node, "minimum", minimum),
                             read_number(node, "maximum", maximum), read_number(node, "resolution", resolution)})
    if (!status) return tl::make_unexpected(status.error());
  channel.device_channel = std::max(device_channel.value_or(-1), -1);
  channel.minimum = minimum.value_or(0.0);
  channel.maximum = maximum.value_or(0.0);
  channel.resolution = resolution.value_or(0.0);
  channel.is_sensor = node.child("is_sensor").text().as_bool();
  channel.is_marker = node.child("is_marker").text().as_bool();
  return channel;
}

/// Returns `channel_count` channels: other programs may describe fewer or more than that.
core::Result<std::vector<ChannelInfo>> channels_of(pugi::xml_node info) {
  std::optional<std::uint64_t> count;
  DTS_TRY(read_number(info, "channel_count", count));
  if (count.value_or(0) < 1 || *count > kMaxChannels)
    return core::fail(kDamaged, "channel_count " + std::to_string(count.value_or(0)) + " is not within 1 to 4096");
  std::vector<ChannelInfo> channels;
  for (const pugi::xml_node node : info.child("desc").child("channels").children("channel")) {
    if (channels.size() == *count) break;
    DTS_TRY_ASSIGN(auto channel, channel_of(node));
    channels.push_back(std::move(channel));
  }
  channels.resize(static_cast<std::size_t>(*count));
  return channels;
}

}  // namespace

core::Result<FileHeader> file_header_of_xml(std::string_view xml) {
  pugi::xml_document document;
  DTS_TRY_ASSIGN(const auto info, parse(document, xml));
  const std::string_view version = trimmed(info.child("version").text().get());
  if (version != "1" && !version.starts_with("1."))
    return core::fail(core::ErrorCode::Unsupported, "XDF version '" + clean_text(version.substr(0, 40)) + "'; only 1.x is supported");
  return FileHeader{.facts = facts_of(info.child("desc"))};
}

core::Result<StreamInfo> stream_info_of_xml(std::string_view xml) {
  pugi::xml_document document;
  DTS_TRY_ASSIGN(const auto info, parse(document, xml));
  DTS_TRY_ASSIGN(const auto type, type_of(info));
  DTS_TRY_ASSIGN(const auto rate, rate_of(info));
  DTS_TRY_ASSIGN(auto channels, channels_of(info));
  const pugi::xml_node ours = info.child("desc").child("dts");
  std::optional<std::int64_t> delay_ns;
  DTS_TRY(read_number(ours, "delay_ns", delay_ns));
  StreamInfo stream{.name = text_of_child(info, "name"), .content = text_of_child(info, "type"), .value_type = type};
  stream.rate = rate;
  stream.channels = std::move(channels);
  stream.delay_ns = delay_ns.value_or(0);
  for (const pugi::xml_node node : ours.children("fact"))
    stream.facts.emplace_back(clean_text(node.attribute("name").value()), clean_text(node.text().get()));
  return stream;
}

core::Result<StreamFooter> stream_footer_of_xml(std::string_view xml) {
  pugi::xml_document document;
  DTS_TRY_ASSIGN(const auto info, parse(document, xml));
  StreamFooter footer;
  for (const auto& status :
       {read_number(info, "first_timestamp", footer.first_time_s), read_number(info, "last_timestamp", footer.last_time_s),
        read_number(info, "sample_count", footer.sample_count)})
    if (!status) return tl::make_unexpected(status.error());
  footer.facts = facts_of(info.child("desc"));
  return footer;
}

}  // namespace dts::record
