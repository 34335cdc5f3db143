// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/Formatter.hpp>
#include <string>

#include "cli/command_line.h"

namespace dts::cli {

/// Prints help with the examples first, because most readers look for examples (clig.dev).
class HelpFormatter : public CLI::Formatter {
 public:
  /// `glossaries` must outlive the formatter.
  explicit HelpFormatter(const Glossaries& glossaries) : glossaries_(glossaries) {}
  [[nodiscard]] std::string make_help(const CLI::App* command, std::string name, CLI::AppFormatMode mode) const override;

 private:
  const Glossaries& glossaries_;
};

}  // namespace dts::cli
