// What a server can be told; the defaults are what `gelenkd` starts with.
#ifndef GELENK_SERVER_OPTIONS_H_
#define GELENK_SERVER_OPTIONS_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "gelenk/ik/instruction_set.h"

namespace gelenk::server {

// Every bound on what clients can make the server hold.
struct Limits {
  // 10,000 sessions of a 64-joint body are about 50 MB.
  int max_sessions = 10000;
  int max_skeletons = 1000;
  // All skeletons together; one of 64 joints is about 40 KB.
  size_t max_skeleton_bytes = size_t{256} << 20;
  // One skeleton: a body with fingers and face has about 200 joints.
  int max_joints = 1024;
  int max_clips = 1000;
  // All clips together; a minute of a 64-joint body at 60 Hz is 8 MB.
  size_t max_clip_bytes = size_t{1} << 30;
  // One clip, as frames: 20 minutes of a 64-joint body at 100 Hz.
  int64_t max_clip_numbers = int64_t{1} << 25;
  // Of one clip: what can be undone. Each is as large as the clip.
  int max_clip_revisions = 100;
  int max_skins = 1000;
  // All skins with all their revisions; one revision of 10,000 vertices in
  // layered volumes is about 4 MB.
  size_t max_skin_bytes = size_t{512} << 20;
  // One skin: a scanned body, thinned out; and revisions of it that are kept.
  int max_skin_vertices = 1 << 18;
  int max_skin_triangles = 1 << 19;
  int max_skin_revisions = 16;
  // All recordings of sessions that are under way, by what they may become: ten
  // minutes of a 64-joint body at 60 Hz are 76 MB.
  int64_t max_recording_bytes = int64_t{1} << 30;
  // gRPC's own default; larger things come in pieces.
  int max_message_bytes = 4 << 20;
  // One imported file; an hour of motion capture is about 200 MB.
  int64_t max_import_bytes = int64_t{256} << 20;
  // Imports held in memory at a time, and how long one may wait for its next
  // piece before it loses its place.
  int max_imports = 4;
  absl::Duration import_stall = absl::Seconds(30);
  // Streams (driving and watching) at a time, and sessions on one stream.
  int max_streams = 10000;
  int max_slots = 1024;
  // Answers that wait for a slow reader before the server stops reading.
  int max_unsent_answers = 64;
  // How long none of them may leave before the stream is ended.
  absl::Duration write_stall = absl::Seconds(30);
  // Unary calls that wait for a worker.
  int max_waiting_calls = 4096;
  // Longest idle_ttl granted, and the one given to who does not ask.
  absl::Duration max_idle_ttl = absl::Hours(24);
  absl::Duration default_idle_ttl = absl::Minutes(10);
  // Poses in one ComputeForwardKinematics call.
  int max_poses_per_call = 1024;
};

struct ServerOptions {
  // host:port; port 0 picks a free one.
  std::string listen = "127.0.0.1:50051";
  // Plain text off loopback: only when told.
  bool insecure = false;
  // Threads that serve streams and solve; 0 means half the cores, at least one.
  // Each costs the others some hand-over, see docs/benchmarks.md.
  int io_threads = 0;
  // Threads for unary calls, cold solves and imports; 0 means one a core.
  int worker_threads = 0;
  // The level that solves.
  InstructionSet instruction_set = BestInstructionSet();
  // Server reflection, for tools such as buf curl and grpcurl. Costs the
  // streams some hand-over to its own threads.
  bool reflection = false;
  // Silence after which a stream is told that the server lives.
  absl::Duration heartbeat = absl::Seconds(5);
  // Silence after which a client is asked whether it lives; it has as long to
  // answer, and as long for its first words.
  absl::Duration keepalive = absl::Seconds(30);
  Limits limits;
};

// INVALID_ARGUMENT naming each bad option.
absl::Status CheckOptions(const ServerOptions& options);

// True when only this machine can reach `listen`.
bool IsLoopback(const std::string& listen);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_OPTIONS_H_
