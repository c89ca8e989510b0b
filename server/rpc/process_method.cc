#include "server/rpc/process_method.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "server/rpc/clip_creation.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/clip_steps.h"

namespace gelenk::server {
namespace {

// Each may take as long as the clip is; longer recipes are several calls.
constexpr int kMaxSteps = 16;

absl::Status CheckRequest(const v1::ProcessClipRequest& request) {
  Violations violations;
  violations.AddStatus(
      "", CheckNewClip("clip_id", request.clip_id(), request.request_id()));
  violations.AddStatus(
      "", ParseRevisionName("clip", kClips, request.clip()).status());
  if (request.steps_size() == 0 || request.steps_size() > kMaxSteps) {
    violations.Add("steps", absl::StrCat("want 1 to ", kMaxSteps, ", got ",
                                         request.steps_size()));
  }
  return violations.ToStatus();
}

}  // namespace

absl::Status ProcessClip(ServiceState& state,
                         const v1::ProcessClipRequest& request,
                         v1::Clip* response) {
  if (absl::Status status = CheckRequest(request); !status.ok()) return status;
  if (AnswerEarlier(state, request.request_id(), response)) {
    return absl::OkStatus();
  }
  const absl::StatusOr<StoredClip> source =
      FindClip(state, "clip", request.clip());
  if (!source.ok()) return source.status();
  StoredClip made = MadeClip(*source, source->clip, request.display_name());
  for (int i = 0; i < request.steps_size(); ++i) {
    const absl::Status status = ApplyStep(state, absl::StrCat("steps[", i, "]"),
                                          request.steps(i), made);
    if (!status.ok()) return status;
  }
  const absl::StatusOr<StoredClip> stored = StoreClip(
      state, {request.clip_id(), request.request_id()}, std::move(made));
  if (!stored.ok()) return stored.status();
  ToProto(*stored, response);
  return absl::OkStatus();
}

}  // namespace gelenk::server
