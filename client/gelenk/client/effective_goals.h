// The goals of a session as its frames have left them.
#ifndef GELENK_CLIENT_EFFECTIVE_GOALS_H_
#define GELENK_CLIENT_EFFECTIVE_GOALS_H_

#include "gelenk/v1/session.pb.h"
#include "gelenk/v1/session_service.pb.h"

namespace gelenk::client {

// What a client must remember to bring a session back: its goals with targets
// and weights, and where the actor stands. Follows the contract's rules for
// GoalTarget and GoalPatch, on messages: values stay as the caller sent them,
// bit for bit. Not thread-safe.
class EffectiveGoals {
 public:
  // As `session` declares them.
  explicit EffectiveGoals(const v1::Session& session);

  // As they are after a frame that the server accepted. What the server would
  // refuse (an index out of range, a target of another kind) is passed over.
  void Apply(const v1::TargetFrame& frame);

  // Makes `frame` say more: every goal's target, and where asked for every
  // weight and the place. It then means the same on a session whose goals stand
  // elsewhere. A frame whose patch does not fit stays as it is: the server
  // refuses it.
  struct Wanted {
    bool weights = true;
    bool place = true;
  };
  void Complete(const Wanted& wanted, v1::TargetFrame* frame) const;

  // Makes `session` declare these goals and this place.
  void Declare(v1::Session* session) const;

 private:
  using Goals = google::protobuf::RepeatedPtrField<v1::Goal>;

  // False, and nothing changed, when the patch does not fit.
  bool ApplyPatch(const v1::GoalPatch& patch);

  Goals goals_;
  // Unset means identity, as in the contract.
  v1::RigidTransform world_from_skeleton_;
};

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_EFFECTIVE_GOALS_H_
