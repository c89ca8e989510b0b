#include "server/rpc/chain_methods.h"

#include <optional>

#include "absl/strings/str_cat.h"
#include "convert/chain.h"
#include "convert/pose.h"
#include "convert/two_link.h"
#include "gelenk/base/violations.h"
#include "gelenk/kinematics/jacobian.h"
#include "gelenk/skeleton/joint_check.h"
#include "server/rpc/find_skeleton.h"
#include "server/rpc/unary_call.h"

namespace gelenk::server {
namespace {

using Service = v1::KinematicsService::AsyncService;

void ToProto(const Eigen::Matrix<double, 6, Eigen::Dynamic>& matrix,
             v1::Matrix* proto) {
  proto->set_row_count(static_cast<int>(matrix.rows()));
  proto->set_column_count(static_cast<int>(matrix.cols()));
  for (int r = 0; r < matrix.rows(); ++r) {
    for (int c = 0; c < matrix.cols(); ++c) proto->add_values(matrix(r, c));
  }
}

absl::Status ComputeJacobians(const ServiceState& state,
                              const v1::ComputeJacobianRequest& request,
                              v1::ComputeJacobianResponse* response) {
  absl::StatusOr<StoredSkeleton> stored =
      FindSkeleton(state, "skeleton", request.skeleton());
  if (!stored.ok()) return stored.status();
  const Skeleton& skeleton = *stored->skeleton;
  Violations violations;
  const std::optional<EffectorFrame> effector =
      skeleton.FindEffector(request.end_effector_id());
  if (!effector) {
    violations.Add("end_effector_id",
                   absl::StrCat("no end effector or joint ",
                                QuotedId(request.end_effector_id())));
  }
  const int most = state.options.limits.max_poses_per_call;
  if (request.poses_size() == 0 || request.poses_size() > most) {
    violations.Add("poses", absl::StrCat("want 1 to ", most, ", got ",
                                         request.poses_size()));
  }
  if (!violations.empty()) return violations.ToStatus();
  WorldTransforms frames;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
  for (int i = 0; i < request.poses_size(); ++i) {
    absl::StatusOr<Eigen::VectorXd> positions =
        convert::FromProto(skeleton, request.poses(i));
    if (!positions.ok()) {
      violations.AddStatus(absl::StrCat("poses[", i, "]"), positions.status());
      continue;
    }
    ForwardKinematics(skeleton, *positions, frames);
    ComputeJacobian(skeleton, *positions, frames, *effector, jacobian);
    ToProto(jacobian, response->add_jacobians());
  }
  return violations.ToStatus();
}

absl::Status ComputeDhTable(const ServiceState& state,
                            const v1::ComputeDhTableRequest& request,
                            v1::DhTable* response) {
  absl::StatusOr<StoredSkeleton> stored =
      FindSkeleton(state, "skeleton", request.skeleton());
  if (!stored.ok()) return stored.status();
  Violations violations;
  const absl::StatusOr<DhConvention> convention =
      convert::FromProto(request.convention());
  violations.AddStatus("", convention.status());
  const absl::StatusOr<DhTable> table = ToDhTable(
      *stored->skeleton, request.base_joint_id(), request.end_effector_id(),
      convention.value_or(DhConvention::kStandard));
  violations.AddStatus("", table.status());
  if (!violations.empty()) return violations.ToStatus();
  convert::ToProto(*table, response);
  return absl::OkStatus();
}

absl::Status SolveTwoLinks(const v1::SolveTwoLinkRequest& request,
                           v1::SolveTwoLinkResponse* response) {
  Violations violations;
  switch (request.limb_case()) {
    case v1::SolveTwoLinkRequest::kPlanar: {
      const auto problem = convert::FromProto(request.planar());
      violations.AddStatus("planar", problem.status());
      if (problem.ok()) convert::ToProto(SolveTwoLink(*problem), response);
      break;
    }
    case v1::SolveTwoLinkRequest::kTwoBone: {
      const auto problem = convert::FromProto(request.two_bone());
      violations.AddStatus("two_bone", problem.status());
      if (problem.ok()) convert::ToProto(SolveTwoBone(*problem), response);
      break;
    }
    case v1::SolveTwoLinkRequest::LIMB_NOT_SET:
      violations.Add("limb", "want planar or two_bone");
      break;
  }
  return violations.ToStatus();
}

}  // namespace

void ServeChains(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestComputeJacobian,
      [state](IkSolver&, const v1::ComputeJacobianRequest& request,
              v1::ComputeJacobianResponse* response) {
        return ComputeJacobians(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestComputeDhTable,
      [state](IkSolver&, const v1::ComputeDhTableRequest& request,
              v1::DhTable* response) {
        return ComputeDhTable(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestSolveTwoLink,
      [](IkSolver&, const v1::SolveTwoLinkRequest& request,
         v1::SolveTwoLinkResponse* response) {
        return SolveTwoLinks(request, response);
      },
      state, thread);
}

}  // namespace gelenk::server
