// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "dts/v1/stream.pb.h"

/// Events of dtsd 0.1: each was one flat JSON object, {"event":"marker","segment":0,"scan":1250,"text":"eyes closed"}. This file is the
/// only place that knows that form. Thread: any.
namespace dts::record {

/// Returns the event; nothing if the text is not of this form, has an unknown word in "event", a value that the present form
/// cannot hold,
/// more than 64 keys or 64 KiB, or is nested too deeply.
[[nodiscard]] std::optional<v1::Event> old_event_of(const std::string& text);

/// The cells of an event in CSV and BIDS files.
struct EventCells {
  std::string kind;
  std::string text;  ///< Its main text, which most people look for: the text of a marker, the step of a trial.
  std::string condition{};
  std::string details{};  ///< JSON of the rest; empty if nothing is left.
};
/// Returns the cells that dtsd 0.1 wrote for this event, to the byte. `text` must be one that `old_event_of` has read.
[[nodiscard]] EventCells old_cells_of(const std::string& text);

/// Reads an event of a recording or of the catalogue, in the present form or in that of dtsd 0.1. Returns nothing for any other text.
[[nodiscard]] std::optional<v1::Event> event_of_text(const std::string& text);

}  // namespace dts::record
