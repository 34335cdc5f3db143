// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <string>
#include <string_view>
#include <vector>

#include "dts/v1/control.pb.h"
#include "dts/v1/stream.pb.h"

/// The options of dts/v1/options.proto, read from the descriptors. Thread: any.
namespace dts::wire {

/// Topic of every published field of Event.body, in the order of their numbers. Two bodies may share a topic.
[[nodiscard]] const std::vector<v1::Topic>& event_topics();
/// Whether events are published on "<rig>/<name>"; all other topics of a rig carry streams.
[[nodiscard]] bool is_event_topic(std::string_view name);
/// Topic of an event. It has no name if the event is not published, or if this version does not know its body.
[[nodiscard]] const v1::Topic& topic_of(const v1::Event& event);
/// The word for an event in recordings and exports: "reach", "class", "result". Empty if this version does not know its body.
[[nodiscard]] std::string kind_of(const v1::Event& event);
/// The message that is set in Event.body; nullptr if this version does not know it.
[[nodiscard]] const google::protobuf::Message* body_of(const v1::Event& event);

/// Returns the word for an enumerator: "DEVICE_STATE_STREAMING" becomes "streaming"; "unknown" for a number of a later version.
[[nodiscard]] std::string enumerator_word(const google::protobuf::EnumDescriptor& type, int number);

/// The field of Request.command that is set; nullptr if this version does not know the command.
[[nodiscard]] const google::protobuf::FieldDescriptor* command_field(const v1::Request& request);
/// Rules of the request's command; the default, without a role, if this version does not know the command.
[[nodiscard]] const v1::CommandRules& rules_of(const v1::Request& request);
/// The field of Response.result that answers the request; nullptr if this version does not know the command.
[[nodiscard]] const google::protobuf::FieldDescriptor* answer_field(const v1::Request& request);

}  // namespace dts::wire
