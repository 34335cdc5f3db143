// SPDX-License-Identifier: Apache-2.0
#include "ctl/session_commands.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "cli/suggestion.h"
#include "cli/table.h"
#include "cli/try.h"
#include "ctl/ask.h"
#include "ctl/recording_view.h"
#include "ctl/session_csv.h"
#include "ctl/session_view.h"
#include "ctl/status_view.h"

namespace dts::ctl {
namespace {

using client::ControlClient;
using client::ErrorCode;
using client::Result;

/// Adds KEY=VALUE to the request. Fails if a key occurs twice.
Result<void> add_fields(const std::vector<std::string>& fields, v1::StartSessionRequest& request) {
  for (const std::string& field : fields) {
    const std::size_t equals = field.find('=');
    const std::string key = field.substr(0, equals);
    if (request.fields().contains(key)) return client::fail(ErrorCode::InvalidArgument, "field '" + key + "' is given twice");
    (*request.mutable_fields())[key] = field.substr(equals + 1);
  }
  return {};
}

/// Prints the ID, which scripts use; for people, a sentence with the ID and the next commands.
void print_begun(cli::Console& console, const v1::SessionInfo& session) {
  const std::string& id = session.session_id();
  std::vector<std::string> rigs(session.rigs().begin(), session.rigs().end());
  if (rigs.empty()) rigs.push_back(session.rig());
  const std::string where = (rigs.size() > 1 ? "rigs '" : "rig '") + cli::join(rigs, "', '") + "'";
  const std::string sentence =
      "session " + id + " has started on " + where + (session.protocol().empty() ? "" : ", protocol " + session.protocol());
  console.out << cli::printable(console.is_out_terminal ? sentence : id) << '\n';
  if (session.has_trial()) cli::print_hint(console, "first trial: dtsctl session trial next --rig " + session.rig());
  cli::print_hint(console, "stop: dtsctl session stop --rig " + session.rig() + "   watch: dtsctl watch " + session.rig() + "/");
}

void print_ended(cli::Console& console, const v1::SessionInfo& session) {
  console.out << session_line(session) << '\n';
  print_recording(console, session);
}

Result<v1::ProtocolInfo> find_protocol(const v1::ListProtocolsResponse& protocols, const std::string& name) {
  std::vector<std::string> known;
  for (const v1::ProtocolInfo& protocol : protocols.protocols()) {
    if (protocol.name() == name) return protocol;
    known.push_back(protocol.name());
  }
  return client::fail(ErrorCode::NotFound, "no protocol '" + name + "'", cli::known_words_hint(name, known));
}

v1::TrialAction action_of(const std::string& word) {
  if (word == "next") return v1::TRIAL_ACTION_NEXT;
  if (word == "undo") return v1::TRIAL_ACTION_UNDO;
  return word == "redo" ? v1::TRIAL_ACTION_REDO : v1::TRIAL_ACTION_REJECT;
}

/// Returns what the command did, if the state of the trials does not show it: "repeated: ".
std::string done_words(const std::string& action, const v1::TrialStatus& trial) {
  if (action == "undo") return "the redo or reject is taken back: ";
  if (action == "redo") return "repeated: ";
  if (trial.is_next_wanted()) return "accepted, the first trial starts in a moment: ";
  return "";
}

/// Warns before a whole session is recorded: without a tare, no reach can be classified.
void warn_untared(const v1::StatusSnapshot& status, const std::string& name, cli::Console& console) {
  for (const v1::RigStatus& rig : status.rigs()) {
    if (rig.rig().name() != name || !needs_tare(rig)) continue;
    console.talk << "dtsctl: warning: chair '" << cli::printable(name) << "' is not tared: no reach can be classified\n"
                 << "  try: stop the session, clear the chair, then tare it: dtsctl tare --rig " << cli::printable(name) << '\n';
  }
}

/// The session starts at once, but its first scan must wait for the device.
void report_wait(const v1::StatusSnapshot& status, const v1::SessionInfo& session, cli::Console& console) {
  const auto rig = find_rig(status, session.rig());
  if (!rig || rig->device() == v1::DEVICE_STATE_STREAMING) return;
  const std::string why = rig->device_message().empty() ? "its device does not stream yet" : rig->device_message();
  console.talk << "dtsctl: rig '" << cli::printable(session.rig()) << "' is waiting: " << cli::printable(why)
               << "; the session starts with the first scan" << std::endl;
}

/// Returns the ID without what people type differently: case, '_', '.' and '-'.
std::string folded(const std::string& subject) {
  std::string text;
  for (const char letter : subject) {
    if (letter == '_' || letter == '.' || letter == '-') continue;
    text += letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  }
  return text;
}

/// Warns of a new subject ID that differs from a known one only by case or punctuation: perhaps it is the same person.
void warn_similar_subject(const v1::ListSubjectsResponse& subjects, const std::string& subject, cli::Console& console) {
  const v1::SubjectInfo* similar = nullptr;
  for (const v1::SubjectInfo& known : subjects.subjects()) {
    if (known.subject() == subject) return;
    if (folded(known.subject()) == folded(subject)) similar = &known;
  }
  if (similar == nullptr) return;
  const std::string known = cli::printable(similar->subject());
  console.talk << "dtsctl: warning: subject ID '" << known << "' is known; '" << cli::printable(subject) << "' is new\n"
               << "  try: if this is the same person, correct the ID after the session: dtsctl session edit ID --subject " << known
               << " --reason TEXT" << std::endl;
}

}  // namespace

int run_session_start(const Arguments& arguments, cli::Console& console) {
  const SessionArguments& wishes = arguments.session;
  v1::StartSessionRequest request;
  request.set_rig(wishes.rigs.front());
  for (std::size_t rig = 1; rig < wishes.rigs.size(); ++rig) request.add_companions(wishes.rigs[rig]);
  request.set_protocol(wishes.protocol);
  request.set_subject(wishes.subject);
  request.set_label(wishes.label);
  request.set_duration_s(wishes.duration_s);
  request.set_settle_s(wishes.settle_s);
  if (auto added = add_fields(wishes.fields, request); !added) return cli::fail_with(console, added.error());
  return ask_and_print(
      arguments, console,
      [&](ControlClient& dts) {
        const auto status = dts.status();
        for (const std::string& rig : wishes.rigs) {
          if (status) warn_untared(*status, rig, console);
        }
        if (!request.subject().empty()) {
          if (const auto subjects = dts.list_subjects()) warn_similar_subject(*subjects, request.subject(), console);
        }
        auto session = dts.start_session(request);
        if (status && session) report_wait(*status, *session, console);
        return session;
      },
      [&](const v1::SessionInfo& session) { print_begun(console, session); });
}

int run_session_stop(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.stop_session(arguments.rig); },
      [&](const v1::SessionInfo& session) { print_ended(console, session); });
}

int run_session_abort(const Arguments& arguments, cli::Console& console) {
  v1::StopSessionRequest request;
  request.set_rig(arguments.rig);
  request.set_is_abort(true);
  request.set_reason(arguments.session.reason);
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.stop_session(request); },
      [&](const v1::SessionInfo& session) { print_ended(console, session); });
}

int run_session_resume(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.resume_session(arguments.session.id); },
      [&](const v1::SessionInfo& session) { print_begun(console, session); });
}

int run_session_list(const Arguments& arguments, cli::Console& console) {
  v1::ListSessionsRequest request;
  request.set_rig(arguments.rig);
  request.set_subject(arguments.session.subject);
  request.set_protocol(arguments.session.protocol);
  request.set_limit(arguments.session.limit);
  request.set_deleted(arguments.session.is_deleted);
  const auto ask = [&](ControlClient& dts) -> Result<v1::ListSessionsResponse> {
    auto sessions = dts.list_sessions(request);
    if (!sessions || sessions->sessions_size() > 0 || arguments.rig.empty()) return sessions;
    // A rig that was removed may still have sessions. A name without a rig and without sessions is a typing error.
    DTS_TRY(dts.status().and_then([&](const auto& status) { return find_rig(status, arguments.rig); }));
    return sessions;
  };
  return ask_and_print(arguments, console, ask, [&](const v1::ListSessionsResponse& sessions) {
    print_sessions(console, sessions);
    if (sessions.sessions_size() > 0) {
      cli::print_hint(console, "details: dtsctl session show " + cli::printable(sessions.sessions(0).session_id()));
    }
  });
}

int run_session_show(const Arguments& arguments, cli::Console& console) {
  if (arguments.is_csv && arguments.is_json) {
    cli::print_error(console, "--csv and --json exclude each other",
                     "dtsctl session show " + cli::printable(arguments.session.id) + " --csv");
    return cli::kUsage;
  }
  std::optional<double> elapsed_s;
  const auto ask = [&](ControlClient& dts) {
    auto session = dts.show_session(arguments.session.id);
    if (arguments.is_json || arguments.is_csv || !session || session->state() != "running") return session;
    const auto status = dts.status();  // the catalogue does not know how long the session runs, nor which rig is lost now
    const auto rig = status ? find_rig(*status, session->rig()) : Result<v1::RigStatus>(v1::RigStatus());
    if (rig && rig->session().session_id() == session->session_id()) {
      elapsed_s = rig->session().elapsed_s();
      session->set_message(rig->session().message());
    }
    return session;
  };
  return ask_and_print(arguments, console, ask, [&](const v1::SessionRecord& session) {
    if (arguments.is_csv) {
      console.out << trials_csv(session);
    } else {
      print_session(console, session, elapsed_s);
    }
  });
}

int run_session_trial(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.trial(action_of(arguments.session.action), arguments.rig); },
      [&](const v1::TrialStatus& trial) {
        console.out << done_words(arguments.session.action, trial) << trial_line(trial, arguments.rig) << '\n';
        if (!trial.has_undo_s()) return;
        const std::string rig = arguments.rig.empty() ? "" : " --rig " + cli::printable(arguments.rig);
        cli::print_hint(console, "take it back within " + cli::decimal(trial.undo_s(), 0) + " s: dtsctl session trial undo" + rig);
      });
}

int run_protocol_list(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [](ControlClient& dts) { return dts.list_protocols(); },
      [&](const v1::ListProtocolsResponse& protocols) {
        print_protocols(console, protocols);
        if (protocols.protocols_size() > 0) {
          cli::print_hint(console, "details: dtsctl protocol show " + cli::printable(protocols.protocols(0).name()));
        }
      });
}

int run_protocol_show(const Arguments& arguments, cli::Console& console) {
  const auto ask = [&](ControlClient& dts) {
    return dts.list_protocols().and_then([&](const auto& protocols) { return find_protocol(protocols, arguments.session.protocol); });
  };
  return ask_and_print(arguments, console, ask, [&](const v1::ProtocolInfo& protocol) { print_protocol(console, protocol); });
}

int run_audit(const Arguments& arguments, cli::Console& console) {
  std::string problem;
  const auto ask = [&](ControlClient& dts) {
    return dts.audit(arguments.session.limit).map([&](v1::GetAuditResponse&& audit) {
      problem = audit.problem();
      return std::move(audit);
    });
  };
  const int status = ask_and_print(arguments, console, ask, [&](const v1::GetAuditResponse& audit) { print_audit(console, audit); });
  if (status != cli::kOk || problem.empty()) return status;
  return cli::fail_with(console,
                        client::Error{ErrorCode::DataDamaged, "the audit trail is damaged: " + problem, "recordings are not affected"});
}

}  // namespace dts::ctl
