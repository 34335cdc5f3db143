// SPDX-License-Identifier: Apache-2.0
#include "fault/erasure.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "fault/child_process.h"
#include "fault/recorded_session.h"
#include "fault/rigs.h"
#include "support/patient_clock.h"

namespace dts::fault {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSubject = "P001";
constexpr const char* kGone = "gone";
constexpr const char* kComplete = "complete";
constexpr std::chrono::seconds kErasureLimit{60};

/// Returns the ID of the recorded session, or nothing.
std::string record_session(RecordedSession& session, const std::string& subject) {
  SessionCourse course = session.start(subject);
  if (!course.has_started) return {};
  session.run_for(0.5);
  session.stop(course);
  return course.is_over ? course.session_id : "";
}

std::size_t files_of(const std::string& state, const std::string& session) {
  const fs::directory_iterator files(state + "/sessions");
  return static_cast<std::size_t>(std::count_if(begin(files), end(files), [&](const fs::directory_entry& entry) {
    return entry.path().filename().string().starts_with(session + ".");
  }));
}

/// Returns the first file below the folder that has the text.
std::string file_with(const std::string& folder, const std::string& text) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    if (bytes.find(text) != std::string::npos) return entry.path();
  }
  return {};
}

}  // namespace

ErasedFolder::ErasedFolder(std::string folder) : state_(folder + "/state"), copy_(std::move(folder) + "/copy") {
  const std::string made = run_in_child(
      [this] {
        prepare();
        return problem_.empty() ? erased_session_ + " " + other_session_ : "?" + problem_;
      },
      kErasureLimit);
  const std::size_t space = made.find(' ');
  if (made.starts_with('?') || space == std::string::npos) {
    problem_ = made;
    return;
  }
  erased_session_ = made.substr(0, space);
  other_session_ = made.substr(space + 1);
  fs::copy(state_, copy_, fs::copy_options::recursive);
}

void ErasedFolder::prepare() {
  {
    test::PatientClock clock(kClockStepNs);
    clock.start();
    auto session = RecordedSession::open(state_, floor4_rig(), clock);
    if (session) erased_session_ = record_session(**session, kSubject);
    if (session) other_session_ = record_session(**session, "P002");
  }
  core::SystemClock clock;
  const auto recordings = session::Recordings::open(storage_in(state_), clock, core::Log());
  if (!recordings || erased_session_.empty() || other_session_.empty()) {
    problem_ = "no sessions were recorded";
    return;
  }
  const auto other = (*recordings)->closed_session(other_session_);
  const auto corrected = (*recordings)
                             ->correct(*other, {{.who = "local",
                                                 .field = record::CorrectedField::Notes,
                                                 .old_value = "",
                                                 .new_value = "confused with P001",
                                                 .reason = "r"}});
  if (!corrected) problem_ = core::to_string(corrected.error());
}

void ErasedFolder::restore() const {
  fs::remove_all(state_);
  fs::copy(copy_, state_, fs::copy_options::recursive);
}

std::string ErasedFolder::erase(FaultyDisk& disk, const Fault* fault) const {
  core::SystemClock clock;
  const auto recordings = session::Recordings::open(storage_in(state_), clock, core::Log());
  if (!recordings) return core::to_string(recordings.error());
  disk.arm(fault != nullptr ? *fault : Fault{.nth = 0});
  if (const auto begun = (*recordings)->begin_erasure(kSubject, "local"); !begun) return core::to_string(begun.error());
  while (true) {
    static_cast<void>((*recordings)->take_finished());
    if (const auto erased = (*recordings)->take_erased()) return *erased ? "" : core::to_string(erased->error());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

std::vector<Fault> ErasedFolder::all_kills() {
  restore();
  const std::string text = run_in_child(
      [this] {
        FaultyDisk disk(state_);
        if (const std::string problem = erase(disk, nullptr); !problem.empty()) return problem;
        std::string counts;
        for (const Operation operation : kOperations) counts += std::to_string(disk.calls(operation)) + " ";
        return counts;
      },
      kErasureLimit);
  std::vector<Fault> kills;
  const char* at = text.data();
  for (const Operation operation : kOperations) {
    std::uint64_t calls = 0;
    const auto [next, error] = std::from_chars(at, text.data() + text.size(), calls);
    if (error != std::errc()) {
      problem_ = text;
      return {};
    }
    at = next + 1;
    if (operation == Operation::Open) continue;  // changes nothing that the next call would not show
    for (std::uint64_t nth = 1; nth <= calls; ++nth) kills.push_back({.operation = operation, .nth = nth, .is_kill = true});
  }
  return kills;
}

ErasedFolder::Outcome ErasedFolder::kill(const Fault& fault) {
  restore();
  const std::string ended = run_in_child(
      [&] {
        FaultyDisk disk(state_);
        return erase(disk, &fault);
      },
      kErasureLimit);
  const std::string found = run_in_child([this] { return look(); }, kErasureLimit);
  return {.problem = found == kGone || found == kComplete ? "" : found,
          .was_killed = ended == "crashed with signal 9",
          .is_gone = found == kGone};
}

std::string ErasedFolder::look() const {
  core::SystemClock clock;
  const auto recordings = session::Recordings::open(storage_in(state_), clock, core::Log());
  if (!recordings) return core::to_string(recordings.error());
  const record::Catalogue& catalogue = (*recordings)->catalogue();
  (*recordings)->start();
  while (fs::exists(state_ + "/erasure.json")) {  // if it is not continued, the child exceeds its limit
    static_cast<void>((*recordings)->take_finished());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const auto subject = catalogue.sessions({.subject = kSubject, .shown = record::Shown::Both});
  const auto other = catalogue.session(other_session_);
  if (!subject || !other) return "the catalogue cannot be read";
  const auto audit = catalogue.audit(1000);
  if (!audit || !catalogue.verify_audit()) return "the audit trail is damaged";
  const auto entered = std::ranges::count(*audit, "erase_subject", &record::AuditEntry::what);
  const std::size_t files = files_of(state_, erased_session_);
  if (files_of(state_, other_session_) != 3) return "the other subject has lost a file";
  const bool is_gone = subject->empty();
  if (is_gone != (files == 0))
    return "the catalogue has " + std::to_string(subject->size()) + " sessions, and files: " + std::to_string(files);
  if (entered != (is_gone ? 1 : 0)) return "erasures in the audit trail: " + std::to_string(entered);
  if (!is_gone) return files == 2 && other->notes == "confused with P001" ? kComplete : "the subject is not complete";
  const std::string left = file_with(state_, kSubject);
  return left.empty() ? kGone : "the subject ID is still in " + left;
}

}  // namespace dts::fault
