// SPDX-License-Identifier: Apache-2.0
#include "ctl/subject_commands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cli/table.h"
#include "ctl/ask.h"
#include "ctl/recording_view.h"
#include "report/result_names.h"
#include "visits/document.h"
#include "visits/plain_words.h"
#include "visits/retest.h"
#include "visits/series.h"

namespace dts::ctl {
namespace {

using client::ControlClient;

/// What `trend` shows without `--measure`.
constexpr std::array<std::string_view, 5> kUsualMeasures{"MVELO", "PEA95_F", "trunk_mean_deg", "trunk_class", "trunk_sd_deg"};

bool is_wanted(const visits::Series& series, const std::string& measure) {
  if (!measure.empty()) return series.measure == measure;
  return !series.condition.starts_with("romberg") && std::ranges::find(kUsualMeasures, series.measure) != kUsualMeasures.end();
}

/// Returns "8.38", with more decimals for small values.
std::string value_text(double value) { return cli::decimal(value, std::abs(value) < 100.0 ? 2 : 0); }

std::string unit_of(const visits::Series& series) { return series.unit == "1" ? "" : " (" + series.unit + ")"; }

void print_series(cli::Console& console, const visits::Series& series) {
  const std::string condition = series.condition.empty() ? "" : series.condition + ": ";
  console.out << cli::printable(series.rig + ", " + series.protocol + ", " + condition + report::plain_name(series.measure) +
                                unit_of(series))
              << '\n';
  cli::Table points({"DATE (UTC)", ">VALUE", ">SD", ">TRIALS", "SESSION", "NOTE"});
  for (const visits::Point& point : series.points) {
    points.add({{utc_text(point.utc_ns)},
                {value_text(point.value), cli::Style::Bold},
                {point.spread ? value_text(*point.spread) : "-"},
                {point.trials > 0 ? std::to_string(point.trials) : "-"},
                {point.session_id},
                {point.is_comparable ? "" : "other settings: do not compare", cli::Style::Warning}});
  }
  points.may_drop({"SESSION", "TRIALS", "SD"});
  points.print(console);
  if (const visits::Retest* const retest = visits::retest_of(series)) {
    const std::string known = "known variation between two days: " + cli::decimal(retest->percent, 0) + " % (" + retest->source + ")";
    console.out << cli::wrapped_at(console, 0, known) << '\n';
  }
  console.out << '\n';
}

void print_trend(const Arguments& arguments, cli::Console& console, const v1::SubjectRecord& subject, const visits::Titles& titles) {
  const auto all = visits::series_of(subject);
  std::vector<visits::Series> wanted;
  std::ranges::copy_if(all, std::back_inserter(wanted),
                       [&](const visits::Series& one) { return is_wanted(one, arguments.subject.measure); });
  for (const visits::Series& one : wanted) print_series(console, one);
  if (wanted.empty()) {
    console.out << (arguments.subject.measure.empty() ? "no session of this subject has results\n"
                                                      : "no session of this subject has this measure\n");
    return;
  }
  const auto words = visits::words_of_changes(wanted, visits::sentences_in(arguments.subject.language), titles);
  for (const std::string& sentence : words) console.out << cli::wrapped_at(console, 0, cli::printable(sentence)) << '\n';
}

/// Sends the change, or asks for the subject if nothing is to be changed, and prints a part of the answer.
template <class View>
int edit_and_print(const Arguments& arguments, cli::Console& console, const v1::EditSubjectRequest& edit, View view) {
  const bool is_change = edit.change_case() != v1::EditSubjectRequest::CHANGE_NOT_SET;
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return is_change ? dts.edit_subject(edit) : dts.show_subject(arguments.session.id); },
      [&](const v1::SubjectRecord& subject) { view(subject); });
}

}  // namespace

void print_notes(cli::Console& console, const v1::SubjectRecord& subject) {
  cli::Table notes({">NOTE", "DATE (UTC)", "BY", "TEXT"});
  for (const v1::SubjectNote& note : subject.notes()) {
    notes.add({{std::to_string(note.number())}, {utc_text(note.utc_ns())}, {note.who()}, {note.text()}});
  }
  notes.may_drop({"BY"});
  notes.print(console);
}

void print_plan(cli::Console& console, const v1::SubjectRecord& subject) {
  cli::Table plan({">PLAN", "PROTOCOL", "DUE", "SESSION"});
  for (const v1::PlannedSession& planned : subject.plan()) {
    const bool is_due = planned.session_id().empty();
    plan.add({{std::to_string(planned.number())},
              {planned.protocol()},
              {planned.due_date().empty() ? "-" : planned.due_date()},
              {is_due ? "due" : planned.session_id(), is_due ? cli::Style::Warning : cli::Style::Good}});
  }
  plan.print(console);
}

int run_subject_trend(const Arguments& arguments, cli::Console& console) {
  auto dts = connect(arguments);
  if (!dts) return cli::fail_with(console, dts.error());
  const auto subject = dts->show_subject_results(arguments.session.id);
  if (!subject) return cli::fail_with(console, subject.error());
  const auto protocols = dts->list_protocols();
  if (!protocols) return cli::fail_with(console, protocols.error());
  if (arguments.is_json) {
    const auto& sentences = visits::sentences_in(arguments.subject.language);
    console.out << cli::document(visits::document_of(*subject, *protocols, sentences, arguments.subject.measure));
  } else {
    print_trend(arguments, console, *subject, visits::titles_of(*protocols, visits::sentences_in(arguments.subject.language)));
  }
  console.out.flush();
  return cli::kOk;
}

int run_subject_plan(const Arguments& arguments, cli::Console& console) {
  const SubjectArguments& wishes = arguments.subject;
  v1::EditSubjectRequest edit;
  edit.set_subject(arguments.session.id);
  if (!wishes.added.empty()) {
    edit.mutable_add_plan()->set_protocol(wishes.added);
    edit.mutable_add_plan()->set_due_date(wishes.due_date);
  } else if (wishes.removed > 0) {
    edit.set_remove_plan(wishes.removed);
  }
  return edit_and_print(arguments, console, edit, [&](const v1::SubjectRecord& subject) {
    if (subject.plan_size() == 0) console.out << "no session is planned\n";
    print_plan(console, subject);
  });
}

int run_subject_notes(const Arguments& arguments, cli::Console& console) {
  const SubjectArguments& wishes = arguments.subject;
  v1::EditSubjectRequest edit;
  edit.set_subject(arguments.session.id);
  if (!wishes.added.empty()) {
    edit.set_add_note(wishes.added);
  } else if (wishes.removed > 0) {
    edit.set_remove_note(wishes.removed);
  }
  return edit_and_print(arguments, console, edit, [&](const v1::SubjectRecord& subject) {
    if (subject.notes_size() == 0) console.out << "no notes\n";
    print_notes(console, subject);
  });
}

}  // namespace dts::ctl
