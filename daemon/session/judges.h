// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/worker.h"
#include "record/session_facts.h"
#include "session/reach_results.h"
#include "session/rig.h"
#include "session/steadiness_decision.h"
#include "session/sway_results.h"
#include "session/trial_judge.h"

namespace dts::session {

/// Judges the reaching task.
class ReachJudge final : public TrialJudge {
 public:
  ReachJudge(std::string session_id, ReachResults results) : session_id_(std::move(session_id)), results_(std::move(results)) {}

  void take(const core::Event& event) override;
  void take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan) override { results_.take(event, segment, scan); }
  void advance(std::uint32_t segment, core::ScanIndex scan) override { results_.advance(segment, scan); }
  void finish() override { results_.finish(); }
  [[nodiscard]] std::vector<TrialResultEvent> take_results() override;
  /// Each reach is classified again, on the subject's own scale if it is known now.
  [[nodiscard]] std::vector<TrialResultEvent> final_results() const override;
  [[nodiscard]] std::vector<SessionFigure> summary() const override { return results_.summary(); }

 private:
  std::string session_id_;
  ReachResults results_;
};

/// Judges quiet standing.
class SwayJudge final : public TrialJudge {
 public:
  /// `software`: which program computes the results. `corrects_two_feet`: the load of people on two feet is right, so it is a result.
  /// `model`: decides the trials.
  SwayJudge(const record::SessionFacts& facts, std::string software, core::Rate raw_rate, core::Rate cop_rate, bool corrects_two_feet,
            const std::optional<pipeline::SteadinessModel>& model, core::Worker& worker)
      : session_id_(facts.session_id),
        fields_(facts.fields),
        software_(std::move(software)),
        corrects_two_feet_(corrects_two_feet),
        decider_(model),
        results_(raw_rate, cop_rate, worker) {}

  void take(const core::Block& cop) override { results_.take(cop); }
  void take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan) override { results_.take(event, segment, scan); }
  void finish() override { results_.finish(); }
  [[nodiscard]] bool is_analysing() const override { return results_.is_analysing(); }
  void wait() const override { results_.wait(); }
  [[nodiscard]] std::vector<TrialResultEvent> take_results() override;
  [[nodiscard]] std::vector<SessionFigure> summary() const override;

 private:
  std::string session_id_;
  std::vector<std::pair<std::string, std::string>> fields_;
  std::string software_;
  bool corrects_two_feet_;
  SteadinessDecider decider_;
  SwayResults results_;
};

/// Returns the judges of a session with trials, as the rig's stages allow. `worker` and the rig outlive them.
[[nodiscard]] std::vector<std::unique_ptr<TrialJudge>> make_judges(const Rig& rig, const record::SessionFacts& facts,
                                                                   const std::string& software, core::Worker& worker);

}  // namespace dts::session
