// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/reach.h"
#include "physics/body/person.h"
#include "session/figure.h"
#include "session/trial_run.h"

namespace dts::session {

/// What came of one trial of the reaching task.
struct ReachTrialResult {
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  std::string condition{};
  std::optional<double> target_cm;
  std::uint32_t segment = 0;
  core::ScanIndex go;                           ///< Scan of the cue.
  bool has_gap = false;                         ///< Scans are missing between cue and end: no result.
  std::optional<core::ReachEvent> reach;        ///< Nothing: none was found between cue and end.
  std::optional<core::TrunkMovement> movement;  ///< By the subject's own scale as soon as there is one; nothing without a reach or a model.
  /// Of the trunk flexion that the target takes by the subject's measures; nothing without these or a target.
  std::optional<core::TrunkClass> expected;
};

/// The subject of a session by the fields of its protocol (thesis Table 6.1): weight_kg, height_cm, arm_length_cm, max_reach_cm, group.
/// Nothing when one is missing or no positive number.
[[nodiscard]] std::optional<physics::Person> person_of(const std::vector<std::pair<std::string, std::string>>& fields);

/// The class of a reach to a target `target_cm` away, by the trunk flexion that it takes; nothing when that is not known.
[[nodiscard]] std::optional<core::TrunkClass> expected_class(const std::optional<physics::Person>& person, std::optional<double> target_cm);

/// Turns the events of a session into results: of each trial, and of all. A pure function of what it is told, so that daemon, replay and
/// laboratory say the same. Thread: one at a time.
///
///     scans     go        P1     P2      P3    final   done
///     told      |---------x------x-------x-------x------|    belongs to this trial: P2 and its final in [go, done)
///
/// P2, where the trunk goes forward, is what is found most exactly; P1 is traced back into the noise and may come to lie before the cue.
///
/// Memory is bounded: of the newest `kMostPending` events that no trial has taken up, and of trials as many as a plan may have, twice.
class ReachResults {
 public:
  static constexpr std::size_t kMostPending = 1024;
  static constexpr std::size_t kMostAttempts = std::size_t{2} * kMostTrials;

  /// `model` (nullptr: nothing is classified again) outlives this.
  ReachResults(std::optional<physics::Person> person, const classifier::TrunkModel* model) : person_(person), model_(model) {}

  void take(const core::ReachEvent& event);
  void take(const core::ClassEvent& event);
  /// A step of the protocol, at its scan.
  void take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan);
  /// Everything before `scan` of `segment` has been told: trials that were done until then are decided.
  void advance(std::uint32_t segment, core::ScanIndex scan);
  /// The session is over: so is everything.
  void finish();

  /// Of trials that were decided since the last call, oldest first; how often it is called changes nothing. A trial that is redone or
  /// rejected later is void in the summary.
  [[nodiscard]] std::vector<ReachTrialResult> take_decided();
  /// All trials that count, judged with everything that is known now.
  [[nodiscard]] std::vector<ReachTrialResult> results() const;
  /// Trunk contribution at the critical boundary, classes per target, agreement with what the target takes, consistency, smoothness:
  /// see reach_summary.h. Empty when no trial counts.
  [[nodiscard]] std::vector<SessionFigure> summary() const;

 private:
  struct Place {
    std::uint32_t segment = 0;
    core::ScanIndex scan;

    friend auto operator<=>(const Place&, const Place&) = default;
  };
  struct Attempt {
    std::string condition{};
    std::optional<double> target_cm;
    std::optional<Place> go;
    std::optional<Place> done;
    bool is_void = false;
    bool is_decided = false;
    std::optional<core::ReachEvent> reach;
    std::optional<core::TrunkMovement> told;  ///< What the pipeline's own model said.
  };
  using Key = std::pair<std::uint32_t, std::uint32_t>;  ///< Trial, attempt.

  void decide_until(const std::optional<Place>& place);
  void decide(const Key& key, Attempt& attempt);
  [[nodiscard]] std::optional<core::ReachEvent> reach_of(const Attempt& attempt) const;
  [[nodiscard]] std::optional<core::TrunkMovement> class_of(const core::ReachEvent& reach, const Place& done) const;
  [[nodiscard]] std::vector<const Attempt*> counting() const;
  [[nodiscard]] bool is_at_maximum(const Attempt& attempt) const;
  [[nodiscard]] std::optional<classifier::SubjectCalibration> own_scale() const;
  [[nodiscard]] ReachTrialResult result_of(const Key& key, const Attempt& attempt,
                                           const std::optional<classifier::SubjectCalibration>& scale) const;

  std::optional<physics::Person> person_;
  const classifier::TrunkModel* model_;
  std::map<Key, Attempt> attempts_;
  std::vector<Key> undecided_;
  std::vector<ReachTrialResult> fresh_;  ///< Decided since `take_decided` was called, each by what was known when it was.
  std::deque<core::ReachEvent> reaches_;
  std::deque<core::ClassEvent> classes_;
  std::optional<Place> told_until_;
};

}  // namespace dts::session
