// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fleet/forward/uplink.h"
#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"
#include "record/sha256.h"

namespace dts::fleet::forward {

/// A centre in memory, which answers at once. Thread: one.
class FakeCentre : public Uplink {
 public:
  bool is_connected() const override { return is_up; }
  bool has_room() const override { return is_up; }
  std::uint64_t connections() const override { return connection; }
  std::string problem() const override { return is_up ? "" : "the connection is lost"; }
  core::Status publish(const link::Letter& letter) override {
    if (!is_up) return core::fail(core::ErrorCode::Unreachable, "no connection");
    const auto subject = wire::parse_subject(letter.subject);
    if (!subject) return core::fail(core::ErrorCode::InvalidArgument, "wrong subject " + letter.subject);
    subjects.push_back(letter.subject);
    if (reject) DTS_TRY(reject(letter));
    if (lose && lose(*subject)) return {};
    const std::string answer = answer_to(*subject, letter.data);
    if (!answer.empty()) boxes_[letter.reply].push_back({.subject = letter.reply, .data = answer});
    return {};
  }
  core::Result<std::unique_ptr<Mailbox>> open_mailbox() override { return listen("_INBOX.kent." + std::to_string(++boxes_made_)); }
  core::Result<std::unique_ptr<Mailbox>> listen(const std::string& subject) override {
    return std::unique_ptr<Mailbox>(std::make_unique<Box>(subject, boxes_[subject]));
  }

  /// Files that have a receipt: SHA-256 in hexadecimal, and bytes.
  std::map<std::string, std::string> stored;
  std::map<std::string, std::string> staged;
  std::map<std::string, v1::UploadOffer> offers;
  std::vector<v1::FleetSession> facts;
  std::vector<std::string> erased;
  std::vector<std::string> subjects;
  std::function<core::Status(const link::Letter&)> reject;          ///< Fails for a letter that cannot be sent.
  std::function<bool(const wire::Subject&)> lose;                   ///< Returns true for a letter that is lost.
  std::function<v1::UploadAnswer(const std::string& sha256)> open;  ///< Answers an offer instead.
  std::string facts_answer;                                         ///< Answers facts instead; see also the next.
  std::function<std::string(const v1::FleetSession&)> answer_facts;
  std::string erase_answer;
  std::uint64_t received_bytes = 0;
  bool is_up = true;
  bool damage = false;  ///< Chunks change on their way.
  std::uint64_t connection = 1;

 private:
  class Box : public Mailbox {
   public:
    Box(std::string address, std::deque<link::Letter>& letters) : address_(std::move(address)), letters_(letters) {}
    const std::string& address() const override { return address_; }
    std::optional<link::Letter> next(std::chrono::milliseconds /*timeout*/) override {
      if (letters_.empty()) return std::nullopt;
      link::Letter letter = std::move(letters_.front());
      letters_.pop_front();
      return letter;
    }

   private:
    std::string address_;
    std::deque<link::Letter>& letters_;
  };

  v1::UploadAnswer state_of(const std::string& sha256) {
    v1::UploadAnswer answer;
    if (stored.contains(sha256)) {
      auto& receipt = *answer.mutable_stored();
      receipt.set_clinic("kent");
      receipt.set_sha256(wire::bytes_of_hex(sha256).value());
      receipt.set_bytes(stored[sha256].size());
      receipt.set_stored_utc_ns(77);
      receipt.set_hub("hub-1");
    } else {
      answer.mutable_upload()->set_worker("hub-1");
      answer.mutable_upload()->set_have(staged[sha256].size());
    }
    return answer;
  }
  std::string answer_to(const wire::Subject& subject, const std::string& data) {
    switch (subject.matter) {
      case wire::Matter::Open: {
        const auto offer = wire::decode_offer(data).value();
        const std::string sha256 = wire::hex_of(offer.sha256());
        offers[sha256] = offer;
        return (open ? open(sha256) : state_of(sha256)).SerializeAsString();
      }
      case wire::Matter::Chunk: {
        auto chunk = wire::decode_chunk(data).value();
        std::string& bytes = staged[wire::hex_of(chunk.sha256())];
        received_bytes += chunk.data().size();
        if (damage) chunk.mutable_data()->front() = '!';
        if (chunk.offset() == bytes.size()) bytes += chunk.data();
        return state_of(wire::hex_of(chunk.sha256())).SerializeAsString();
      }
      case wire::Matter::Commit: {
        const std::string sha256 = wire::hex_of(wire::decode_commit(data).value().sha256());
        if (record::sha256_of(staged[sha256]) == sha256) {
          stored[sha256] = staged[sha256];
        } else {
          staged[sha256].clear();
        }
        return state_of(sha256).SerializeAsString();
      }
      case wire::Matter::Facts: {
        facts.push_back(wire::decode_session(data).value());
        if (answer_facts) return answer_facts(facts.back());
        v1::FactsAnswer answer;
        answer.set_revision(facts.back().revision());
        return facts_answer.empty() ? answer.SerializeAsString() : facts_answer;
      }
      case wire::Matter::Erase: {
        erased.push_back(wire::decode_erase(data).value().session_id());
        v1::EraseAnswer answer;
        answer.set_files(1);
        return erase_answer.empty() ? answer.SerializeAsString() : erase_answer;
      }
      default: return {};
    }
  }

  std::map<std::string, std::deque<link::Letter>> boxes_;
  int boxes_made_ = 0;
};

}  // namespace dts::fleet::forward
