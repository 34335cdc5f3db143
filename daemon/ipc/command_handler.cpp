// SPDX-License-Identifier: Apache-2.0
#include "ipc/command_handler.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "record/utf8_text.h"
#include "session/session_events.h"

namespace dts::ipc {

using core::ErrorCode;

dts::v1::Response error_response(const core::Error& error) {
  dts::v1::Response response;
  // The message may quote shortened text of a client. One byte that is not UTF-8 would make the whole answer unreadable.
  *response.mutable_error() = error_message({error.code, record::clean_text(error.what), record::clean_text(error.hint)});
  return response;
}

CommandHandler::CommandHandler(session::Supervisor& supervisor, core::Clock& clock, Identity identity, std::vector<std::string> notices,
                               KeyCommands keys)
    : supervisor_(supervisor), keys_(std::move(keys)), clock_(clock), identity_(std::move(identity)), notices_(std::move(notices)) {}

CommandHandler::Answer CommandHandler::execute(const dts::v1::Request& request, const std::string& author) {
  Answer answer = run(request, author);
  answer.response.set_request_id(request.request_id());
  return answer;
}

CommandHandler::Answer CommandHandler::run(const dts::v1::Request& request, const std::string& author) {
  switch (request.command_case()) {
    case dts::v1::Request::kStatus: return {status_response()};
    case dts::v1::Request::kListRigs: return {list_rigs()};
    case dts::v1::Request::kGetDevices: return {devices()};
    case dts::v1::Request::kTestDevice: return {test_device(request.test_device())};
    case dts::v1::Request::kMark: return {mark(request.mark())};
    case dts::v1::Request::kTare: return tare(request.tare());
    case dts::v1::Request::kStartSession: return {start_session(request.start_session())};
    case dts::v1::Request::kResumeSession: return {resume_session(request.resume_session())};
    case dts::v1::Request::kStopSession: return stop_session(request.stop_session());
    case dts::v1::Request::kTrial: return {trial(request.trial())};
    case dts::v1::Request::kListProtocols: return {list_protocols()};
    case dts::v1::Request::kListSessions: return {list_sessions(request.list_sessions())};
    case dts::v1::Request::kShowSession: return {show_session(request.show_session())};
    case dts::v1::Request::kGetAudit: return {audit(request.get_audit())};
    case dts::v1::Request::kListKeys: return {keys_.list()};
    case dts::v1::Request::kAddKey: return {keys_.add(request.add_key())};
    case dts::v1::Request::kRevokeKey: return {keys_.revoke(request.revoke_key())};
    case dts::v1::Request::kNoteLogin: return {note_login(request.note_login())};
    case dts::v1::Request::kCorrectSession: return {correct_session(request.correct_session(), author)};
    case dts::v1::Request::kDeleteSession: return {delete_session(request.delete_session(), author)};
    case dts::v1::Request::kListSubjects: return {list_subjects()};
    case dts::v1::Request::kShowSubject: return {show_subject(request.show_subject())};
    case dts::v1::Request::kEditSubject: return {edit_subject(request.edit_subject(), author)};
    case dts::v1::Request::kEraseSubject: return erase_subject(request.erase_subject(), author);
    case dts::v1::Request::COMMAND_NOT_SET: break;
  }
  return {error_response({ErrorCode::InvalidArgument, "the request contains no command that this daemon knows",
                          "compare the versions of client and daemon: dtsctl doctor"})};
}

std::optional<dts::v1::Response> CommandHandler::finish(const Pending& pending) {
  if (const auto* stop = std::get_if<PendingStop>(&pending)) return finish_stop(*stop);
  if (std::holds_alternative<PendingErasure>(pending)) return finish_erasure();
  return finish_tare(std::get<PendingTare>(pending));
}

dts::v1::Response CommandHandler::give_up(const Pending& pending) {
  if (const auto* stop = std::get_if<PendingStop>(&pending)) {
    return error_response({ErrorCode::Timeout, "the recording of session " + stop->session_id + " is still being closed",
                           "the disk is slow; check again: dtsctl session show " + stop->session_id});
  }
  if (std::holds_alternative<PendingErasure>(pending)) {
    return error_response({ErrorCode::Timeout, "the erasure has begun, and its files are still being removed",
                           "it continues by itself; check the audit trail in a minute: dtsctl audit"});
  }
  const auto& tare = std::get<PendingTare>(pending);
  supervisor_.cancel_tare(tare.rig, tare.request);
  return error_response({ErrorCode::Timeout, "the tare did not finish within 10 s", "see dtsctl status"});
}

std::optional<dts::v1::Response> CommandHandler::finish_tare(const PendingTare& pending) {
  const auto report = supervisor_.tare_report(pending.rig);
  if (!report) return error_response(report.error());
  if (report->request < pending.request || report->outcome == pipeline::TareOutcome::Running) return std::nullopt;
  const auto rigs = supervisor_.rigs();
  const bool is_chair = std::ranges::any_of(
      rigs, [&](const session::Rig* rig) { return rig->config().name == pending.rig && rig->config().kind == "chair"; });
  const std::string surface = is_chair ? "seat" : "plate";  // the chair's plate is called so
  dts::v1::Response response;
  switch (report->outcome) {
    case pipeline::TareOutcome::None:
    case pipeline::TareOutcome::Running: return std::nullopt;
    case pipeline::TareOutcome::Done:
      for (std::size_t sensor = 0; sensor < std::min(report->channel_count, core::kMaxChannels); ++sensor) {
        response.mutable_tare()->add_baseline(report->baseline[sensor]);
      }
      response.mutable_tare()->set_unit(report->unit == pipeline::ZeroUnit::Volts ? "V" : "mm");
      return response;
    case pipeline::TareOutcome::Loaded:
      return error_response({ErrorCode::WrongState, "tare rejected: the " + surface + " of rig '" + pending.rig + "' is loaded",
                             is_chair ? "let the subject stand up, clear the seat, then try again"
                             : report->unit == pipeline::ZeroUnit::Volts
                                 ? "let everybody step off, then try again; if nobody is on it, set the volts of the "
                                   "empty plate in its rig file: [force_plate.tare] volts"
                                 : "let everybody step off, then try again"});
    case pipeline::TareOutcome::Unsteady:
      return error_response({ErrorCode::WrongState, "tare rejected: the " + surface + " of rig '" + pending.rig + "' moved while averaging",
                             "keep still around the " + surface + ", then try again"});
    case pipeline::TareOutcome::BadSensor:
      return error_response({ErrorCode::WrongState, "tare rejected: a sensor of rig '" + pending.rig + "' is faulty",
                             "test it: dtsctl device test " + pending.rig});
  }
  return error_response({ErrorCode::Internal, "tare ended in an unknown state", ""});
}

dts::v1::StatusSnapshot CommandHandler::status() {
  dts::v1::StatusSnapshot out = status_snapshot(identity_, clock_, supervisor_.states(), notices_);
  for (const session::Rig* rig : supervisor_.rigs()) {
    for (const std::string& notice : rig->notices()) out.add_notices(notice);
  }
  for (const std::string& warning : supervisor_.warnings()) out.add_notices(warning);
  out.set_rejected_requests_total(rejected_total_);
  out.set_has_network(keys_.has_network());
  out.set_erasures_total(supervisor_.recordings().erasures());
  *out.mutable_disk() = disk_status(supervisor_.recordings().disk());
  return out;
}

dts::v1::Response CommandHandler::mark(const dts::v1::MarkRequest& request) {
  const auto marks = supervisor_.mark(request.rig(), request.text(),
                                      request.has_host_time_ns() ? std::optional<std::int64_t>(request.host_time_ns()) : std::nullopt);
  if (!marks) return error_response(marks.error());
  dts::v1::Response response;
  for (const session::PlacedMark& mark : *marks) {
    auto& out = *response.mutable_mark()->add_marks();
    out.set_rig(mark.rig);
    out.set_segment(mark.at.segment);
    out.set_scan(mark.at.scan.value);
    out.set_is_before_session(mark.is_before_session);
  }
  return response;
}

dts::v1::Response CommandHandler::status_response() {
  dts::v1::Response response;
  *response.mutable_status() = status();
  return response;
}

CommandHandler::Answer CommandHandler::tare(const dts::v1::TareRequest& request) {
  const auto number = supervisor_.tare(request.rig());
  if (!number) return {error_response(number.error())};
  return {{}, PendingTare{.rig = request.rig(), .request = *number}};
}

dts::v1::Response CommandHandler::list_rigs() {
  dts::v1::Response response;
  response.mutable_rigs();  // set the field even if there are no rigs
  for (const session::Rig* rig : supervisor_.rigs()) *response.mutable_rigs()->add_rigs() = rig_info(*rig);
  return response;
}

dts::v1::Response CommandHandler::devices() {
  dts::v1::Response response;
  auto& out = *response.mutable_devices();
  for (const session::RigState& state : supervisor_.states()) {
    const device::DeviceDescription& described = state.rig.device();
    auto& device = *out.add_devices();
    device.set_rig(state.rig.config().name);
    device.set_uri(described.uri);
    const device::UnitName unit = device::unit_name(described, state.rig.device_report());
    device.set_model(unit.model);
    device.set_serial(unit.serial);
    device.set_state(state.acquisition.is_armed ? dts::v1::DEVICE_STATE_WAITING : session::to_message(state.acquisition.device));
    for (const auto& channel : described.channels) device.add_channels(channel.name);
    if (described.minimum_rate_hz > 0.0) device.set_minimum_rate_hz(described.minimum_rate_hz);
    if (described.maximum_rate_hz > 0.0) device.set_maximum_rate_hz(described.maximum_rate_hz);
  }
  const auto unused = supervisor_.unused_units();
  if (!unused) out.set_problem(core::to_string(unused.error()));
  for (const device::FoundUnit& found : unused.value_or(std::vector<device::FoundUnit>{})) {
    auto& device = *out.add_devices();
    device.set_uri(found.uri);
    device.set_model(found.model);
    device.set_serial(found.unit.serial);
    device.set_state(dts::v1::DEVICE_STATE_CLOSED);
  }
  for (const device::FoundPort& found : supervisor_.unused_ports()) {
    auto& device = *out.add_devices();
    device.set_uri(found.uri);
    device.set_model(found.model);
    device.set_serial(found.tty.serial);
    device.set_state(dts::v1::DEVICE_STATE_CLOSED);
  }
  for (const std::string& kind : session::Supervisor::device_kinds()) out.add_kinds(kind);
  return response;
}

namespace {

void add_checks(const device::DeviceReport& report, dts::v1::TestDeviceResponse& out) {
  out.set_serial(report.serial);
  out.set_firmware(report.firmware);
  for (const device::DeviceCheck& check : report.checks) {
    auto& line = *out.add_checks();
    line.set_name(check.name);
    line.set_outcome(static_cast<dts::v1::CheckOutcome>(check.outcome));  // same numbers, asserted in encode.cpp
    line.set_detail(check.detail);
  }
}

}  // namespace

dts::v1::Response CommandHandler::test_device(const dts::v1::TestDeviceRequest& request) {
  const auto tested = supervisor_.test_device(request.rig());
  if (!tested) return error_response(tested.error());
  const session::Rig* rig = tested->rig;
  const session::StatisticsReport& statistics = tested->statistics;
  const pipeline::RigConfig& config = rig->config();
  dts::v1::Response response;
  auto& out = *response.mutable_device_test();
  out.set_scans(statistics.scans);
  add_checks(tested->report, out);
  out.set_problem(tested->problem);
  for (const session::RigState& state : supervisor_.states()) {
    if (&state.rig == rig && state.measured_rate_hz > 0.0) out.set_measured_rate_hz(state.measured_rate_hz);
  }
  const auto& channels = rig->device().channels;
  for (std::size_t index = 0; index < std::min(statistics.channel_count, channels.size()); ++index) {
    const session::ChannelStatistics& measured = statistics.channels[index];
    auto& channel = *out.add_channels();
    channel.set_name(channels[index].name);
    channel.set_unit(channels[index].unit);
    channel.set_mean(measured.mean);
    channel.set_noise_rms(measured.noise_rms);
    channel.set_minimum(measured.minimum);
    channel.set_maximum(measured.maximum);
    const auto sensor = std::ranges::find(config.sensor_channels, index);
    if (sensor == config.sensor_channels.end()) continue;
    channel.set_is_sensor(true);
    if (config.model.force_plate) continue;  // its channels have no curve
    const auto& model = config.model.sensors[static_cast<std::size_t>(sensor - config.sensor_channels.begin())];
    if (const double gap_mm = model.curve.gap({measured.mean}).value; std::isfinite(gap_mm)) channel.set_gap_mm(gap_mm);
    if (!model.curve.contains({measured.mean})) channel.set_quality(core::quality::kOutOfRange);
  }
  return response;
}

}  // namespace dts::ipc
