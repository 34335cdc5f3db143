// SPDX-License-Identifier: Apache-2.0
#include "fault/power_cut.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <random>
#include <stdexcept>
#include <thread>

#include "fault/child_process.h"
#include "fault/durable_model.h"
#include "fault/logged_disk.h"
#include "fault/recorded_session.h"
#include "fault/rigs.h"
#include "support/patient_clock.h"

namespace dts::fault {
namespace {

constexpr double kPromisedAtPowerCutS = 1.0;

/// Puts in the place of the state folder what a power failure left of it.
using Restore = std::function<void()>;

struct Moment {
  std::int64_t at_ns = 0;
  Restore restore{};
};

/// Cuts at the moments given, on a thread of its own: the session does not know of it.
void take_cuts(const std::function<Restore()>& cut, core::Clock& clock, std::vector<Moment>& moments) {
  for (Moment& moment : moments) {
    clock.sleep_until_ns(moment.at_ns);
    moment.at_ns = clock.now_ns();  // before the copy: what becomes durable in between must not count against the promise
    moment.restore = cut();
  }
}

std::vector<Moment> random_moments(std::int64_t from_ns, double seconds, std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> within(0.0, seconds);
  std::vector<Moment> moments(count);
  for (Moment& moment : moments) moment.at_ns = from_ns + static_cast<std::int64_t>(within(random) * 1e9);
  std::ranges::sort(moments, {}, &Moment::at_ns);
  return moments;
}

/// What has survived takes the place of what was there: the catalogue names its files by their whole path.
PowerCut judge(const Moment& moment, const std::string& folder, std::int64_t started_ns, const Reference& reference) {
  PowerCut cut{.recorded_s = static_cast<double>(moment.at_ns - started_ns) * 1e-9};
  moment.restore();
  const Afterwards after = look_afterwards(folder, reference);
  cut.problem = after.problem;
  if (!cut.problem.empty()) return cut;
  if (after.sessions.size() != 1 || after.sessions.front().parts.size() != 1) {
    cut.problem = "the catalogue lists " + std::to_string(after.sessions.size()) + " sessions instead of one";
    return cut;
  }
  const record::PartRow& part = after.sessions.front().parts.front();
  if (part.state != record::PartState::Recovered) cut.problem = "listed as " + std::string(record::name(part.state));
  const auto raw = read_raw(part.file);
  if (!raw) cut.problem = core::to_string(raw.error());
  if (!cut.problem.empty()) return cut;
  const double last_s = raw->scans > 0 ? raw->last_time_s : static_cast<double>(started_ns) * 1e-9;
  cut.lost_s = static_cast<double>(moment.at_ns) * 1e-9 - last_s;
  cut.told_lost_s_at_most = part.lost_s_at_most;
  if (cut.lost_s > kPromisedAtPowerCutS) cut.problem = std::to_string(cut.lost_s) + " s are lost";
  return cut;
}

/// Records for `seconds` in `state`. Calls `cut` at random moments, and then judges what each left.
std::vector<PowerCut> record_and_cut(const std::string& state, const std::function<Restore()>& cut, double seconds, std::size_t cuts,
                                     std::uint32_t seed, const Reference& reference) {
  std::vector<Moment> moments;
  std::int64_t started_ns = 0;
  {
    test::PatientClock clock;  // what the machine makes late is not what is promised
    clock.start();
    auto session = RecordedSession::open(state, floor16_rig(), clock);
    if (!session) throw std::runtime_error(core::to_string(session.error()));
    SessionCourse course = (*session)->start();
    if (!course.has_started) throw std::runtime_error("no session starts: " + course.refusal + course.hang);
    started_ns = clock.now_ns();
    moments = random_moments(started_ns, seconds, cuts, seed);
    const std::jthread cutter([&] { take_cuts(cut, clock, moments); });
    (*session)->run_for(seconds + 0.2);
    (*session)->stop(course);
  }
  std::vector<PowerCut> results;
  for (const Moment& moment : moments) results.push_back(judge(moment, state, started_ns, reference));
  return results;
}

}  // namespace

std::vector<PowerCut> cut_power(double seconds, std::size_t cuts, std::uint32_t seed, const Reference& reference) {
  const TemporaryFolder folder("/dev/shm");  // in memory: a busy disk is the machine's matter, what is asked for and when is ours
  const std::string state = folder.path() + "/state";
  DurableModel model(state);
  FaultyDisk disk(state);
  disk.on_synchronise = [&](int descriptor, const std::string& path) { return model.synchronising(descriptor, path); };
  const auto cut = [&]() -> Restore {
    return [&, survivors = model.cut()] {
      std::filesystem::remove_all(state);
      put(survivors, state);
    };
  };
  return record_and_cut(state, cut, seconds, cuts, seed, reference);
}

std::vector<PowerCut> cut_power_of_disk(std::string_view file_system, double seconds, std::size_t cuts, std::uint32_t seed,
                                        const Reference& reference) {
  const TemporaryFolder folder;
  LoggedDisk disk(file_system, folder.path());
  std::mt19937 random(seed);
  const auto cut = [&]() -> Restore { return [&, moment = disk.written()] { disk.restore(moment, random); }; };
  return record_and_cut(folder.path() + "/state", cut, seconds, cuts, seed, reference);
}

}  // namespace dts::fault
