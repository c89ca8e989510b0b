#include "tests/client/cli/sample_playback.h"

#include "client/cli/play/clip_goals.h"
#include "gelenk/formats/bvh_motion.h"
#include "gelenk/formats/bvh_reader.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk::cli {

BvhClip SampleClip(int frame_count) {
  BvhClip clip;
  clip.document = *ReadBvh(::gelenk::testing::WalkingBvh(frame_count));
  clip.import = *ImportBvh(clip.document);
  clip.poses = *PosesFromBvh(clip.document, clip.import);
  return clip;
}

Playback SamplePlayback(int frame_count) {
  const BvhClip clip = SampleClip(frame_count);
  Playback playback;
  playback.clip_name = "walk.bvh";
  playback.skeleton = clip.import.skeleton;
  playback.body = FindBodyParts(*playback.skeleton);
  playback.frame_time = clip.frame_time();
  playback.tolerance = {1e-3, 1e-2};
  playback.goals = GoalsFor(*playback.skeleton, playback.body);
  playback.clip_poses = clip.poses;
  playback.answered_poses = clip.poses;
  Answer answer;
  answer.answered = true;
  answer.position_errors_m.assign(playback.goals.size(), 0);
  answer.rotation_errors_rad.assign(playback.goals.size(), 0);
  answer.solve_duration = absl::Microseconds(10);
  playback.answers.assign(frame_count, answer);
  playback.elapsed = absl::Milliseconds(frame_count);
  return playback;
}

}  // namespace gelenk::cli
