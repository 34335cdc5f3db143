// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <compare>
#include <cstdint>
#include <deque>
#include <numeric>

#include "core/utf8.h"
#include "report/intended_use.h"
#include "report/page_parts.h"
#include "report/report.h"
#include "report/translation.h"

namespace dts::report {
namespace {

constexpr double kTitleSize = 4.6;
constexpr double kHeadSize = 2.6;  // of blocks
constexpr double kTextSize = 2.1;
constexpr double kBoldWider = 1.18;  // relative to the same text in regular letters
constexpr double kRowPitch = 2.55;
constexpr double kLinePitch = 2.55;
constexpr double kBlockGap = 1.8;
constexpr std::size_t kFactColumns = 3;
constexpr double kLastLine = kPageHeightMm - 8.0;
constexpr double kIntendedUseLine = kPageHeightMm - 5.6;
constexpr double kFooterLine = kPageHeightMm - 3.0;  // of a document of several pages
constexpr double kNextPageTop = kMarginMm + 4.0;     // below the title of a continued page
constexpr double kHeadPitch = 4.2;

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char letter : text) {
    if (letter == ' ' || letter == '\n' || letter == '\t' || letter == '\r')
      words.emplace_back();
    else
      words.back() += letter;
  }
  std::erase(words, std::string());
  return words;
}

/// Breaks lines at spaces; cuts a word longer than a line (a hash, a hostile text) between characters.
std::vector<std::string> lines_of(const std::string& text, double width, double size) {
  std::vector<std::string> lines(1);
  for (const std::string& word : words_of(text)) {
    if (!lines.back().empty() && text_width(lines.back() + " " + word, size) > width) lines.emplace_back();
    if (!lines.back().empty()) lines.back() += " ";
    const bool is_too_long = text_width(word, size) > width;
    for (const char letter : word) {
      const bool begins_character = core::starts_character(letter);
      if (is_too_long && begins_character && text_width(lines.back(), size) > width - size) lines.emplace_back();
      lines.back() += letter;
    }
  }
  return lines;
}

/// Empty pages of A4 size, made as they are needed.
class Paper {
 public:
  explicit Paper(const PageContent& content) : title_(content.title + (content.subtitle.empty() ? "" : ": " + content.subtitle)) {}

  [[nodiscard]] Canvas& page(std::size_t number) {
    while (canvases_.size() <= number) add();
    return canvases_[number];
  }
  [[nodiscard]] std::size_t size() const noexcept { return canvases_.size(); }
  [[nodiscard]] const std::string& title() const noexcept { return title_; }
  [[nodiscard]] std::string text(std::size_t number) const { return text_of(documents_[number], true); }

 private:
  void add() {
    pugi::xml_document& document = documents_.emplace_back();
    document.append_child(pugi::node_comment).set_value(std::string(kPageMark).c_str());
    Canvas canvas = new_picture(document, kPageWidthMm, kPageHeightMm, title_);
    canvas.rect(0.0, 0.0, kPageWidthMm, kPageHeightMm, "#FFFFFF", {.colour = colour::kNone});
    canvases_.push_back(canvas);
  }

  std::string title_;
  std::deque<pugi::xml_document> documents_;
  std::deque<Canvas> canvases_;
};

/// A height on one of the pages.
struct Place {
  std::size_t page = 0;
  double y = 0.0;

  friend auto operator<=>(const Place&, const Place&) = default;
};

enum class WhenFull : std::uint8_t { Stop, NextPage };

/// Writes downwards in one column. At the end of the page, continues on the next one, or skips the blocks that do not fit.
class Flow {
 public:
  Flow(Paper& paper, double left, double width, Place at, WhenFull when_full)
      : paper_(paper), left_(left), width_(width), page_(at.page), y_(at.y), when_full_(when_full) {}

  [[nodiscard]] Place place() const noexcept { return {.page = page_, .y = y_}; }
  [[nodiscard]] bool is_full() const noexcept { return is_full_; }

  void paragraph(const std::string& text, const TextStyle& style = {.size = kTextSize}, double indent = 0.0) {
    for (const std::string& line : lines_of(text, width_ - indent, style.size)) {
      if (!has_room(kLinePitch)) return;
      canvas().text(left_ + indent, y_ + style.size, line, style);
      y_ += kLinePitch;
    }
  }

  void operator()(const Table& table) {
    const double share = std::accumulate(table.columns.begin(), table.columns.end(), 0.0,
                                         [](double sum, const Column& column) { return sum + column.share; });
    std::vector<double> widths;
    for (const Column& column : table.columns) widths.push_back(width_ * column.share / share);
    head(table.title, kLinePitch * static_cast<double>(lines_of_heads(table, widths) + 1));
    column_heads(table, widths);
    for (const Row& row : table.rows) {
      const std::size_t page = page_;
      if (!has_room(kRowPitch * static_cast<double>(lines_of_row(table, row, widths)))) break;
      if (page_ != page) column_heads(table, widths);
      put_row(table, row, widths);
    }
    y_ += 0.6;
    for (const std::string& note : table.footnotes) paragraph(note, {.size = 1.9, .colour = colour::kDarkGrey});
    y_ += kBlockGap;
  }
  void operator()(const Figure& figure) {
    head(figure.title, figure.height_mm);
    if (!has_room(figure.height_mm)) return;
    Canvas picture = canvas().group(left_, y_);
    figure.draw(picture);
    y_ += figure.height_mm + kBlockGap;
  }
  void operator()(const Notes& notes) {
    head(notes.title, kLinePitch);
    for (const std::string& item : notes.items) paragraph(item);
    y_ += kBlockGap;
  }

 private:
  [[nodiscard]] Canvas& canvas() { return paper_.page(page_); }
  bool has_room(double height) {
    if (y_ + height <= kLastLine) return !is_full_;
    const bool fits_nowhere = kNextPageTop + height > kLastLine;
    if (when_full_ == WhenFull::Stop || fits_nowhere) {
      is_full_ = true;
      return false;
    }
    ++page_;
    y_ = kNextPageTop;
    return true;
  }
  /// Keeps the title on the page of what follows: a content of this height.
  void head(const std::string& title, double following) {
    if (title.empty() || !has_room(kHeadPitch + following)) return;
    canvas().text(left_, y_ + 2.5, title, {.size = kHeadSize, .is_bold = true});
    y_ += kHeadPitch;
  }
  void put_cell(const Column& column, double x, double width, const std::string& text, const TextStyle& style) {
    if (text.empty()) return;
    TextStyle placed = style;
    placed.anchor = column.is_number ? Anchor::End : Anchor::Start;
    canvas().text(column.is_number ? x + width - 1.0 : x, y_ + style.size, text, placed);
  }
  [[nodiscard]] static std::vector<std::vector<std::string>> heads_of(const Table& table, const std::vector<double>& widths) {
    std::vector<std::vector<std::string>> heads;
    for (std::size_t index = 0; index < table.columns.size(); ++index) {
      heads.push_back(lines_of(table.columns[index].head, widths[index] - 1.0, kTextSize));
    }
    return heads;
  }
  [[nodiscard]] static std::size_t lines_of_heads(const Table& table, const std::vector<double>& widths) {
    std::size_t most = 1;
    for (const auto& head : heads_of(table, widths)) most = std::max(most, head.size());
    return most;
  }
  void column_heads(const Table& table, const std::vector<double>& widths) {
    const std::vector<std::vector<std::string>> heads = heads_of(table, widths);
    const std::size_t most = lines_of_heads(table, widths);
    if (!has_room(kRowPitch * static_cast<double>(most))) return;
    for (std::size_t line = 0; line < most; ++line) {
      double x = left_;
      for (std::size_t index = 0; index < table.columns.size(); ++index) {
        const std::size_t above = most - heads[index].size();  // aligns heads at the bottom
        if (line >= above)
          put_cell(table.columns[index], x + indent_of(table, index), widths[index], heads[index][line - above],
                   {.size = kTextSize, .colour = colour::kDarkGrey});
        x += widths[index];
      }
      y_ += kLinePitch;
    }
    canvas().line(left_, y_ + 0.2, left_ + width_, y_ + 0.2, {.colour = colour::kGrey, .width = 0.2});
    y_ += 0.5;
  }
  /// Text after a column of numbers needs a gap: numbers end at the right edge of their column.
  [[nodiscard]] static double indent_of(const Table& table, std::size_t index) {
    return index > 0 && !table.columns[index].is_number && table.columns[index - 1].is_number ? 1.2 : 0.0;
  }
  [[nodiscard]] static std::vector<std::string> lines_of_cell(const Table& table, const Row& row, std::size_t index, double width) {
    if (table.columns[index].is_number) return {row.cells[index]};
    return lines_of(row.cells[index], width - 0.5 - indent_of(table, index), kTextSize);
  }
  [[nodiscard]] static std::size_t lines_of_row(const Table& table, const Row& row, const std::vector<double>& widths) {
    std::size_t most = 1;
    if (row.is_heading) return most;
    for (std::size_t index = 0; index < std::min(row.cells.size(), table.columns.size()); ++index)
      most = std::max(most, lines_of_cell(table, row, index, widths[index]).size());
    return most;
  }
  void put_row(const Table& table, const Row& row, const std::vector<double>& widths) {
    if (row.is_heading) {
      canvas().text(left_, y_ + kTextSize, row.cells.front(), {.size = kTextSize, .colour = colour::kDarkGrey, .is_bold = true});
      y_ += kRowPitch;
      return;
    }
    const double top = y_;
    double x = left_;
    for (std::size_t index = 0; index < std::min(row.cells.size(), table.columns.size()); ++index) {
      y_ = top;
      for (const std::string& line : lines_of_cell(table, row, index, widths[index])) {
        put_cell(table.columns[index], x + indent_of(table, index), widths[index], line, {.size = kTextSize});
        y_ += kRowPitch;
      }
      x += widths[index];
    }
    y_ = top + kRowPitch * static_cast<double>(lines_of_row(table, row, widths));
  }

  Paper& paper_;
  double left_;
  double width_;
  std::size_t page_;
  double y_;
  WhenFull when_full_;
  bool is_full_ = false;
};

double put_facts(Canvas& canvas, const std::vector<Fact>& facts, double top) {
  constexpr double kNameMm = 18.0;
  const double width = (kFullWidthMm - kGutterMm * (kFactColumns - 1)) / kFactColumns;
  const std::size_t rows = (facts.size() + kFactColumns - 1) / kFactColumns;
  double bottom = top;
  for (std::size_t column = 0; column < kFactColumns; ++column) {
    const double x = kMarginMm + (width + kGutterMm) * static_cast<double>(column);
    double y = top;
    for (std::size_t index = column * rows; index < std::min(facts.size(), (column + 1) * rows); ++index) {
      const auto names = lines_of(facts[index].name, kNameMm - 1.0, kTextSize);
      const auto values = lines_of(facts[index].value, width - kNameMm, kTextSize);
      for (std::size_t line = 0; line < std::max(names.size(), values.size()); ++line) {
        if (line < names.size()) canvas.text(x, y + kTextSize, names[line], {.size = kTextSize, .colour = colour::kDarkGrey});
        if (line < values.size()) canvas.text(x + kNameMm, y + kTextSize, values[line], {.size = kTextSize});
        y += kLinePitch;
      }
      y += 0.3;
    }
    bottom = std::max(bottom, y);
  }
  return bottom + 1.0;
}

double put_alerts(Canvas& canvas, const std::vector<std::string>& alerts, double top) {
  double y = top;
  for (const std::string& alert : alerts) {
    const auto lines = lines_of("! " + alert, (kFullWidthMm - 4.0) / kBoldWider, 2.4);
    const double height = 3.1 * static_cast<double>(lines.size()) + 1.2;
    canvas.rect(kMarginMm, y, kFullWidthMm, height, colour::kWarningShade, {.colour = colour::kVermillion, .width = 0.25});
    for (std::size_t line = 0; line < lines.size(); ++line) {
      canvas.text(kMarginMm + 2.0, y + 2.9 + 3.1 * static_cast<double>(line), lines[line], {.size = 2.4, .is_bold = true});
    }
    y += height + 0.8;
  }
  return alerts.empty() ? y : y + 1.0;
}

/// Writes at the bottom of a page what results are for.
void put_intended_use(Canvas& canvas, Language language) {
  canvas.text(kMarginMm, kIntendedUseLine, Translation(language, {})(kIntendedUse), {.size = 1.9, .colour = colour::kDarkGrey});
}

/// Lays out the page. Returns whether something did not fit.
bool lay_out(const PageContent& content, Paper& paper, WhenFull when_full) {
  Canvas& first = paper.page(0);
  first.text(kMarginMm, kMarginMm + 3.6, paper.title(), {.size = kTitleSize, .is_bold = true});
  Place top{.page = 0, .y = put_facts(first, content.facts, kMarginMm + 6.5)};
  top.y = put_alerts(first, content.alerts, top.y);
  bool is_full = false;
  for (const Section& section : content.sections) {
    Place bottom = top;
    const double width = section.columns.size() > 1 ? kHalfWidthMm : kFullWidthMm;
    for (std::size_t column = 0; column < section.columns.size(); ++column) {
      Flow flow(paper, kMarginMm + (width + kGutterMm) * static_cast<double>(column), width, top, when_full);
      for (const Block& block : section.columns[column]) std::visit(flow, block);
      bottom = std::max(bottom, flow.place());
      is_full = is_full || flow.is_full();
    }
    top = bottom;
  }
  return is_full;
}

}  // namespace

std::string svg_of(const PageContent& content) {
  Paper paper(content);
  const bool is_full = lay_out(content, paper, WhenFull::Stop);
  put_intended_use(paper.page(0), content.language);
  if (is_full) {
    paper.page(0).text(kPageWidthMm - kMarginMm, kPageHeightMm - 2.5,
                       Translation(content.language, {})("This page is full; the HTML page shows everything."),
                       {.size = 2.4, .anchor = Anchor::End, .colour = colour::kVermillion, .is_bold = true});
  }
  return paper.text(0);
}

std::vector<std::string> svg_document_of(std::span<const PageContent> contents, const std::string& footer) {
  std::deque<Paper> papers;
  std::size_t count = 0;
  for (const PageContent& content : contents) {
    Paper& paper = papers.emplace_back(content);
    lay_out(content, paper, WhenFull::NextPage);
    count += paper.size();
  }
  std::vector<std::string> pages;
  const Language language = contents.empty() ? Language::English : contents.front().language;
  for (Paper& paper : papers) {
    for (std::size_t number = 0; number < paper.size(); ++number) {
      const std::string of = std::to_string(pages.size() + 1) + " / " + std::to_string(count);
      const TextStyle style{.size = kTextSize, .colour = colour::kDarkGrey};
      if (number > 0) paper.page(number).text(kMarginMm, kMarginMm + 1.0, paper.title(), style);
      put_intended_use(paper.page(number), language);
      paper.page(number).text(kMarginMm, kFooterLine, footer, style);
      paper.page(number).text(kPageWidthMm - kMarginMm, kFooterLine, of,
                              {.size = kTextSize, .anchor = Anchor::End, .colour = colour::kDarkGrey});
      pages.push_back(paper.text(number));
    }
  }
  return pages;
}

}  // namespace dts::report
