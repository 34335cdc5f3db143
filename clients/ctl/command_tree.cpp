// SPDX-License-Identifier: Apache-2.0
#include "ctl/command_tree.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <charconv>
#include <cmath>

#include "ctl/commands.h"
#include "ctl/doctor.h"
#include "ctl/documents.h"
#include "ctl/help_formatter.h"
#include "ctl/watch.h"

namespace dts::ctl {
namespace {

/// CLI11's own range check lets "nan" through.
CLI::Validator number_between(double minimum, double maximum, const std::string& unit) {
  const auto check = [=](std::string& text) -> std::string {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size() && value >= minimum && value <= maximum) return {};
    return "'" + text + "' is not a number of " + unit + " from " + CLI::detail::to_string(minimum) + " to " +
           CLI::detail::to_string(maximum);
  };
  return {check, "", "number"};
}

CLI::Validator count_from_one() {
  const auto check = [](std::string& text) -> std::string {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size() && value > 0) return {};
    return "'" + text + "' is not a whole number from 1";
  };
  return {check, "", "count"};
}

CLI::Validator text_of(std::size_t minimum, std::size_t maximum) {
  const auto check = [=](std::string& text) -> std::string {
    if (text.size() >= minimum && text.size() <= maximum) return {};
    return "a text of " + std::to_string(minimum) + " to " + std::to_string(maximum) + " bytes is needed";
  };
  return {check, "", "text"};
}

/// Adds a command. `examples`: lines of "command | purpose".
CLI::App* add(CLI::App& parent, const std::string& name, const std::string& description, const std::string& examples) {
  CLI::App* command = parent.add_subcommand(name, description);
  command->footer(examples);
  return command;
}

CLI::Option* add_rig(CLI::App& command, std::string& rig, const std::string& description) {
  return command.add_option("--rig", rig, description)->option_text("RIG");
}

void add_globals(CommandTree& tree) {
  CLI::App& app = tree.app;
  app.add_option("--endpoint", tree.arguments.endpoint, "Control address of the daemon, ipc:///path/control.sock or tcp://host:port")
      ->option_text("URI");
  app.add_option("--data", tree.arguments.data, "Data address; found beside the control socket when not given")->option_text("URI");
  app.add_option("--timeout", tree.arguments.timeout_s,
                 "Give up after S seconds: a command without answer (3), a stream without data (never)")
      ->option_text("S")
      ->check(number_between(0.03, 86400.0, "seconds"));
  app.add_flag("--json", tree.arguments.is_json, "Print one JSON document");
  app.set_version_flag("--version", "dtsctl " + std::string(client::version()), "Print the version");
}

void add_rigs_and_devices(CommandTree& tree) {
  CLI::App* rig = add(tree.app, "rig", "What is set up", "dtsctl rig list | the rigs of this daemon\n");
  rig->require_subcommand(1);
  CLI::App* list = add(*rig, "list", "List the rigs", "dtsctl rig list | name, kind, device and streams of each rig\n");
  tree.handlers.emplace_back(list, run_rig_list);
  CLI::App* show =
      add(*rig, "show", "Show one rig: plate, sensors, streams, stages, state", "dtsctl rig show floor | everything about one rig\n");
  show->add_option("RIG", tree.arguments.rig, "Name of the rig")->required()->option_text(" ");
  tree.handlers.emplace_back(show, run_rig_show);

  CLI::App* device = add(tree.app, "device", "The measuring hardware", "dtsctl device test floor | are all sensors well?\n");
  device->require_subcommand(1);
  list = add(*device, "list", "List devices and the kinds that can be configured",
             "dtsctl device list | model, serial and state of each device\n");
  tree.handlers.emplace_back(list, run_device_list);
  CLI::App* test = add(*device, "test", "Measure each channel of a rig's device over the last second",
                       "dtsctl device test floor | mean, noise and gap of each sensor\n");
  test->add_option("RIG", tree.arguments.rig, "Name of the rig")->required()->option_text(" ");
  tree.handlers.emplace_back(test, run_device_test);
}

void add_sessions(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* session = add(tree.app, "session", "Start and stop sessions",
                          "dtsctl session start --rig floor | begin; prints the session's id\ndtsctl session stop | end it\n");
  session->require_subcommand(1);
  CLI::App* start = add(*session, "start", "Start a session and print its id",
                        "dtsctl session start --rig floor | until stopped\n"
                        "dtsctl session start --rig floor --duration 25 --settle 5 | 5 s to settle, then 25 s\n"
                        "dtsctl session start --rig chair --subject P017 --label \"eyes closed\" | with a pseudonym and a note\n");
  add_rig(*start, arguments.rig, "Rig to use")->required();
  start->add_option("--protocol", arguments.protocol, "Protocol to follow (free)")->option_text("NAME");
  start->add_option("--subject", arguments.subject, "Pseudonym given by the clinic, never a name")->option_text("PSEUDONYM");
  start->add_option("--label", arguments.label, "Free text, never a name")->option_text("TEXT")->check(text_of(0, 200));
  start->add_option("--duration", arguments.duration_s, "Stop by itself after S seconds")
      ->option_text("S")
      ->check(number_between(0.0, 604800.0, "seconds"));
  start->add_option("--settle", arguments.settle_s, "Time to settle before the session counts (0)")
      ->option_text("S")
      ->check(number_between(0.0, 3600.0, "seconds"));
  tree.handlers.emplace_back(start, run_session_start);
  CLI::App* stop = add(*session, "stop", "Stop a session",
                       "dtsctl session stop | the only session under way\ndtsctl session stop --rig floor | the one of this rig\n");
  add_rig(*stop, arguments.rig, "Rig of the session; needed when several have one");
  tree.handlers.emplace_back(stop, run_session_stop);
}

void add_actions(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* mark = add(tree.app, "mark", "Put a marker on the newest scan",
                       "dtsctl mark \"eyes closed\" | in the data of every rig\ndtsctl mark step --rig floor | of one rig\n");
  mark->add_option("TEXT", arguments.text, "Text of the marker; put several words in quotes")
      ->required()
      ->option_text(" ")
      ->check(text_of(1, 200));
  add_rig(*mark, arguments.rig, "Mark only this rig");
  tree.handlers.emplace_back(mark, run_mark);
  CLI::App* tare = add(tree.app, "tare", "Take the present deflections as zero; nobody on the plate",
                       "dtsctl tare --rig floor | with the plate empty\n");
  add_rig(*tare, arguments.rig, "Rig to tare")->required();
  tree.handlers.emplace_back(tare, run_tare);
}

void add_watch(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* watch = add(tree.app, "watch", "Show live samples and events",
                        "dtsctl watch | everything, as a live table\n"
                        "dtsctl watch floor/cop | the centre of pressure of the floor platform\n"
                        "dtsctl watch floor/cop --count 200 --jsonl > cop.jsonl | 200 scans for a program\n"
                        "dtsctl watch floor/gap floor/marker | only when something happens\n"
                        "dtsctl watch dtsd/status --count 1 --jsonl | the daemon's own state\n");
  watch->add_option("TOPIC-PREFIX", arguments.topics, "Topics that begin so: RIG/STREAM, RIG/EVENT, RIG/ (everything but dtsd/status)")
      ->option_text("...");
  watch->add_option("--count", arguments.count, "End after N scans; an event counts as one")->option_text("N")->check(count_from_one());
  watch->add_flag("--jsonl", arguments.is_jsonl, "One JSON object per line");
  watch->add_flag("--latest", arguments.is_latest, "After a pause show only the newest block of each stream");
  tree.handlers.emplace_back(watch, run_watch);
}

void add_help(CommandTree& tree) {
  CLI::App* doctor =
      add(tree.app, "doctor", "Check daemon, rigs and this machine; say how to mend what is wrong", "dtsctl doctor | one line per check\n");
  tree.handlers.emplace_back(doctor, run_doctor);
  CLI::App* completion = add(tree.app, "completion", "Print the completion script of a shell",
                             "dtsctl completion bash > ~/.local/share/bash-completion/completions/dtsctl | for bash\n"
                             "dtsctl completion zsh > ~/.zfunc/_dtsctl | for zsh, with ~/.zfunc in fpath\n");
  completion->add_option("SHELL", tree.arguments.shell, "bash or zsh")->required()->option_text(" ")->check(CLI::IsMember({"bash", "zsh"}));
  tree.handlers.emplace_back(completion, run_completion);
  CLI::App* manual = add(tree.app, "man", "Print the manual page", "dtsctl man | man -l - | read it\n");
  tree.handlers.emplace_back(manual, run_manual);
}

}  // namespace

std::unique_ptr<CommandTree> make_command_tree() {
  auto tree = std::make_unique<CommandTree>();
  CLI::App& app = tree->app;
  app.name("dtsctl");
  app.description("Command line of dtsd, the distributive tactile sensing daemon");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "Print this help");
  app.fallthrough();
  app.require_subcommand(1);
  app.footer(
      "dtsctl status | is everything working?\n"
      "dtsctl watch floor/cop | see the centre of pressure live\n"
      "dtsctl session start --rig floor | begin a session\n"
      "dtsctl mark \"eyes closed\" | note a moment\n"
      "dtsctl session stop | end the session\n"
      "dtsctl tare --rig floor | zero the empty plate\n"
      "dtsctl doctor | what is wrong, and how to mend it\n");
  add_globals(*tree);
  tree->handlers.emplace_back(add(app, "status", "State of daemon, rigs, devices, sessions, rates and losses",
                                  "dtsctl status | for people\ndtsctl status --json | for programs\n"),
                              run_status);
  add_rigs_and_devices(*tree);
  add_sessions(*tree);
  add_actions(*tree);
  add_watch(*tree);
  add_help(*tree);
  return tree;
}

std::vector<Example> examples(const CLI::App& command) {
  std::vector<Example> found;
  std::istringstream lines(command.get_footer());
  for (std::string line; std::getline(lines, line);) {
    const std::size_t bar = line.rfind(" | ");
    if (bar != std::string::npos) found.push_back({line.substr(0, bar), line.substr(bar + 3)});
  }
  return found;
}

std::vector<const CLI::App*> subcommands(const CLI::App& command) { return command.get_subcommands({}); }

std::vector<const CLI::Option*> options(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

std::vector<const CLI::Option*> positionals(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::string option_label(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name();
  const std::string names = option.get_name(false, true);
  return option.get_items_expected_max() == 0 ? names : names + " " + option.get_option_text();
}

std::string full_name(const CLI::App& command) {
  return command.get_parent() == nullptr ? command.get_name() : full_name(*command.get_parent()) + " " + command.get_name();
}

std::string usage(const CLI::App& command) {
  std::string text = full_name(command);
  if (!subcommands(command).empty()) return text + " COMMAND";
  for (const CLI::Option* option : options(command)) {
    if (option->get_required()) text += " " + option_label(*option);
  }
  text += " [OPTIONS]";
  for (const CLI::Option* positional : positionals(command)) {
    const std::string& name = positional->get_name();
    text += positional->get_required() ? " " + name : " [" + name + " ...]";
  }
  return text;
}

}  // namespace dts::ctl
