// SPDX-License-Identifier: Apache-2.0
#include "lab/base/command.h"

#include "cli/validators.h"

namespace dts::lab {

void add_json(CLI::App& command, bool& is_json) { command.add_flag("--json", is_json, "Print one JSON document"); }

void add_plot(CLI::App& command, std::string& file, const std::string& what) {
  command.add_option("--plot", file, what + "; .svg or .png (needs gnuplot)")->option_text("FILE");
}

void add_linear(CLI::App& command, bool& is_linear) {
  command.add_flag("--linear", is_linear, "Use linear thin-plate theory, without stiffening by stretching");
}

void add_seed(CLI::App& command, std::uint32_t& seed, const std::string& what) {
  command.add_option("--seed", seed, what + "; default: 1")->option_text("N")->check(cli::whole_number_between(0, 4294967295));
}

void add_rig(CLI::App& command, std::string& file, const std::string& what) {
  command.add_option("--rig", file, what)->option_text("FILE");
}

}  // namespace dts::lab
