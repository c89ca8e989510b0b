#include "server/options.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"

namespace gelenk::server {
namespace {

void CheckAtLeast(absl::string_view field, int64_t value, int64_t least,
                  Violations& violations) {
  if (value >= least) return;
  violations.Add(field, absl::StrCat("want at least ", least, ", got ", value));
}

void CheckPositive(absl::string_view field, absl::Duration value,
                   Violations& violations) {
  if (value > absl::ZeroDuration()) return;
  violations.Add(field, absl::StrCat("want more than 0, got ",
                                     absl::FormatDuration(value)));
}

}  // namespace

bool IsLoopback(const std::string& listen) {
  const absl::string_view host =
      absl::string_view(listen).substr(0, listen.rfind(':'));
  return absl::StartsWith(listen, "unix:") || host == "localhost" ||
         host == "[::1]" || absl::StartsWith(host, "127.");
}

absl::Status CheckOptions(const ServerOptions& options) {
  Violations violations;
  const Limits& limits = options.limits;
  if (!absl::StrContains(options.listen, ':')) {
    violations.Add(
        "listen", absl::StrCat("want host:port, got \"", options.listen, "\""));
  } else if (!options.insecure && !IsLoopback(options.listen)) {
    violations.Add("listen",
                   absl::StrCat("\"", options.listen,
                                "\" is reachable from other machines and this "
                                "server speaks plain text: put it behind a "
                                "proxy that speaks TLS, or say --insecure"));
  }
  const auto levels = SupportedInstructionSets();
  if (std::find(levels.begin(), levels.end(), options.instruction_set) ==
      levels.end()) {
    violations.Add("isa",
                   absl::StrCat("this processor does not run ",
                                InstructionSetName(options.instruction_set)));
  }
  CheckAtLeast("io_threads", options.io_threads, 0, violations);
  CheckAtLeast("worker_threads", options.worker_threads, 0, violations);
  CheckAtLeast("max_sessions", limits.max_sessions, 1, violations);
  CheckAtLeast("max_skeletons", limits.max_skeletons, 1, violations);
  CheckAtLeast("max_joints", limits.max_joints, 1, violations);
  CheckAtLeast("max_clips", limits.max_clips, 1, violations);
  CheckAtLeast("max_clip_numbers", limits.max_clip_numbers, 1, violations);
  CheckAtLeast("max_clip_revisions", limits.max_clip_revisions, 1, violations);
  CheckAtLeast("max_recording_bytes", limits.max_recording_bytes, 0,
               violations);
  CheckAtLeast("max_skins", limits.max_skins, 1, violations);
  CheckAtLeast("max_skin_vertices", limits.max_skin_vertices, 1, violations);
  CheckAtLeast("max_skin_triangles", limits.max_skin_triangles, 1, violations);
  // An edit adds one before an older one goes.
  CheckAtLeast("max_skin_revisions", limits.max_skin_revisions, 2, violations);
  CheckAtLeast("max_message_bytes", limits.max_message_bytes, 1024, violations);
  CheckAtLeast("max_import_bytes", limits.max_import_bytes, 1, violations);
  CheckAtLeast("max_imports", limits.max_imports, 1, violations);
  CheckAtLeast("max_streams", limits.max_streams, 1, violations);
  CheckAtLeast("max_slots", limits.max_slots, 1, violations);
  CheckAtLeast("max_unsent_answers", limits.max_unsent_answers, 1, violations);
  CheckPositive("write_stall", limits.write_stall, violations);
  CheckPositive("max_idle_ttl", limits.max_idle_ttl, violations);
  CheckPositive("default_idle_ttl", limits.default_idle_ttl, violations);
  CheckPositive("import_stall", limits.import_stall, violations);
  CheckPositive("heartbeat", options.heartbeat, violations);
  CheckPositive("keepalive", options.keepalive, violations);
  return violations.ToStatus();
}

}  // namespace gelenk::server
