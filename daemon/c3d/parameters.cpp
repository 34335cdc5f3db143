// SPDX-License-Identifier: Apache-2.0
#include "c3d/parameters.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <utility>

namespace dts::c3d {
namespace {

constexpr std::size_t kSectionHead = 4;
constexpr std::size_t kMostDimensions = 7;
constexpr std::size_t kMostWarnings = 20;

enum Type : std::int8_t { kCharacter = -1, kByte = 1, kInteger = 2, kReal = 4 };

std::string capital(std::string_view text) {
  std::string name(text);
  for (char& letter : name) {
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  }
  return name.substr(0, name.find_last_not_of(std::string_view(" \0", 2)) + 1);
}

std::string without_end(std::string_view text) {
  const std::size_t end = text.find_last_not_of(std::string_view(" \0", 2));
  return std::string(text.substr(0, end + 1));
}

/// Reads the records of a section, one after the other, never backwards.
class Reader {
 public:
  Reader(std::string_view section, Encoding encoding, std::vector<std::string>& warnings)
      : section_(section), encoding_(encoding), warnings_(warnings) {}

  std::vector<Parameter> read() {
    for (at_ = kSectionHead; read_record();) {
    }
    for (auto& [group, parameter] : found_) {
      const auto name = groups_.find(group);
      if (name == groups_.end()) {
        warn("parameter " + parameter.name + " belongs to group " + std::to_string(group) + ", which the file does not have");
        continue;
      }
      parameter.group = name->second;
      parameters_.push_back(std::move(parameter));
    }
    return std::move(parameters_);
  }

 private:
  [[nodiscard]] std::size_t left() const noexcept { return end_ - at_; }
  [[nodiscard]] std::int8_t byte() noexcept { return static_cast<std::int8_t>(section_[at_++]); }
  void warn(const std::string& text) {
    if (warnings_.size() < kMostWarnings) warnings_.push_back(text);
  }
  /// Always false: there is no record behind this one.
  bool stop(const std::string& why) {
    warn("the parameters are broken at byte " + std::to_string(at_) + " of their section: " + why);
    return false;
  }

  /// Returns false behind the last record.
  bool read_record() {
    end_ = section_.size();
    if (left() < 2) return false;  // some writers leave out the zero that ends the section
    const auto length = static_cast<std::size_t>(std::abs(byte()));
    if (length == 0) return false;
    const int id = byte();
    if (left() < length + 2) return stop("a name is longer than what is left");
    const std::string name = capital(section_.substr(at_, length));
    at_ += length;
    const std::size_t from = at_;
    const auto offset = signed_word(encoding_, section_.data() + at_);
    at_ += 2;
    const auto next = static_cast<std::int64_t>(from) + offset;
    const bool has_next = next >= static_cast<std::int64_t>(at_) && next <= static_cast<std::int64_t>(section_.size());
    if (has_next) end_ = static_cast<std::size_t>(next);  // data of two records never overlap: their memory is that of the section
    if (id < 0) {
      groups_.emplace(-id, name);  // of two groups with one number, the first
    } else if (id > 0) {
      read_parameter(id, name);
    } else {
      warn(name + " is neither a group nor a parameter");
    }
    if (offset == 0) return false;
    if (!has_next) return stop("the record behind " + name + " would be outside");
    at_ = end_;
    return true;
  }

  void read_parameter(int group, const std::string& name) {
    if (left() < 2) return warn("parameter " + name + " ends before its data");
    const std::int8_t type = byte();
    const auto dimensions = static_cast<std::size_t>(static_cast<std::uint8_t>(byte()));
    if (type != kCharacter && type != kByte && type != kInteger && type != kReal) {
      return warn("parameter " + name + " is of the unknown type " + std::to_string(type));
    }
    if (dimensions > kMostDimensions) return warn("parameter " + name + " has " + std::to_string(dimensions) + " dimensions");
    if (left() < dimensions) return warn("parameter " + name + " ends before its data");
    Parameter parameter{.group = {}, .name = name};
    std::uint64_t count = 1;  // at most 255^7, which fits
    for (std::size_t k = 0; k < dimensions; ++k) {
      parameter.dimensions.push_back(static_cast<std::uint8_t>(byte()));
      count *= parameter.dimensions.back();
    }
    const std::uint64_t bytes = count * static_cast<std::uint64_t>(std::abs(type));
    if (bytes > left()) return warn("parameter " + name + " says it has " + std::to_string(bytes) + " bytes, its record has fewer");
    const std::string_view data = section_.substr(at_, static_cast<std::size_t>(bytes));
    at_ += data.size();
    if (type == kCharacter) {
      add_texts(data, parameter);
    } else {
      add_numbers(data, type, parameter);
    }
    found_.emplace_back(group, std::move(parameter));
  }

  static void add_texts(std::string_view data, Parameter& parameter) {
    const std::size_t length = parameter.dimension(0);
    for (std::size_t at = 0; length > 0 && at + length <= data.size(); at += length) {
      parameter.texts.push_back(without_end(data.substr(at, length)));
    }
  }

  void add_numbers(std::string_view data, std::int8_t type, Parameter& parameter) const {
    const auto size = static_cast<std::size_t>(type);
    parameter.numbers.reserve(data.size() / size);
    for (const char* at = data.data(); at != data.data() + data.size(); at += size) {
      if (type == kReal) {
        parameter.numbers.push_back(real(encoding_, at));
      } else {
        parameter.numbers.push_back(type == kInteger ? signed_word(encoding_, at) : static_cast<std::uint8_t>(*at));
      }
    }
  }

  std::string_view section_;
  Encoding encoding_;
  std::vector<std::string>& warnings_;
  std::size_t at_ = 0;
  std::size_t end_ = 0;  ///< Of the record that is read.
  std::map<int, std::string> groups_;
  std::vector<std::pair<int, Parameter>> found_;  ///< With the number of the group, which may follow its parameters.
  std::vector<Parameter> parameters_;
};

}  // namespace

std::size_t Parameter::dimension(std::size_t index) const noexcept { return index < dimensions.size() ? dimensions[index] : 1; }

Parameters Parameters::read(std::string_view section, Encoding encoding, std::vector<std::string>& warnings) {
  Parameters parameters;
  if (section.size() > kSectionHead) parameters.all_ = Reader(section, encoding, warnings).read();
  return parameters;
}

const Parameter* Parameters::find(std::string_view group, std::string_view name) const noexcept {
  const auto found =
      std::ranges::find_if(all_, [&](const Parameter& parameter) { return parameter.name == name && parameter.group == group; });
  return found == all_.end() ? nullptr : &*found;
}

std::optional<double> Parameters::number(std::string_view group, std::string_view name, std::size_t index) const noexcept {
  const Parameter* const found = find(group, name);
  if (found == nullptr || index >= found->numbers.size()) return std::nullopt;
  return found->numbers[index];
}

std::optional<double> Parameters::count(std::string_view group, std::string_view name, std::size_t index) const noexcept {
  constexpr double kWord = 65536.0;
  const auto found = number(group, name, index);
  return found && *found < 0.0 ? *found + kWord : found;
}

std::string Parameters::text(std::string_view group, std::string_view name) const {
  const Parameter* const found = find(group, name);
  return found == nullptr || found->texts.empty() ? std::string() : found->texts.front();
}

}  // namespace dts::c3d
