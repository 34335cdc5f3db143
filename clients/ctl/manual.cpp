// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "ctl/documents.h"
#include "ctl/exit_status.h"

namespace dts::ctl {
namespace {

/// Text for roff: a backslash, a hyphen that can be copied, and no line that starts as a macro.
std::string roff(const std::string& text) {
  std::string safe;
  for (const char letter : text) {
    if (safe.empty() && (letter == '.' || letter == '\'')) safe += "\\&";
    if (letter == '\\') {
      safe += "\\e";
    } else if (letter == '-') {
      safe += "\\-";
    } else if (letter == '"') {
      safe += "\\(dq";  // a plain one would group the words of a macro
    } else {
      safe += letter;
    }
  }
  return safe;
}

std::string tagged(const std::string& tag, const std::string& text) { return ".TP\n.B " + roff(tag) + "\n" + roff(text) + "\n"; }

std::string option_text(const CLI::Option& option) {
  return tagged(option_label(option), option.get_description() + (option.get_required() ? " (required)." : "."));
}

std::string example_text(const CLI::App& command) {
  std::string text;
  for (const Example& example : examples(command))
    text += tagged(example.command, example.purpose + (example.purpose.ends_with('?') ? "" : "."));
  return text;
}

/// A command that does something; groups like "session" are only the way to theirs.
void describe(const CLI::App& command, std::string& text) {
  for (const CLI::App* subcommand : subcommands(command)) describe(*subcommand, text);
  if (command.get_parent() == nullptr || !subcommands(command).empty()) return;
  text += ".SS " + roff(usage(command)) + "\n" + roff(command.get_description()) + ".\n";
  for (const CLI::Option* positional : positionals(command)) text += option_text(*positional);
  for (const CLI::Option* option : options(command)) {
    if (option != command.get_help_ptr()) text += option_text(*option);
  }
  text += ".PP\nExamples:\n" + example_text(command);
}

std::string environment() {
  return ".SH ENVIRONMENT\n" + tagged("DTSD_CONTROL, DTSD_DATA", "Addresses of the daemon's control and data sockets.") +
         tagged("DTSD_RUNTIME_DIR", "Directory of the daemon's sockets, control.sock and data.sock.") +
         tagged("XDG_RUNTIME_DIR", "Its subdirectory dtsd is looked into when there is no daemon of the system.") +
         tagged("NO_COLOR", "Set: no colours.");
}

std::string exit_statuses() {
  std::string text = ".SH EXIT STATUS\n";
  for (const auto& [status, meaning] : kExitMeanings) text += tagged(std::to_string(status), std::string(meaning) + ".");
  return text;
}

std::string json_text() {
  return ".SH JSON\nNumbers are numbers. What is undefined is absent; an undefined value among samples is null. Lines of\n.B watch "
         "\\-\\-jsonl\nhave the keys topic, rig, stream, segment, first_scan, rate_hz, host_time_ns, sequence, lost_scans (missed by this "
         "client just before), age_ms, quality (doubtful channels only), channels, units and values, one array per scan.\nEvents have "
         "their "
         "own fields under event, with kind saying which they are.\n";
}

}  // namespace

std::string manual_page(const CLI::App& root) {
  std::string text = ".TH DTSCTL 1 \"\" \"dtsctl " + std::string(client::version()) + "\" \"User Commands\"\n";
  text += ".SH NAME\ndtsctl \\- command line of the distributive tactile sensing daemon\n";
  text += ".SH SYNOPSIS\n.B dtsctl\n[\\fIOPTIONS\\fR] \\fICOMMAND\\fR [\\fIARGUMENTS\\fR]\n";
  text +=
      ".SH DESCRIPTION\nTalks to a running\n.BR dtsd (8):\nshows its state and its live data, starts and stops sessions, sets markers.\n";
  text += "Results go to standard output, everything else to standard error.\n";
  text += ".SH EXAMPLES\n" + example_text(root);
  text += ".SH COMMANDS\n";
  describe(root, text);
  text += ".SH OPTIONS\nThey may stand before or after the command.\n";
  for (const CLI::Option* option : options(root)) text += option_text(*option);
  text += environment() + exit_statuses() + json_text();
  text += ".SH FILES\n" + tagged("/run/dtsd/control.sock, /run/dtsd/data.sock", "Sockets of the daemon of the system.");
  return text + ".SH SEE ALSO\n.BR dtsd (8),\n.BR jq (1)\n";
}

int run_manual(const CommandTree& tree, Console& console) {
  console.out << manual_page(tree.app) << std::flush;
  if (console.is_out_terminal) print_hint(console, "read it: dtsctl man | man -l -");
  return kOk;
}

}  // namespace dts::ctl
