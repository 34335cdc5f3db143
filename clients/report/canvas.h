// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <pugixml.hpp>
#include <string>
#include <string_view>

namespace dts::report {

/// Palette of Okabe & Ito: distinguishable for colour-blind people, and in grey.
namespace colour {
inline constexpr std::string_view kBlack = "#000000";
inline constexpr std::string_view kBlue = "#0072B2";
inline constexpr std::string_view kVermillion = "#D55E00";
inline constexpr std::string_view kGreen = "#009E73";
inline constexpr std::string_view kDarkGrey = "#555555";
inline constexpr std::string_view kGrey = "#999999";
inline constexpr std::string_view kGrid = "#DDDDDD";
inline constexpr std::string_view kShade = "#EEEEEE";
inline constexpr std::string_view kWarningShade = "#FDF1E8";
inline constexpr std::string_view kNone = "none";
}  // namespace colour

struct Stroke {
  std::string_view colour = colour::kBlack;
  double width = 0.2;
  std::string_view dash{};  ///< "1 0.5"
};

enum class Anchor { Start, Middle, End };

inline constexpr double kSmallText = 2.1;  ///< mm: text of axes and legends.

struct TextStyle {
  double size = 2.4;  ///< mm
  Anchor anchor = Anchor::Start;
  std::string_view colour = colour::kBlack;
  bool is_bold = false;
  bool is_upward = false;  ///< Rotated by 90 degrees counter-clockwise about its anchor.
};

/// Draws into one SVG element. mm, x to the right, y down. All texts are cleaned and escaped.
class Canvas {
 public:
  explicit Canvas(pugi::xml_node node) : node_(node) {}

  /// Returns a canvas with its own origin.
  [[nodiscard]] Canvas group(double x, double y);
  void line(double x1, double y1, double x2, double y2, const Stroke& stroke);
  void rect(double x, double y, double width, double height, std::string_view fill, const Stroke& stroke);
  void circle(double x, double y, double radius, std::string_view fill, const Stroke& stroke);
  /// Rotated by `angle_deg` counter-clockwise.
  void ellipse(double x, double y, double semi_major, double semi_minor, double angle_deg, const Stroke& stroke);
  void path(const std::string& data, const Stroke& stroke);
  void text(double x, double y, std::string_view text, const TextStyle& style = {});

  using Translate = std::function<std::string(std::string_view)>;
  /// Returns a canvas at the same place that translates each text.
  [[nodiscard]] Canvas translated(Translate translate) const;

 private:
  pugi::xml_node node_;
  Translate translate_{};
};

/// Adds an empty <svg> of `width` by `height` mm to the document; a screen reader reads `title`.
[[nodiscard]] Canvas new_picture(pugi::xml_document& document, double width, double height, const std::string& title);
/// Returns the text with or without the XML declaration, one element per line.
[[nodiscard]] std::string text_of(const pugi::xml_document& document, bool with_declaration);

/// Returns a rather large estimate of the width in common sans-serif fonts, for line breaks.
[[nodiscard]] double text_width(std::string_view text, double size) noexcept;

}  // namespace dts::report
