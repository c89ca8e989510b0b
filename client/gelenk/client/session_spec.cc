#include "gelenk/client/session_spec.h"

#include <map>
#include <set>

#include "absl/strings/str_cat.h"

namespace gelenk::client {
namespace {

std::string RandomId(absl::string_view prefix, std::mt19937_64& random) {
  return absl::StrCat(prefix, "-", absl::Hex(random(), absl::kZeroPad16));
}

void CompleteSkeleton(v1::CreateSkeletonRequest& skeleton,
                      std::mt19937_64& random) {
  if (!skeleton.has_skeleton()) return;
  if (skeleton.skeleton_id().empty()) {
    skeleton.set_skeleton_id(RandomId("skeleton", random));
  }
  if (skeleton.request_id().empty()) {
    skeleton.set_request_id(RandomId("create", random));
  }
}

std::string NameOf(const v1::CreateSkeletonRequest& skeleton) {
  return absl::StrCat("skeletons/", skeleton.skeleton_id());
}

void CompleteSpec(SessionSpec* spec, std::mt19937_64& random) {
  const v1::CreateSkeletonRequest& skeleton = spec->skeleton;
  const v1::CreateSkeletonRequest& source = spec->source_skeleton;
  CompleteSkeleton(spec->skeleton, random);
  CompleteSkeleton(spec->source_skeleton, random);
  v1::CreateSessionRequest& session = spec->session;
  if (!session.has_session()) return;
  if (session.session_id().empty()) {
    session.set_session_id(RandomId("session", random));
  }
  if (session.request_id().empty()) {
    session.set_request_id(RandomId("create", random));
  }
  if (session.session().skeleton().empty() && skeleton.has_skeleton()) {
    session.mutable_session()->set_skeleton(NameOf(skeleton));
  }
  if (session.session().has_retargeting() && source.has_skeleton() &&
      session.session().retargeting().source_skeleton().empty()) {
    session.mutable_session()->mutable_retargeting()->set_source_skeleton(
        NameOf(source));
  }
}

// Sessions of one skeleton repeat one request, so that the server answers its
// first result instead of ALREADY_EXISTS.
void ShareSkeletonRequests(std::vector<SessionSpec>* specs) {
  std::map<std::string, std::string> request_of_id;
  for (SessionSpec& spec : *specs) {
    for (v1::CreateSkeletonRequest* request :
         {&spec.skeleton, &spec.source_skeleton}) {
      if (!request->has_skeleton()) continue;
      request->set_request_id(
          request_of_id.emplace(request->skeleton_id(), request->request_id())
              .first->second);
    }
  }
}

absl::Status Check(const std::vector<SessionSpec>& specs) {
  if (specs.empty()) {
    return absl::InvalidArgumentError("specs: a stream needs a session");
  }
  std::set<std::string> names;
  for (size_t i = 0; i < specs.size(); ++i) {
    const std::string& id = specs[i].session.session_id();
    const std::string field = absl::StrCat("specs[", i, "].session");
    if (id.empty()) {
      return absl::InvalidArgumentError(
          absl::StrCat(field, ": neither session nor session_id"));
    }
    if (!names.insert(id).second) {
      return absl::InvalidArgumentError(
          absl::StrCat(field, ".session_id: \"", id, "\" is there twice"));
    }
    const std::string key = AffinityKey(specs[i]);
    const std::string first = AffinityKey(specs[0]);
    if (key != first) {
      return absl::InvalidArgumentError(absl::StrCat(
          field, ".session.affinity_key: \"", key, "\" is not \"", first,
          "\"; sessions that share a stream share an affinity key"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

std::string SessionName(const SessionSpec& spec) {
  return absl::StrCat("sessions/", spec.session.session_id());
}

std::string AffinityKey(const SessionSpec& spec) {
  const std::string& key = spec.session.session().affinity_key();
  return key.empty() ? spec.session.session_id() : key;
}

absl::Status Complete(std::vector<SessionSpec>* specs,
                      std::mt19937_64& random) {
  for (SessionSpec& spec : *specs) CompleteSpec(&spec, random);
  ShareSkeletonRequests(specs);
  return Check(*specs);
}

}  // namespace gelenk::client
