// A clip as if a service had answered it without error.
#ifndef GELENK_TESTS_CLIENT_CLI_SAMPLE_PLAYBACK_H_
#define GELENK_TESTS_CLIENT_CLI_SAMPLE_PLAYBACK_H_

#include "client/cli/bvh_clip.h"
#include "client/cli/play/playback.h"

namespace gelenk::cli {

// The made-up walk of tests/testing/walking_bvh.h.
BvhClip SampleClip(int frame_count);

// Every answer is the clip's own pose, converged, 10 µs.
Playback SamplePlayback(int frame_count);

}  // namespace gelenk::cli

#endif  // GELENK_TESTS_CLIENT_CLI_SAMPLE_PLAYBACK_H_
