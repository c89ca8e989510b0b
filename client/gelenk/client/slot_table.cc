#include "gelenk/client/slot_table.h"

#include <algorithm>
#include <utility>

#include "gelenk/client/status.h"

namespace gelenk::client {

SlotTable::SlotTable(std::vector<SessionSpec> specs) {
  for (size_t i = 0; i < specs.size(); ++i) {
    slots_.emplace_back(static_cast<int>(i), std::move(specs[i]));
  }
}

Slot* SlotTable::Find(int slot) {
  if (slot < 0 || slot >= static_cast<int>(slots_.size())) return nullptr;
  return &slots_[slot];
}

Slot* SlotTable::FindAbsent() {
  const auto found = std::find_if(
      slots_.begin(), slots_.end(),
      [](const Slot& slot) { return slot.phase() == Slot::Phase::kAbsent; });
  return found == slots_.end() ? nullptr : &*found;
}

void SlotTable::Rewind() {
  for (Slot& slot : slots_) slot.Rewind(&statistics_);
}

void SlotTable::End(const absl::Status& status) {
  for (Slot& slot : slots_) slot.End(status);
}

bool SlotTable::Write(int max_frames, int window,
                      v1::StreamingSolveRequest* request) {
  for (Slot& slot : slots_) {
    if (slot.phase() == Slot::Phase::kDetached) {
      slot.Attach(request->add_attach());
    }
  }
  int room = max_frames;
  for (size_t i = 0; i < slots_.size() && room > 0; ++i) {
    room -= slots_[turn_].Send(room, window, request, &statistics_);
    turn_ = (turn_ + 1) % slots_.size();
  }
  return request->attach_size() > 0 || request->frames_size() > 0;
}

SlotTable::News SlotTable::Read(v1::StreamingSolveResponse* response,
                                SteadyTime now,
                                std::deque<v1::PoseFrame>* answers) {
  News news;
  for (v1::PoseFrame& answer : *response->mutable_frames()) {
    Slot* slot = Find(answer.slot());
    if (slot == nullptr || slot->phase() != Slot::Phase::kAttached) continue;
    const bool is_news = answer.timing().filled()
                             ? slot->TakeFill(answer)
                             : slot->Settle(answer, now, &statistics_);
    if (!is_news) continue;
    news.has_answers = true;
    answers->push_back(std::move(answer));
  }
  for (const v1::StreamEvent& event : response->events()) {
    ReadEvent(event, &news);
  }
  return news;
}

void SlotTable::ReadEvent(const v1::StreamEvent& event, News* news) {
  Slot* slot = Find(event.slot());
  absl::Status attempt;
  switch (event.kind()) {
    case v1::StreamEvent::KIND_ATTACHED:
      if (slot != nullptr) attempt = slot->OnAttached(event, &statistics_);
      break;
    case v1::StreamEvent::KIND_DETACHED:
      if (slot != nullptr) attempt = slot->OnDetached(event);
      break;
    case v1::StreamEvent::KIND_DRAINING:
      news->draining = true;
      break;
    case v1::StreamEvent::KIND_CLOSING:
      news->closing = FromProto(event.status());
      break;
    default:
      break;  // heartbeats, and kinds of a later version
  }
  if (!attempt.ok()) news->new_attempt = attempt;
}

bool SlotTable::AllAttached() const {
  return std::all_of(slots_.begin(), slots_.end(), [](const Slot& slot) {
    return slot.phase() == Slot::Phase::kAttached;
  });
}

bool SlotTable::AllEnded() const {
  return std::all_of(slots_.begin(), slots_.end(), [](const Slot& slot) {
    return slot.phase() == Slot::Phase::kEnded;
  });
}

int64_t SlotTable::unanswered_count() const {
  int64_t count = 0;
  for (const Slot& slot : slots_) count += slot.unanswered_count();
  return count;
}

absl::Status SlotTable::status() const {
  for (const Slot& slot : slots_) {
    if (!slot.status().ok()) return slot.status();
  }
  return absl::OkStatus();
}

}  // namespace gelenk::client
