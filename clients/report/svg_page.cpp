// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>

#include "core/utf8.h"
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
constexpr double kLastLine = kPageHeightMm - 6.0;

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

/// Writes downwards; skips blocks that do not fit on the page, and the page states that.
class Flow {
 public:
  Flow(Canvas& canvas, double left, double width, double top) : canvas_(canvas), left_(left), width_(width), y_(top) {}

  [[nodiscard]] double y() const noexcept { return y_; }
  [[nodiscard]] bool is_full() const noexcept { return is_full_; }
  void skip(double height) { y_ += height; }

  void paragraph(const std::string& text, const TextStyle& style = {.size = kTextSize}, double indent = 0.0) {
    for (const std::string& line : lines_of(text, width_ - indent, style.size)) {
      if (!has_room(kLinePitch)) return;
      canvas_.text(left_ + indent, y_ + style.size, line, style);
      y_ += kLinePitch;
    }
  }

  void operator()(const Table& table) {
    head(table.title);
    const double share = std::accumulate(table.columns.begin(), table.columns.end(), 0.0,
                                         [](double sum, const Column& column) { return sum + column.share; });
    std::vector<double> widths;
    for (const Column& column : table.columns) widths.push_back(width_ * column.share / share);
    column_heads(table, widths);
    for (const Row& row : table.rows) put_row(table, row, widths);
    y_ += 0.6;
    for (const std::string& note : table.footnotes) paragraph(note, {.size = 1.9, .colour = colour::kDarkGrey});
    y_ += kBlockGap;
  }
  void operator()(const Figure& figure) {
    head(figure.title);
    if (!has_room(figure.height_mm)) return;
    Canvas picture = canvas_.group(left_, y_);
    figure.draw(picture);
    y_ += figure.height_mm + kBlockGap;
  }
  void operator()(const Notes& notes) {
    head(notes.title);
    for (const std::string& item : notes.items) paragraph(item);
    y_ += kBlockGap;
  }

 private:
  bool has_room(double height) {
    is_full_ = is_full_ || y_ + height > kLastLine;
    return !is_full_;
  }
  void head(const std::string& title) {
    if (title.empty() || !has_room(5.0)) return;
    canvas_.text(left_, y_ + 2.5, title, {.size = kHeadSize, .is_bold = true});
    y_ += 4.2;
  }
  void put_cell(const Column& column, double x, double width, const std::string& text, const TextStyle& style) {
    if (text.empty()) return;
    TextStyle placed = style;
    placed.anchor = column.is_number ? Anchor::End : Anchor::Start;
    canvas_.text(column.is_number ? x + width - 1.0 : x, y_ + style.size, text, placed);
  }
  void column_heads(const Table& table, const std::vector<double>& widths) {
    std::vector<std::vector<std::string>> heads;
    std::size_t most = 1;
    for (std::size_t index = 0; index < table.columns.size(); ++index) {
      heads.push_back(lines_of(table.columns[index].head, widths[index] - 1.0, kTextSize));
      most = std::max(most, heads.back().size());
    }
    if (!has_room(kRowPitch * static_cast<double>(most))) return;
    for (std::size_t line = 0; line < most; ++line) {
      double x = left_;
      for (std::size_t index = 0; index < table.columns.size(); ++index) {
        const std::size_t above = most - heads[index].size();  // aligns heads at the bottom
        if (line >= above)
          put_cell(table.columns[index], x, widths[index], heads[index][line - above], {.size = kTextSize, .colour = colour::kDarkGrey});
        x += widths[index];
      }
      y_ += kLinePitch;
    }
    canvas_.line(left_, y_ + 0.2, left_ + width_, y_ + 0.2, {.colour = colour::kGrey, .width = 0.2});
    y_ += 0.5;
  }
  void put_row(const Table& table, const Row& row, const std::vector<double>& widths) {
    if (!has_room(kRowPitch)) return;
    if (row.is_heading) {
      canvas_.text(left_, y_ + kTextSize, row.cells.front(), {.size = kTextSize, .colour = colour::kDarkGrey, .is_bold = true});
      y_ += kRowPitch;
      return;
    }
    double x = left_;
    for (std::size_t index = 0; index < std::min(row.cells.size(), table.columns.size()); ++index) {
      std::string text = row.cells[index];
      if (!table.columns[index].is_number) text = lines_of(text, widths[index] - 0.5, kTextSize).front();
      put_cell(table.columns[index], x, widths[index], text, {.size = kTextSize});
      x += widths[index];
    }
    y_ += kRowPitch;
  }

  Canvas& canvas_;
  double left_;
  double width_;
  double y_;
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
      canvas.text(x, y + kTextSize, facts[index].name, {.size = kTextSize, .colour = colour::kDarkGrey});
      for (const std::string& line : lines_of(facts[index].value, width - kNameMm, kTextSize)) {
        canvas.text(x + kNameMm, y + kTextSize, line, {.size = kTextSize});
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

}  // namespace

std::string svg_of(const PageContent& content) {
  pugi::xml_document document;
  document.append_child(pugi::node_comment).set_value(std::string(kPageMark).c_str());
  Canvas canvas =
      new_picture(document, kPageWidthMm, kPageHeightMm, content.title + (content.subtitle.empty() ? "" : ": " + content.subtitle));
  canvas.rect(0.0, 0.0, kPageWidthMm, kPageHeightMm, "#FFFFFF", {.colour = colour::kNone});
  canvas.text(kMarginMm, kMarginMm + 3.6, content.title + (content.subtitle.empty() ? "" : ": " + content.subtitle),
              {.size = kTitleSize, .is_bold = true});
  double y = put_facts(canvas, content.facts, kMarginMm + 6.5);
  y = put_alerts(canvas, content.alerts, y);
  bool is_full = false;
  for (const Section& section : content.sections) {
    double bottom = y;
    const double width = section.columns.size() > 1 ? kHalfWidthMm : kFullWidthMm;
    for (std::size_t column = 0; column < section.columns.size(); ++column) {
      Flow flow(canvas, kMarginMm + (width + kGutterMm) * static_cast<double>(column), width, y);
      for (const Block& block : section.columns[column]) std::visit(flow, block);
      bottom = std::max(bottom, flow.y());
      is_full = is_full || flow.is_full();
    }
    y = bottom;
  }
  if (is_full) {
    canvas.text(kPageWidthMm - kMarginMm, kPageHeightMm - 2.5,
                Translation(content.language, {})("This page is full; the HTML page shows everything."),
                {.size = 2.4, .anchor = Anchor::End, .colour = colour::kVermillion, .is_bold = true});
  }
  return text_of(document, true);
}

}  // namespace dts::report
