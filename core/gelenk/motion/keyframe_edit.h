// Keyframes by hand: pure functions from a clip to its next revision.
//
// Clips are values, so that every revision stays what it is; RevisionHistory
// keeps them for undo. Errors: INVALID_ARGUMENT naming the field.
#ifndef GELENK_MOTION_KEYFRAME_EDIT_H_
#define GELENK_MOTION_KEYFRAME_EDIT_H_

#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// Times this near to each other are the same key, s: far below any frame time,
// far above what is lost by adding frame times up.
inline constexpr double kSameKey_s = 1e-6;

enum class ChildrenOnEdit {
  // Children keep their local angles: they go along with their parent.
  kFollow,
  // The children of what is edited keep their world rotation at that time (of a
  // free child, its place too): they get a key that counters the edit.
  kKeepWorld,
};

// `values` (the numbers of the part, or x y z w) at `time_s` >= 0 for one part
// of one joint; replaces the key that is there. A part without track gets one
// of `interpolation`. In a cubic spline a new key gets the tangents of the
// neighbouring chord.
absl::StatusOr<MotionClip> InsertKey(
    const MotionClip& clip, int joint, PosePartKind kind, double time_s,
    absl::Span<const double> values,
    ChildrenOnEdit children = ChildrenOnEdit::kFollow,
    Interpolation interpolation = Interpolation::kCatmullRom);

// The key at `from_s` goes to `to_s`, where no other may be.
absl::StatusOr<MotionClip> MoveKey(const MotionClip& clip, int joint,
                                   PosePartKind kind, double from_s,
                                   double to_s);

// With the last key the track goes: the joint is at the clip's base again.
absl::StatusOr<MotionClip> DeleteKey(const MotionClip& clip, int joint,
                                     PosePartKind kind, double time_s);

// Stop motion: a key at `time_s` for all parts of all `joints` (empty: all that
// move) from a pose. Frame by frame with kStep, or keyframe by keyframe.
absl::StatusOr<MotionClip> CapturePose(
    const MotionClip& clip, double time_s, const ConstVectorView& positions,
    absl::Span<const int> joints = {},
    Interpolation interpolation = Interpolation::kCatmullRom);

// The revisions of a clip, with undo and redo; a value.
class RevisionHistory {
 public:
  // At most `max_revisions`, >= 1, are kept; the oldest go.
  explicit RevisionHistory(MotionClip clip, int max_revisions = 100);

  // Numbers count from 1 and are never given twice.
  const MotionClip& current() const { return revisions_[place_].clip; }
  int revision() const { return revisions_[place_].number; }

  // What could be redone is gone. Returns the new revision's number.
  int Commit(MotionClip clip);
  // False when there is none before, or after.
  bool Undo();
  bool Redo();
  // NOT_FOUND naming the number and what there is.
  absl::StatusOr<MotionClip> At(int revision) const;

 private:
  struct Revision {
    int number;
    MotionClip clip;
  };
  std::vector<Revision> revisions_;
  size_t place_ = 0;
  int last_number_ = 1;
  size_t max_revisions_;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_KEYFRAME_EDIT_H_
