// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/Formatter.hpp>
#include <string>

#include "cli/command_line.h"

namespace dts::cli {

/// Help with the examples first: that is what most readers look for (clig.dev).
class HelpFormatter : public CLI::Formatter {
 public:
  /// `glossaries` outlives the formatter.
  explicit HelpFormatter(const Glossaries& glossaries) : glossaries_(glossaries) {}
  [[nodiscard]] std::string make_help(const CLI::App* command, std::string name, CLI::AppFormatMode mode) const override;

 private:
  const Glossaries& glossaries_;
};

}  // namespace dts::cli
