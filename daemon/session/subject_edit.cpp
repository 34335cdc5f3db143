// SPDX-License-Identifier: Apache-2.0
#include "session/subject_edit.h"

#include <algorithm>
#include <utility>

namespace dts::session {
namespace {

using core::ErrorCode;

constexpr std::size_t kLongestNote = 1000;

/// Changes the notes by one kind of edit. Returns why it is not possible.
class NotesEditor {
 public:
  NotesEditor(record::SubjectNotes& notes, const EditAuthor& author, std::span<const Protocol> protocols, const LabelRule& rule)
      : notes_(notes), author_(author), protocols_(protocols), rule_(rule) {}

  core::Status operator()(std::monostate /*none*/) const {
    return core::fail(ErrorCode::InvalidArgument, "the request changes nothing", "add or remove a note or a planned session");
  }
  core::Status operator()(const AddNote& add) const {
    if (add.text.empty()) return core::fail(ErrorCode::InvalidArgument, "the note is empty", "write what others must know");
    DTS_TRY(check_sentences(rule_, "text of the note", add.text, kLongestNote));
    DTS_TRY(check_room(notes_.notes.size(), record::kMostSubjectNotes, "notes"));
    notes_.notes.push_back({.number = notes_.next_number++, .utc_ns = author_.utc_ns, .who = author_.who, .text = add.text});
    return {};
  }
  core::Status operator()(const RemoveNote& remove) const { return remove_from(notes_.notes, remove.number, "note"); }
  core::Status operator()(const AddPlan& add) const {
    DTS_TRY(check_subject(rule_, notes_.subject));  // otherwise the planned session could not start
    const auto known = std::ranges::find(protocols_, add.protocol, &Protocol::name);
    if (known == protocols_.end()) {
      return core::fail(ErrorCode::NotFound, "this daemon has no such protocol", "see dtsctl protocol list");
    }
    if (!add.due_date.empty() && !record::is_date(add.due_date)) {
      return core::fail(ErrorCode::InvalidArgument, "the date is not valid", "write it as year-month-day: 2026-12-31");
    }
    DTS_TRY(check_room(notes_.plan.size(), record::kMostPlanned, "planned sessions"));
    notes_.plan.push_back(
        {.number = notes_.next_number++, .utc_ns = author_.utc_ns, .who = author_.who, .protocol = add.protocol, .due_date = add.due_date});
    return {};
  }
  core::Status operator()(const RemovePlan& remove) const { return remove_from(notes_.plan, remove.number, "planned session"); }

 private:
  static core::Status check_room(std::size_t size, std::size_t most, const std::string& what) {
    if (size < most) return {};
    return core::fail(ErrorCode::LimitExceeded, "this subject already has " + std::to_string(size) + " " + what,
                      "remove those that nobody needs any more");
  }
  template <class Entry>
  static core::Status remove_from(std::vector<Entry>& entries, std::uint32_t number, const std::string& what) {
    const auto found = std::ranges::find(entries, number, &Entry::number);
    if (found == entries.end()) {
      return core::fail(ErrorCode::NotFound, "this subject has no " + what + " " + std::to_string(number), "see dtsctl subject show ID");
    }
    entries.erase(found);
    return {};
  }

  record::SubjectNotes& notes_;
  const EditAuthor& author_;
  std::span<const Protocol> protocols_;
  const LabelRule& rule_;
};

}  // namespace

core::Result<record::SubjectNotes> edited(record::SubjectNotes notes, const SubjectEdit& edit, const EditAuthor& author,
                                          std::span<const Protocol> protocols, const LabelRule& rule) {
  DTS_TRY(std::visit(NotesEditor(notes, author, protocols, rule), edit.change));
  return notes;
}

}  // namespace dts::session
