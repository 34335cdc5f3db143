// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/Formatter.hpp>
#include <string>

namespace dts::cli {

/// Help with the examples first: that is what most readers look for (clig.dev).
class HelpFormatter : public CLI::Formatter {
 public:
  [[nodiscard]] std::string make_help(const CLI::App* command, std::string name, CLI::AppFormatMode mode) const override;
};

}  // namespace dts::cli
