// SPDX-License-Identifier: Apache-2.0
#include "ctl/record_commands.h"

#include <unistd.h>

#include <iostream>
#include <string>

#include "cli/table.h"
#include "ctl/ask.h"
#include "ctl/recording_view.h"
#include "ctl/session_view.h"
#include "ctl/subject_commands.h"

namespace dts::ctl {
namespace {

using client::ControlClient;

/// Prints the newest corrections of a session: those with the time of the last one.
void print_newest(cli::Console& console, const v1::SessionRecord& session) {
  if (session.corrections_size() == 0) return;
  const auto newest_ns = session.corrections(session.corrections_size() - 1).utc_ns();
  for (const v1::Correction& correction : session.corrections()) {
    if (correction.utc_ns() == newest_ns) console.out << cli::printable(correction_text(correction)) << '\n';
  }
}

int send_deletion(const Arguments& arguments, cli::Console& console, bool is_restore) {
  v1::DeleteSessionRequest request;
  request.set_session_id(arguments.session.id);
  request.set_reason(arguments.session.reason);
  request.set_is_restore(is_restore);
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.delete_session(request); },
      [&](const v1::SessionRecord& session) {
        console.out << (is_restore ? "restored " : "deleted ") << cli::printable(session.session_id()) << '\n';
        if (!is_restore) {
          cli::print_hint(console, "its recording stays on the disk; undo: dtsctl session restore " + cli::printable(session.session_id()));
        }
      });
}

void print_subject(cli::Console& console, const v1::SubjectRecord& subject) {
  print_field(console, "subject", subject.about().subject());
  print_field(console, "sessions", std::to_string(subject.about().sessions()));
  if (subject.about().deleted_sessions() > 0) print_field(console, "deleted", std::to_string(subject.about().deleted_sessions()));
  print_field(console, "recordings", bytes_text(subject.about().bytes()));
  if (subject.sessions_size() > 0) {
    v1::ListSessionsResponse list;
    *list.mutable_sessions() = subject.sessions();
    console.out << '\n';
    print_sessions(console, list);
  }
  if (subject.plan_size() > 0) console.out << '\n';
  print_plan(console, subject);
  if (subject.notes_size() > 0) console.out << '\n';
  print_notes(console, subject);
  if (subject.mentioning_sessions_size() > 0) {
    console.out << "\nthe subject ID also occurs in:";
    for (const std::string& id : subject.mentioning_sessions()) console.out << "\n  " << cli::printable(id);
    console.out << '\n';
  }
  if (subject.unsearched_sessions() == 0) return;
  console.out << '\n'
              << counted(subject.unsearched_sessions(), "further session") << " may contain the subject ID: an erasure searches all\n";
}

void print_erased(cli::Console& console, const v1::EraseSubjectResponse& erased) {
  console.out << "erased: " << counted(erased.sessions(), "session") << ", " << counted(erased.files(), "file") << ", "
              << bytes_text(erased.bytes());
  if (erased.mentions() > 0) console.out << ", mentions in " << counted(erased.mentions(), "other session");
  console.out << '\n';
  for (const std::string& left : erased.left()) {
    console.out << cli::styled(console, cli::Style::Warning, "not erased: " + cli::printable(left)) << '\n';
  }
  console.out << "backups: " << cli::wrapped_at(console, 9, cli::printable(erased.backups())) << '\n';
}

/// Returns true if a person on a terminal has typed the subject ID again.
bool is_confirmed(const v1::SubjectRecord& subject, cli::Console& console) {
  print_subject(console, subject);
  console.talk << "\nAll of this is erased for ever. Type the subject ID to continue: " << std::flush;
  std::string typed;
  return std::getline(std::cin, typed) && typed == subject.about().subject();
}

}  // namespace

int run_session_edit(const Arguments& arguments, cli::Console& console) {
  const EditArguments& edit = arguments.edit;
  if (!edit.subject && !edit.label && !edit.notes && edit.trial == 0 && edit.marker == 0) {
    cli::print_error(console, "session edit: nothing to correct",
                     "give --subject, --label, --notes, --trial with --outcome, or --marker with --text");
    return cli::kUsage;
  }
  if (edit.marker > 0 && edit.text.has_value() == edit.is_removal) {
    cli::print_error(console, "session edit: --marker needs either --text or --remove", "give the right text, or --remove");
    return cli::kUsage;
  }
  v1::CorrectSessionRequest request;
  request.set_session_id(arguments.session.id);
  if (edit.subject) request.set_subject(*edit.subject);
  if (edit.label) request.set_label(*edit.label);
  if (edit.notes) request.set_notes(*edit.notes);
  request.set_trial(edit.trial);
  request.set_attempt(edit.attempt);
  request.set_part(edit.part);
  request.set_outcome(edit.outcome);
  request.set_marker(edit.marker);
  if (edit.marker > 0) request.set_marker_text(edit.text.value_or(""));
  request.set_reason(arguments.session.reason);
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.correct_session(request); },
      [&](const v1::SessionRecord& session) { print_newest(console, session); });
}

int run_session_delete(const Arguments& arguments, cli::Console& console) { return send_deletion(arguments, console, false); }

int run_session_restore(const Arguments& arguments, cli::Console& console) { return send_deletion(arguments, console, true); }

int run_subject_list(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [](ControlClient& dts) { return dts.list_subjects(); },
      [&](const v1::ListSubjectsResponse& subjects) {
        cli::Table table({"SUBJECT", ">SESSIONS", ">DELETED", "FIRST (UTC)", "LAST (UTC)", ">SIZE"});
        for (const v1::SubjectInfo& subject : subjects.subjects()) {
          table.add({{subject.subject(), cli::Style::Bold},
                     {std::to_string(subject.sessions())},
                     {std::to_string(subject.deleted_sessions())},
                     {utc_text(subject.first_utc_ns())},
                     {utc_text(subject.last_utc_ns())},
                     {bytes_text(subject.bytes())}});
        }
        if (subjects.subjects_size() == 0) console.out << "no subjects\n";
        table.print(console);
        if (subjects.more_subjects() == 0) return;
        console.out << "and " << counted(subjects.more_subjects(), "further subject") << ": see dtsctl subject show ID\n";
      });
}

int run_subject_show(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.show_subject(arguments.session.id); },
      [&](const v1::SubjectRecord& subject) { print_subject(console, subject); });
}

int run_subject_erase(const Arguments& arguments, cli::Console& console) {
  const std::string& subject = arguments.session.id;
  if (!arguments.edit.is_confirmed) {
    if (::isatty(STDIN_FILENO) == 0 || !console.is_talk_terminal) {
      cli::print_error(console, "subject erase: nothing was erased, because nobody can be asked here",
                       "look first: dtsctl subject show " + cli::printable(subject) + "; then add --yes");
      return cli::kUsage;
    }
    auto dts = connect(arguments);
    if (!dts) return cli::fail_with(console, dts.error());
    const auto found = dts->show_subject(subject);
    if (!found) return cli::fail_with(console, found.error());
    if (!is_confirmed(*found, console)) {
      cli::print_error(console, "this is not the subject ID: nothing was erased");
      return cli::kUsage;
    }
  }
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.erase_subject(subject); },
      [&](const v1::EraseSubjectResponse& erased) { print_erased(console, erased); });
}

}  // namespace dts::ctl
