// SPDX-License-Identifier: Apache-2.0
#include "report/translation.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <optional>
#include <utility>

namespace dts::report {
namespace {

constexpr int kMostDepth = 12;  // of texts within texts
constexpr std::string_view kAny = "{}";
constexpr char kVerbatimKind = '!';
constexpr char kNumberKind = '#';
/// Facts whose value is a text of a person.
constexpr std::array<std::string_view, 4> kTyped = {"Session", "Subject ID", "Label", "Notes"};
constexpr std::string_view kCorrected = " (corrected; recorded: ";  // after the value of such a fact

bool is_digit(char letter) { return std::isdigit(static_cast<unsigned char>(letter)) != 0; }
bool is_of_word(char letter) { return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_' || letter == '.'; }

/// Returns the text with a decimal comma in each number. Versions ("0.2.0"), names of files and addresses stay.
std::string with_comma(std::string_view text) {
  std::string out(text);
  for (std::size_t dot = 1; dot + 1 < out.size(); ++dot) {
    if (out[dot] != '.' || !is_digit(out[dot - 1]) || !is_digit(out[dot + 1])) continue;
    std::size_t begin = dot;
    while (begin > 0 && is_digit(out[begin - 1])) --begin;
    std::size_t end = dot + 1;
    while (end < out.size() && is_digit(out[end])) ++end;
    const bool is_part_of_word = begin > 0 && (is_of_word(out[begin - 1]) || out[begin - 1] == '=' || out[begin - 1] == '/');
    const bool is_version = end + 1 < out.size() && out[end] == '.' && is_digit(out[end + 1]);
    if (!is_part_of_word && !is_version) out[dot] = ',';
  }
  return out;
}

bool is_number(std::string_view text) {
  return text.find_first_not_of("0123456789.-") == std::string_view::npos && text.find_first_of("0123456789") != std::string_view::npos;
}

/// Returns the texts for each place; nothing if the English text is another one.
std::optional<std::vector<std::string_view>> parts_of_match(std::string_view text, const std::vector<std::string>& literals,
                                                            std::string_view places) {
  if (!text.starts_with(literals.front()) || !text.ends_with(literals.back())) return std::nullopt;
  std::vector<std::string_view> parts;
  std::size_t at = literals.front().size();
  for (std::size_t index = 1; index < literals.size(); ++index) {
    const bool is_last = index + 1 == literals.size();
    const std::size_t found = is_last ? text.size() - literals[index].size() : text.find(literals[index], at);
    if (found == std::string_view::npos || found <= at) return std::nullopt;  // no part is empty
    parts.push_back(text.substr(at, found - at));
    if (places[index - 1] == kNumberKind && !is_number(parts.back())) return std::nullopt;
    at = found + literals[index].size();
  }
  return parts;
}

}  // namespace

Translation::Translation(Language language, const session::Protocol& protocol) : language_(language) {
  if (language == Language::English) return;
  for (const auto& [english, translated] : german_texts()) add(english, translated);
  const auto words = [&](const std::vector<session::Translation>& all) {
    const auto found = std::ranges::find(all, code(language), &session::Translation::language);
    return found == all.end() ? session::Translation{} : *found;
  };
  const auto add_name = [this](const std::string& english, const std::string& translated) {
    if (!translated.empty()) whole_.emplace_back(english, translated);
  };
  add_name(protocol.title, words(protocol.translations).title);
  if (protocol.trials) {
    for (const session::Condition& condition : protocol.trials->conditions) {
      add_name(condition.title, words(condition.translations).title);
    }
  }
  for (const session::ProtocolField& field : protocol.fields) {
    const session::Translation translated = words(field.translations);
    add_name(field.label, translated.label);
    for (std::size_t index = 0; index < translated.choices.size() && index < field.choices.size(); ++index) {
      add_name(field.choices[index], translated.choices[index]);
    }
  }
  std::ranges::stable_sort(whole_, {}, &std::pair<std::string, std::string>::first);
  std::ranges::stable_sort(entries_, std::ranges::greater(), &Entry::letters);
}

void Translation::add(std::string_view english, std::string_view translated) {
  Entry entry{.literals = {}, .places = {}, .translated = std::string(translated)};
  std::string literal;
  for (std::size_t at = 0; at < english.size();) {
    const std::string_view rest = english.substr(at);
    const bool is_any = rest.starts_with(kAny);
    if (!is_any && !rest.starts_with("{!}") && !rest.starts_with("{#}")) {
      entry.letters += std::isalpha(static_cast<unsigned char>(english[at])) != 0 ? 1U : 0U;
      literal += english[at++];
      continue;
    }
    entry.literals.push_back(std::exchange(literal, {}));
    entry.places += rest[1];
    at += is_any ? kAny.size() : kAny.size() + 1;
  }
  if (entry.literals.empty()) {
    whole_.emplace_back(english, translated);
    return;
  }
  entry.literals.push_back(std::move(literal));
  entries_.push_back(std::move(entry));
}

std::string Translation::operator()(std::string_view english) const {
  return language_ == Language::English ? std::string(english) : text(english, 0);
}

std::string Translation::text(std::string_view english, int depth) const {
  const auto whole = std::ranges::lower_bound(whole_, english, {}, &std::pair<std::string, std::string>::first);
  if (whole != whole_.end() && whole->first == english) return whole->second;
  if (depth >= kMostDepth) return with_comma(english);
  for (const Entry& entry : entries_) {
    const auto parts = parts_of_match(english, entry.literals, entry.places);
    if (!parts) continue;
    std::string out;
    std::size_t part = 0;
    const std::string_view translated = entry.translated;
    for (std::size_t at = 0; at < translated.size();) {
      if (!translated.substr(at).starts_with(kAny)) {
        out += translated[at++];
        continue;
      }
      out += entry.places[part] == kVerbatimKind ? std::string((*parts)[part]) : text((*parts)[part], depth + 1);
      ++part;
      at += kAny.size();
    }
    return out;
  }
  return with_comma(english);
}

namespace {

struct BlockTranslation {
  const Translation& words;

  void operator()(Table& table) const {
    table.title = words(table.title);
    for (Column& column : table.columns) column.head = words(column.head);
    for (Row& row : table.rows) {
      for (std::string& cell : row.cells) cell = words(cell);
    }
    for (std::string& note : table.footnotes) note = words(note);
  }
  void operator()(Figure& figure) const {
    figure.title = words(figure.title);
    figure.draw = [draw = std::move(figure.draw), translate = words](Canvas& canvas) {
      Canvas translated = canvas.translated([translate](std::string_view text) { return translate(text); });
      draw(translated);
    };
  }
  void operator()(Notes& notes) const {
    notes.title = words(notes.title);
    for (std::string& item : notes.items) item = words(item);
  }
};

}  // namespace

PageContent Translation::operator()(PageContent page) const {
  page.language = language_;
  if (language_ == Language::English) return page;
  page.title = (*this)(page.title);
  page.subtitle = (*this)(page.subtitle);
  for (Fact& fact : page.facts) {
    const bool is_typed = std::ranges::find(kTyped, fact.name) != kTyped.end();
    fact.name = (*this)(fact.name);
    if (!is_typed) {
      fact.value = (*this)(fact.value);
    } else if (const std::size_t at = fact.value.rfind(kCorrected); at != std::string::npos) {
      fact.value = fact.value.substr(0, at) + (*this)(fact.value.substr(at));
    }
  }
  for (std::string& alert : page.alerts) alert = (*this)(alert);
  for (Section& section : page.sections) {
    for (auto& column : section.columns) {
      for (Block& block : column) std::visit(BlockTranslation{*this}, block);
    }
  }
  return page;
}

}  // namespace dts::report
