// When to give up before the budget is used up: asked between iterations.
//
// The core has no clock; a time limit is a condition of whoever has one. Off by
// default: answers that depend on it do not repeat. A plain function, so that
// the inner loop can ask it, and nothing is allocated.
#ifndef GELENK_IK_STOP_CONDITION_H_
#define GELENK_IK_STOP_CONDITION_H_

namespace gelenk {

struct StopCondition {
  // Null: never.
  bool (*function)(const void* context) = nullptr;
  const void* context = nullptr;

  bool operator()() const { return function != nullptr && function(context); }
};

}  // namespace gelenk

#endif  // GELENK_IK_STOP_CONDITION_H_
