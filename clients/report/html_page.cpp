// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <kainjow/mustache.hpp>

#include "record/utf8_text.h"
#include "report/intended_use.h"
#include "report/page_parts.h"
#include "report/page_template.h"
#include "report/report.h"
#include "report/translation.h"

namespace dts::report {
namespace {

using kainjow::mustache::data;
using kainjow::mustache::object;
using List = kainjow::mustache::list;

// Every object must set every value: the template looks up missing values in the enclosing objects.

List texts(const std::vector<std::string>& all) {
  List list;
  for (const std::string& text : all) list.emplace_back(object{{"text", record::clean_text(text)}});
  return list;
}

List facts(const std::vector<Fact>& all) {
  List list;
  for (const Fact& fact : all) {
    list.emplace_back(object{{"name", record::clean_text(fact.name)}, {"value", record::clean_text(fact.value)}});
  }
  return list;
}

data no_or_yes(bool is_so) { return is_so ? data(data::type::bool_true) : data(data::type::bool_false); }

object empty_block(const std::string& title) {
  return {{"title", record::clean_text(title)},
          {"is_figure", no_or_yes(false)},
          {"is_table", no_or_yes(false)},
          {"is_notes", no_or_yes(false)}};
}

data cell(const Table& table, const Row& row, std::size_t index) {
  const bool has_link = index == 0 && !row.link.empty();
  return object{{"text", record::clean_text(row.cells[index])},
                {"is_number", no_or_yes(!row.is_heading && table.columns[index].is_number)},
                {"is_heading", no_or_yes(row.is_heading)},
                {"across", std::to_string(table.columns.size())},
                {"has_link", no_or_yes(has_link)},
                {"link", has_link ? row.link + ".html" : std::string()}};
}

/// Fills in the data of one kind of block.
struct BlockData {
  object operator()(const Table& table) const {
    object block = empty_block(table.title);
    block["is_table"] = no_or_yes(true);
    List heads;
    for (const Column& column : table.columns) {
      heads.emplace_back(object{{"text", record::clean_text(column.head)}, {"is_number", no_or_yes(column.is_number)}});
    }
    List rows;
    for (const Row& row : table.rows) {
      List cells;
      for (std::size_t index = 0; index < std::min(row.cells.size(), table.columns.size()); ++index)
        cells.push_back(cell(table, row, index));
      rows.emplace_back(object{{"cells", data(cells)}});
    }
    block["heads"] = data(heads);
    block["rows"] = data(rows);
    block["footnotes"] = data(texts(table.footnotes));
    return block;
  }
  object operator()(const Figure& figure) const {
    object block = empty_block(figure.title);
    block["is_figure"] = no_or_yes(true);
    pugi::xml_document document;
    Canvas canvas = new_picture(document, figure.width_mm, figure.height_mm, figure.title);
    figure.draw(canvas);
    block["svg"] = text_of(document, false);
    return block;
  }
  object operator()(const Notes& notes) const {
    object block = empty_block(notes.title);
    block["is_notes"] = no_or_yes(true);
    block["items"] = data(texts(notes.items));
    return block;
  }
};

/// Tables need more width than pictures before two of them can be side by side.
std::string kind_of(const Section& section) {
  if (section.columns.size() < 2) return "one";
  const bool has_tables = std::ranges::any_of(section.columns, [](const std::vector<Block>& column) {
    return std::ranges::any_of(column, [](const Block& block) { return !std::holds_alternative<Figure>(block); });
  });
  return has_tables ? "tables" : "pictures";
}

List sections(const std::vector<Section>& all) {
  List list;
  for (const Section& section : all) {
    List columns;
    for (const auto& column : section.columns) {
      List blocks;
      for (const Block& block : column) blocks.emplace_back(std::visit(BlockData{}, block));
      columns.emplace_back(object{{"blocks", data(blocks)}});
    }
    list.emplace_back(object{{"kind", kind_of(section)}, {"columns", data(columns)}});
  }
  return list;
}

}  // namespace

std::string html_of(const PageContent& content) {
  kainjow::mustache::mustache page(kPageTemplate);
  object values{{"language", std::string(code(content.language))},
                {"mark", std::string(kPageMark)},
                {"title", record::clean_text(content.title)},
                {"subtitle", no_or_yes(false)},
                {"facts", data(facts(content.facts))},
                {"alerts", data(texts(content.alerts))},
                {"sections", data(sections(content.sections))},
                {"intended_use", Translation(content.language, {})(kIntendedUse)}};
  if (!content.subtitle.empty()) values["subtitle"] = record::clean_text(content.subtitle);
  return page.render(data(values));
}

}  // namespace dts::report
