// Calls of KinematicsService that leave nothing behind, over the wire: batches
// and workspaces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "tests/integration/service_test.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using testing::Fails;

using Stub = v1::KinematicsService::Stub;

// Targets on circles within the reach of the arm: three links of 0.5 m.
v1::BatchSolveRequest BatchRequest(int problems) {
  v1::BatchSolveRequest request;
  request.set_skeleton("skeletons/planar-arm");
  v1::Goal& goal = *request.add_goals();
  goal.set_goal_id("reach");
  goal.mutable_position()->set_end_effector_id("tip");
  goal.mutable_position()->mutable_axes()->set_x(true);
  goal.mutable_position()->mutable_axes()->set_y(true);
  for (int i = 0; i < problems; ++i) {
    const double radius = 0.6 + 0.8 * i / problems;
    request.add_targets(radius * std::cos(0.1 * i));
    request.add_targets(radius * std::sin(0.1 * i));
    request.add_targets(0);
  }
  return request;
}

class KinematicsCallsTest : public ServiceTest {
 protected:
  // Where the arm's tip is in each pose of the answer.
  static std::vector<v1::Vector3> Tips(const v1::BatchSolveResponse& batch,
                                       int problems) {
    const int size = batch.positions_size() / problems;
    std::vector<v1::Vector3> tips;
    for (int i = 0; i < problems; ++i) {
      double angle = 0;
      v1::Vector3 tip;
      for (int k = 0; k < size; ++k) {
        angle += batch.positions(i * size + k);
        tip.set_x(tip.x() + 0.5 * std::cos(angle));
        tip.set_y(tip.y() + 0.5 * std::sin(angle));
      }
      tips.push_back(tip);
    }
    return tips;
  }

  // All parts of a workspace, and how the call ended.
  static std::vector<v1::ComputeWorkspaceResponse> Workspace(
      const v1::ComputeWorkspaceRequest& request, absl::Status* status) {
    grpc::ClientContext context;
    client::CallOptions options;
    options.timeout = testing::kPatience;
    connection().Prepare(options, context);
    const auto reader =
        connection().kinematics().ComputeWorkspace(&context, request);
    std::vector<v1::ComputeWorkspaceResponse> parts;
    v1::ComputeWorkspaceResponse part;
    while (reader->Read(&part)) parts.push_back(part);
    *status = client::FromGrpc(reader->Finish());
    return parts;
  }

  static v1::ComputeWorkspaceRequest WorkspaceRequest() {
    v1::ComputeWorkspaceRequest request;
    request.set_skeleton("skeletons/planar-arm");
    request.set_end_effector_id("tip");
    return request;
  }
};

TEST_F(KinematicsCallsTest, ABatchReachesEveryTarget) {
  constexpr int kProblems = 500;
  const v1::BatchSolveRequest request = BatchRequest(kProblems);
  const auto batch = Call(&Stub::BatchSolve, request);
  ASSERT_TRUE(batch.ok()) << batch.status();
  ASSERT_EQ(batch->outcomes_size(), kProblems);
  ASSERT_EQ(batch->positions_size(), 3 * kProblems);
  ASSERT_EQ(batch->position_errors_m_size(), kProblems);
  const std::vector<v1::Vector3> tips = Tips(*batch, kProblems);
  for (int i = 0; i < kProblems; ++i) {
    EXPECT_EQ(batch->outcomes(i), v1::SolveReport::OUTCOME_CONVERGED) << i;
    EXPECT_NEAR(tips[i].x(), request.targets(3 * i), 1.1e-4);
    EXPECT_NEAR(tips[i].y(), request.targets(3 * i + 1), 1.1e-4);
  }
}

TEST_F(KinematicsCallsTest, AWarmBatchStaysNearItsStarts) {
  v1::BatchSolveRequest request = BatchRequest(50);
  const auto cold = Call(&Stub::BatchSolve, request);
  ASSERT_TRUE(cold.ok()) << cold.status();
  *request.mutable_start_positions() = cold->positions();
  const auto warm = Call(&Stub::BatchSolve, request);
  ASSERT_TRUE(warm.ok()) << warm.status();
  for (int i = 0; i < warm->positions_size(); ++i) {
    EXPECT_NEAR(warm->positions(i), cold->positions(i), 1e-3);
  }
}

TEST_F(KinematicsCallsTest, BadBatchesAreRefusedByField) {
  v1::BatchSolveRequest uneven = BatchRequest(3);
  uneven.mutable_targets()->RemoveLast();
  EXPECT_THAT(Call(&Stub::BatchSolve, uneven).status(),
              Fails(absl::StatusCode::kInvalidArgument, "targets"));
  v1::BatchSolveRequest broken = BatchRequest(3);
  broken.set_targets(4, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(Call(&Stub::BatchSolve, broken).status(),
              Fails(absl::StatusCode::kInvalidArgument, "targets[3]"));
  v1::BatchSolveRequest starts = BatchRequest(3);
  starts.add_start_positions(1);
  EXPECT_THAT(Call(&Stub::BatchSolve, starts).status(),
              Fails(absl::StatusCode::kInvalidArgument, "start_positions"));
  EXPECT_THAT(Call(&Stub::BatchSolve, BatchRequest(0)).status(),
              Fails(absl::StatusCode::kInvalidArgument, "targets"));
}

TEST_F(KinematicsCallsTest, TheReachOfAPlanarArmIsExact) {
  absl::Status status;
  const auto parts = Workspace(WorkspaceRequest(), &status);
  ASSERT_EQ(status, absl::OkStatus());
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].annulus().inner_radius_m(), 0);
  EXPECT_EQ(parts[0].annulus().outer_radius_m(), 1.5);
  EXPECT_EQ(parts[0].annulus().world_normal().z(), 1);
}

TEST_F(KinematicsCallsTest, AMapComesInParts) {
  v1::ComputeWorkspaceRequest request = WorkspaceRequest();
  request.set_sampled(true);
  request.set_sample_count(40000);
  request.set_voxel_size_m(0.02);
  absl::Status status;
  const auto parts = Workspace(request, &status);
  ASSERT_EQ(status, absl::OkStatus());
  ASSERT_GE(parts.size(), 3u);
  const v1::VoxelGrid& grid = parts[0].grid();
  EXPECT_EQ(grid.sample_count(), 40000);
  int voxels = 0;
  int64_t samples = 0;
  int previous = -1;
  for (size_t i = 1; i < parts.size(); ++i) {
    const v1::Voxels& part = parts[i].voxels();
    ASSERT_EQ(part.reach_counts_size(), part.indices_size());
    ASSERT_EQ(part.mean_manipulabilities_size(), part.indices_size());
    for (int k = 0; k < part.indices_size(); ++k) {
      EXPECT_GT(part.indices(k), previous);
      previous = part.indices(k);
      samples += part.reach_counts(k);
      ++voxels;
    }
  }
  EXPECT_LT(previous, grid.size_x() * grid.size_y() * grid.size_z());
  EXPECT_EQ(voxels, grid.reached_count());
  EXPECT_EQ(samples, grid.sample_count());
}

TEST_F(KinematicsCallsTest, BadWorkspacesAreRefusedByField) {
  absl::Status status;
  v1::ComputeWorkspaceRequest nose = WorkspaceRequest();
  nose.set_end_effector_id("nose");
  EXPECT_TRUE(Workspace(nose, &status).empty());
  EXPECT_THAT(status,
              Fails(absl::StatusCode::kInvalidArgument, "end_effector_id"));
  v1::ComputeWorkspaceRequest fine = WorkspaceRequest();
  fine.set_sampled(true);
  fine.set_voxel_size_m(1e-9);
  EXPECT_TRUE(Workspace(fine, &status).empty());
  EXPECT_THAT(status,
              Fails(absl::StatusCode::kInvalidArgument, "voxel_size_m"));
  v1::ComputeWorkspaceRequest many = WorkspaceRequest();
  many.set_sampled(true);
  many.set_sample_count(-1);
  EXPECT_TRUE(Workspace(many, &status).empty());
  EXPECT_THAT(status,
              Fails(absl::StatusCode::kInvalidArgument, "sample_count"));
}

TEST_F(KinematicsCallsTest, TheServerTellsItsLimits) {
  const auto info = Call(&v1::KinematicsService::Stub::GetServerInfo,
                         v1::GetServerInfoRequest());
  ASSERT_TRUE(info.ok()) << info.status();
  // Every one is told: 0 is no limit that there is.
  const auto* reflection = info->GetReflection();
  const auto* descriptor = v1::ServerInfo::descriptor();
  for (int i = 0; i < descriptor->field_count(); ++i) {
    const auto* field = descriptor->field(i);
    if (!absl::StartsWith(field->name(), "max_")) continue;
    EXPECT_TRUE(reflection->HasField(*info, field)) << field->name();
  }
}

}  // namespace
}  // namespace gelenk
