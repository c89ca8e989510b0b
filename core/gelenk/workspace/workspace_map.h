// The reach of an effector by samples: poses drawn within the limits, and where
// they bring it, counted on a grid of voxels.
//
// What a map shows as reached can be reached; what it shows as empty may have
// been missed. World frame, the skeleton at the origin; m. Deterministic by
// seed, on every machine. Cost: two passes over the samples (the first finds
// the extent), each one forward kinematics a sample, and one Jacobian in the
// second: about 2 us a sample for an arm of seven joints. Memory: linear in the
// voxels that are reached.
#ifndef GELENK_WORKSPACE_WORKSPACE_MAP_H_
#define GELENK_WORKSPACE_WORKSPACE_MAP_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Some 20 s of one core.
inline constexpr int kMaxWorkspaceSamples = 10000000;
// So that an index fits 32 bits with room, and a grid an image.
inline constexpr int64_t kMaxWorkspaceVoxels = int64_t{1} << 28;

struct WorkspaceOptions {
  int sample_count = 100000;
  int64_t seed = 0;
  // Edge of a voxel; 0 means the largest extent / 64.
  double voxel_size_m = 0;
};

struct ReachedVoxel {
  // (z * size.y + y) * size.x + x.
  int32_t index = 0;
  int32_t reach_count = 0;
  // Mean of sqrt(det(J J^T)) of the translation. A row of J that is zero (the
  // way out of the plane of a planar chain) is left out.
  double mean_manipulability = 0;
};

struct WorkspaceMap {
  Eigen::Vector3d world_min = Eigen::Vector3d::Zero();
  double voxel_size_m = 0;
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  int sample_count = 0;
  // Ascending by index.
  std::vector<ReachedVoxel> voxels;

  Eigen::Vector3d CenterOf(const ReachedVoxel& voxel) const;
  // The centers of all reached voxels, one a column.
  Eigen::Matrix3Xd PointCloud() const;
};

// INVALID_ARGUMENT naming "end_effector_id", "sample_count" and "voxel_size_m"
// where they are bad: a grid of more than kMaxWorkspaceVoxels included.
absl::StatusOr<WorkspaceMap> MapWorkspace(const Skeleton& skeleton,
                                          absl::string_view end_effector_id,
                                          const WorkspaceOptions& options);

}  // namespace gelenk

#endif  // GELENK_WORKSPACE_WORKSPACE_MAP_H_
