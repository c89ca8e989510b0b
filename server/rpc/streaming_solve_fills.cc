// How a stream answers for frames that do not come; see FillSchedule.
//
// Fills wait beside the message that is being filled, one a slot, and join it
// when it leaves or when a frame of their slot is answered: so they take
// bounded memory, and answers stay in order.
#include <algorithm>
#include <optional>

#include "server/clock.h"
#include "server/rpc/streaming_solve_call.h"

namespace gelenk::server {

bool StreamingSolveCall::IsListening() const {
  // Without a read under way frames may wait: in the message that was read, or
  // behind it where too many answers hold the sender. They come first, else
  // they were late.
  return reading_ && !half_closed_ && !broken_ && !closing_;
}

bool StreamingSolveCall::FillSlots(IkSolver& solver, bool heavy_allowed) {
  burst_begin_ = Now();
  // From where the last turn ended, so that no slot is left out for ever.
  auto slot = slots_.upper_bound(last_filled_);
  for (size_t i = 0; i < slots_.size(); ++i, ++slot) {
    if (slot == slots_.end()) slot = slots_.begin();
    const absl::Time now = Now();
    const std::optional<absl::Time> time = slot->second->fill_time();
    if (!time || *time > now || slot->second->has_unanswered()) continue;
    // The alarm rings again at once.
    if (now - burst_begin_ > kBurst) return true;
    if (!heavy_allowed && slot->second->IsHeavy()) return false;
    FillSlot(slot->first, *slot->second, solver, now);
    last_filled_ = slot->first;
  }
  return true;
}

void StreamingSolveCall::FillSlot(int index, StreamSlot& slot, IkSolver& solver,
                                  absl::Time now) {
  v1::PoseFrame answer;
  // Whoever took over, or ended the session, is told of at the next tick.
  if (!slot.Fill(solver, now, &answer).ok()) return;
  unsent_fills_[index].Swap(&answer);
}

void StreamingSolveCall::SetFillAlarm() {
  // Whatever changes that comes by here again, as do answers.
  if (!IsListening() || finishing_) return;
  absl::Time next = absl::InfiniteFuture();
  for (const auto& [index, slot] : slots_) {
    if (slot->has_unanswered()) continue;
    next = std::min(next, slot->fill_time().value_or(next));
  }
  if (next == absl::InfiniteFuture()) return;
  fill_alarm_.RingBy(next, thread_->queue(), fill_time_);
}

void StreamingSolveCall::FlushFill(int index) {
  if (unsent_fills_.empty()) return;
  const auto found = unsent_fills_.find(index);
  if (found == unsent_fills_.end()) return;
  *AddAnswer(found->second.ByteSizeLong()) = found->second;
  unsent_fills_.erase(found);
}

void StreamingSolveCall::FlushFills() {
  while (!unsent_fills_.empty() && filled_bytes_ < kMaxAnswerBytes) {
    FlushFill(unsent_fills_.begin()->first);
  }
}

}  // namespace gelenk::server
