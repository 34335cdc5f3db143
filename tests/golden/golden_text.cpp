// SPDX-License-Identifier: Apache-2.0
#include "golden/golden_text.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "dts/v1/stream.pb.h"

namespace dts::golden {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

// A build with another compiler, or with sanitizers, rounds sums and products differently in the last bits: 1e-15 of a value, more where
// large numbers cancel. 1e-9 is far above that and far below what a person or an instrument could notice.
constexpr double kRelative = 1e-9;
constexpr double kAbsolute = 1e-9;  // mm, V, N, s: around 0 no relative tolerance holds
// Streams travel as float32. A double next to the middle between two floats may go to either: two steps, each at most 1.2e-7.
constexpr double kFloatRelative = 2.4e-7;
constexpr double kFloatAbsolute = 1e-6;

std::string number(const char* format, double value) {
  if (std::isnan(value)) return "nan";
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), format, value == 0.0 ? 0.0 : value);
  std::string result = text.data();
  if (result.find_first_of(".en") == std::string::npos) result += ".0";  // by this a comparison knows that it may be near
  return result;
}

/// What depends on how the threads of a run took turns and on this machine's disk, and not on the data.
bool is_of_this_run(const FieldDescriptor& field) {
  constexpr std::array<std::string_view, 4> kNames = {"ring_fill", "disk", "recording", "record_lag_s"};
  return std::ranges::find(kNames, field.name()) != kNames.end();
}

/// `index` -1: the field is not repeated.
std::string value_text(const Message& message, const FieldDescriptor& field, int index) {
  const Reflection& reflection = *message.GetReflection();
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
    return number("%.12g", index < 0 ? reflection.GetDouble(message, &field) : reflection.GetRepeatedDouble(message, &field, index));
  }
  std::string text;
  google::protobuf::TextFormat::PrintFieldValueToString(message, &field, index, &text);
  return text;
}

void add_fields(const Message& message, const std::string& prefix, std::string& out);

void add_repeated(const Message& message, const FieldDescriptor& field, const std::string& key, std::string& out) {
  const Reflection& reflection = *message.GetReflection();
  std::vector<std::string> entries;
  for (int index = 0; index < reflection.FieldSize(message, &field); ++index) {
    std::string entry;
    const std::string name = key + (field.is_map() ? "" : "[" + std::to_string(index) + "]");
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      add_fields(reflection.GetRepeatedMessage(message, &field, index), name + ".", entry);
    } else {
      entry = " " + name + "=" + value_text(message, field, index);
    }
    entries.push_back(entry);
  }
  if (field.is_map()) std::ranges::sort(entries);  // a map has no order
  for (const std::string& entry : entries) out += entry;
}

void add_fields(const Message& message, const std::string& prefix, std::string& out) {
  const auto& descriptor = *message.GetDescriptor();
  for (int index = 0; index < descriptor.field_count(); ++index) {
    const FieldDescriptor& field = *descriptor.field(index);
    if (is_of_this_run(field)) continue;
    const std::string key = prefix + std::string(field.name());
    if (field.is_repeated()) {
      add_repeated(message, field, key, out);
    } else if ((!field.has_presence() && field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) ||
               message.GetReflection()->HasField(message, &field)) {
      // A number of 0 is no field: written all the same, or 1e-17 would be a field too many.
      if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
        add_fields(message.GetReflection()->GetMessage(message, &field), key + ".", out);
      } else {
        out += " " + key + "=" + value_text(message, field, -1);
      }
    }
  }
}

/// Position and quality as they are; of each channel the first value, the last, the mean of all that are numbers, and how many are none.
std::string block_text(const dts::v1::StreamBlock& block) {
  std::string out;
  dts::v1::StreamBlock rest = block;
  rest.clear_values();
  rest.clear_quality();
  add_fields(rest, "", out);
  out += " quality=";
  for (const char bits : block.quality()) out += std::to_string(static_cast<unsigned char>(bits)) + ",";
  const auto count = static_cast<int>(block.scan_count());
  for (int channel = 0; channel < static_cast<int>(block.channel_count()); ++channel) {
    double sum = 0.0;
    int numbers = 0;
    for (int scan = 0; scan < count; ++scan) {
      const double value = static_cast<double>(block.values(channel * count + scan));
      if (std::isnan(value)) continue;
      sum += value;
      ++numbers;
    }
    const std::string key = " c" + std::to_string(channel);
    out += key + ".first=" + number("%.9g", static_cast<double>(block.values(channel * count)));
    out += key + ".last=" + number("%.9g", static_cast<double>(block.values(channel * count + count - 1)));
    out += key + ".mean=" + number("%.9g", sum / numbers);
    if (numbers < count) out += key + ".nan=" + std::to_string(count - numbers);
  }
  return out;
}

std::vector<std::string> tokens_of(const std::string& line) {
  std::vector<std::string> tokens(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && (i == 0 || line[i - 1] != '\\')) is_quoted = !is_quoted;
    if (line[i] == ' ' && !is_quoted) {
      tokens.emplace_back();
    } else {
      tokens.back() += line[i];
    }
  }
  return tokens;
}

bool is_near(const std::string& expected, const std::string& got, bool is_float) {
  if (expected == got) return true;
  if (expected.find_first_of(".e") == std::string::npos || got.find_first_of(".e") == std::string::npos) return false;
  char* end = nullptr;
  const double one = std::strtod(expected.c_str(), &end);
  if (*end != '\0') return false;
  const double other = std::strtod(got.c_str(), &end);
  if (*end != '\0') return false;
  return std::abs(one - other) <= (is_float ? kFloatRelative : kRelative) * std::abs(one) + (is_float ? kFloatAbsolute : kAbsolute);
}

std::string line_difference(const std::string& expected, const std::string& got) {
  const auto wanted = tokens_of(expected);
  const auto found = tokens_of(got);
  for (std::size_t i = 0; i < std::max(wanted.size(), found.size()); ++i) {
    const std::string one = i < wanted.size() ? wanted[i] : "nothing";
    const std::string other = i < found.size() ? found[i] : "nothing";
    const auto equals = one.find('=');
    const std::string key = one.substr(0, equals);
    const bool same_key = equals != std::string::npos && other.starts_with(key + "=");
    if (one == other || (same_key && is_near(one.substr(equals + 1), other.substr(equals + 1), wanted[0] == "block"))) continue;
    return key + ": expected " + one + ", got " + other;
  }
  return {};
}

}  // namespace

std::string line_of(std::string_view topic, const Message& message) {
  if (const auto* block = dynamic_cast<const dts::v1::StreamBlock*>(&message)) return "block " + std::string(topic) + block_text(*block);
  std::string out = (message.GetDescriptor()->name() == "Response" ? "answer " : "event ") + std::string(topic);
  add_fields(message, "", out);
  return out;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> differences(const std::vector<std::string>& expected, const std::vector<std::string>& got, std::size_t most) {
  std::vector<std::string> found;
  for (std::size_t i = 0; i < std::max(expected.size(), got.size()) && found.size() < most; ++i) {
    const std::string difference = i >= expected.size() ? "expected no more lines, got " + got[i]
                                   : i >= got.size()    ? "expected " + expected[i] + ", got no more lines"
                                                        : line_difference(expected[i], got[i]);
    if (!difference.empty()) found.push_back("line " + std::to_string(i + 1) + ", " + difference);
  }
  return found;
}

}  // namespace dts::golden
