// SPDX-License-Identifier: Apache-2.0
#include "report/canvas.h"

#include <sstream>

#include "core/utf8.h"
#include "record/utf8_text.h"
#include "report/number_text.h"

namespace dts::report {
namespace {

constexpr int kDecimals = 2;  // 10 um on paper

void set(pugi::xml_node node, const char* name, double value) { node.append_attribute(name) = fixed(value, kDecimals).c_str(); }
void set(pugi::xml_node node, const char* name, std::string_view text) { node.append_attribute(name) = std::string(text).c_str(); }

void set(pugi::xml_node node, const Stroke& stroke) {
  set(node, "stroke", stroke.colour);
  if (stroke.colour == colour::kNone) return;
  set(node, "stroke-width", stroke.width);
  if (!stroke.dash.empty()) set(node, "stroke-dasharray", stroke.dash);
}

}  // namespace

Canvas Canvas::group(double x, double y) {
  pugi::xml_node group = node_.append_child("g");
  set(group, "transform", "translate(" + fixed(x, kDecimals) + " " + fixed(y, kDecimals) + ")");
  Canvas canvas(group);
  canvas.translate_ = translate_;
  return canvas;
}

Canvas Canvas::translated(Translate translate) const {
  Canvas canvas(node_);
  canvas.translate_ = std::move(translate);
  return canvas;
}

void Canvas::line(double x1, double y1, double x2, double y2, const Stroke& stroke) {
  pugi::xml_node line = node_.append_child("line");
  set(line, "x1", x1);
  set(line, "y1", y1);
  set(line, "x2", x2);
  set(line, "y2", y2);
  set(line, stroke);
}

void Canvas::rect(double x, double y, double width, double height, std::string_view fill, const Stroke& stroke) {
  pugi::xml_node rect = node_.append_child("rect");
  set(rect, "x", x);
  set(rect, "y", y);
  set(rect, "width", width);
  set(rect, "height", height);
  set(rect, "fill", fill);
  set(rect, stroke);
}

void Canvas::circle(double x, double y, double radius, std::string_view fill, const Stroke& stroke) {
  pugi::xml_node circle = node_.append_child("circle");
  set(circle, "cx", x);
  set(circle, "cy", y);
  set(circle, "r", radius);
  set(circle, "fill", fill);
  set(circle, stroke);
}

void Canvas::ellipse(double x, double y, double semi_major, double semi_minor, double angle_deg, const Stroke& stroke) {
  pugi::xml_node ellipse = node_.append_child("ellipse");
  ellipse.append_attribute("rx") = fixed(semi_major, 3).c_str();
  ellipse.append_attribute("ry") = fixed(semi_minor, 3).c_str();
  set(ellipse, "transform",
      "translate(" + fixed(x, kDecimals) + " " + fixed(y, kDecimals) + ") rotate(" + fixed(-angle_deg, kDecimals) + ")");
  set(ellipse, "fill", colour::kNone);
  set(ellipse, stroke);
}

void Canvas::path(const std::string& data, const Stroke& stroke) {
  if (data.empty()) return;
  pugi::xml_node path = node_.append_child("path");
  set(path, "d", data);
  set(path, "fill", colour::kNone);
  set(path, stroke);
  set(path, "stroke-linejoin", "round");
}

void Canvas::text(double x, double y, std::string_view text, const TextStyle& style) {
  pugi::xml_node node = node_.append_child("text");
  set(node, "x", x);
  set(node, "y", y);
  set(node, "font-size", style.size);
  if (style.anchor != Anchor::Start) set(node, "text-anchor", style.anchor == Anchor::Middle ? "middle" : "end");
  if (style.is_bold) set(node, "font-weight", "bold");
  if (style.colour != colour::kBlack) set(node, "fill", style.colour);
  if (style.is_upward) set(node, "transform", "rotate(-90 " + fixed(x, kDecimals) + " " + fixed(y, kDecimals) + ")");
  node.append_child(pugi::node_pcdata).set_value(record::clean_text(translate_ ? translate_(text) : std::string(text)).c_str());
}

Canvas new_picture(pugi::xml_document& document, double width, double height, const std::string& title) {
  pugi::xml_node svg = document.append_child("svg");
  set(svg, "xmlns", "http://www.w3.org/2000/svg");
  set(svg, "width", fixed(width, 0) + "mm");
  set(svg, "height", fixed(height, 0) + "mm");
  set(svg, "viewBox", "0 0 " + fixed(width, kDecimals) + " " + fixed(height, kDecimals));
  set(svg, "role", "img");
  set(svg, "font-family", "sans-serif");
  svg.append_child("title").append_child(pugi::node_pcdata).set_value(record::clean_text(title).c_str());
  return Canvas(svg);
}

std::string text_of(const pugi::xml_document& document, bool with_declaration) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  if (with_declaration) text << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  document.save(text, "", pugi::format_indent | pugi::format_no_declaration, pugi::encoding_utf8);
  return std::move(text).str();
}

double text_width(std::string_view text, double size) noexcept {
  constexpr std::string_view kNarrow = "iljtfrI.,:;'|!()[] -";
  constexpr std::string_view kWide = "mwMW%@";
  double em = 0.0;
  for (const char letter : text) {
    if (!core::starts_character(letter)) continue;
    if (kNarrow.find(letter) != std::string_view::npos)
      em += 0.36;
    else if (kWide.find(letter) != std::string_view::npos)
      em += 0.92;
    else if (letter >= 'A' && letter <= 'Z')
      em += 0.69;
    else
      em += 0.61;
  }
  return em * size;
}

}  // namespace dts::report
