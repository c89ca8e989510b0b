#include "gelenk/workspace/workspace_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/start_sampler.h"
#include "gelenk/kinematics/jacobian.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Voxels along the largest extent unless told.
constexpr int kDefaultDivisions = 64;
// An axis that no joint moves the effector along, relative to the others.
constexpr double kNoMotion = 1e-12;

// The same samples in every pass.
class Samples {
 public:
  Samples(const Skeleton& skeleton, const EffectorFrame& effector, int64_t seed)
      : skeleton_(skeleton),
        effector_(effector),
        sampler_(seed),
        rest_(skeleton.rest_positions()),
        positions_(rest_) {
    for (int i = effector.joint; i >= 0; i = skeleton.span(i).parent) {
      const int mimicked = skeleton.span(i).mimicked;
      joints_.push_back(mimicked < 0 ? i : mimicked);
    }
    std::sort(joints_.begin(), joints_.end());
    joints_.erase(std::unique(joints_.begin(), joints_.end()), joints_.end());
  }

  // Where the next sample brings the effector.
  Vector3d Next() {
    sampler_.Sample(skeleton_, joints_, rest_, positions_);
    ForwardKinematics(skeleton_, positions_, frames_);
    return frames_[effector_.joint] * effector_.joint_from_effector.translation;
  }

  // Of that sample.
  double Manipulability() {
    ComputeJacobian(skeleton_, positions_, frames_, effector_, jacobian_);
    const auto translation = jacobian_.topRows<3>();
    const Vector3d motion = translation.rowwise().norm();
    Eigen::MatrixXd rows(3, jacobian_.cols());
    int count = 0;
    for (int k = 0; k < 3; ++k) {
      if (motion[k] <= kNoMotion * motion.maxCoeff()) continue;
      rows.row(count++) = translation.row(k);
    }
    if (count == 0 || count > rows.cols()) return 0;
    const Eigen::MatrixXd used = rows.topRows(count);
    return std::sqrt(std::max(0.0, (used * used.transpose()).determinant()));
  }

 private:
  const Skeleton& skeleton_;
  const EffectorFrame effector_;
  StartSampler sampler_;
  std::vector<int> joints_;
  const Eigen::VectorXd rest_;
  Eigen::VectorXd positions_;
  WorldTransforms frames_;
  Jacobian jacobian_;
};

struct Sum {
  int32_t count = 0;
  double manipulability = 0;
};

absl::Status CheckOptions(const WorkspaceOptions& options) {
  Violations violations;
  if (options.sample_count < 1 || options.sample_count > kMaxWorkspaceSamples) {
    violations.Add("sample_count",
                   absl::StrFormat("want 1 to %d, got %d", kMaxWorkspaceSamples,
                                   options.sample_count));
  }
  if (!(std::isfinite(options.voxel_size_m) && options.voxel_size_m >= 0)) {
    violations.Add(
        "voxel_size_m",
        absl::StrCat("want a finite number >= 0, got ", options.voxel_size_m));
  }
  return violations.ToStatus();
}

}  // namespace

Vector3d WorkspaceMap::CenterOf(const ReachedVoxel& voxel) const {
  const Vector3d place(voxel.index % size.x(),
                       voxel.index / size.x() % size.y(),
                       voxel.index / size.x() / size.y());
  return world_min + voxel_size_m * (place + Vector3d::Constant(0.5));
}

Eigen::Matrix3Xd WorkspaceMap::PointCloud() const {
  Eigen::Matrix3Xd cloud(3, voxels.size());
  for (size_t i = 0; i < voxels.size(); ++i) {
    cloud.col(static_cast<int>(i)) = CenterOf(voxels[i]);
  }
  return cloud;
}

absl::StatusOr<WorkspaceMap> MapWorkspace(const Skeleton& skeleton,
                                          absl::string_view end_effector_id,
                                          const WorkspaceOptions& options) {
  Violations violations;
  const std::optional<EffectorFrame> effector =
      skeleton.FindEffector(end_effector_id);
  if (!effector) {
    violations.Add("end_effector_id", absl::StrCat("no end effector or joint ",
                                                   QuotedId(end_effector_id)));
  }
  violations.AddStatus("", CheckOptions(options));
  if (!violations.empty()) return violations.ToStatus();

  Vector3d lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d upper = -lower;
  Samples extent(skeleton, *effector, options.seed);
  for (int i = 0; i < options.sample_count; ++i) {
    const Vector3d tip = extent.Next();
    lower = lower.cwiseMin(tip);
    upper = upper.cwiseMax(tip);
  }
  WorkspaceMap map;
  map.sample_count = options.sample_count;
  map.world_min = lower;
  map.voxel_size_m = options.voxel_size_m;
  const double largest = (upper - lower).maxCoeff();
  if (map.voxel_size_m == 0) {
    // An effector that nothing moves fills one voxel of any size.
    map.voxel_size_m = largest > 0 ? largest / kDefaultDivisions : 1;
  }
  double voxel_count = 1;
  for (int k = 0; k < 3; ++k) {
    const double count =
        std::floor((upper[k] - lower[k]) / map.voxel_size_m) + 1;
    voxel_count *= count;
    map.size[k] = static_cast<int>(
        std::min(count, static_cast<double>(kMaxWorkspaceVoxels)));
  }
  if (voxel_count > static_cast<double>(kMaxWorkspaceVoxels)) {
    violations.Add(
        "voxel_size_m",
        absl::StrFormat("want at most %d voxels, got %.0f of %g m",
                        kMaxWorkspaceVoxels, voxel_count, map.voxel_size_m));
    return violations.ToStatus();
  }
  absl::flat_hash_map<int32_t, Sum> sums;
  Samples samples(skeleton, *effector, options.seed);
  for (int i = 0; i < options.sample_count; ++i) {
    const Vector3d tip = samples.Next();
    Eigen::Vector3i place;
    for (int k = 0; k < 3; ++k) {
      place[k] =
          std::clamp(static_cast<int>((tip[k] - lower[k]) / map.voxel_size_m),
                     0, map.size[k] - 1);
    }
    Sum& sum =
        sums[(place.z() * map.size.y() + place.y()) * map.size.x() + place.x()];
    ++sum.count;
    sum.manipulability += samples.Manipulability();
  }
  for (const auto& [index, sum] : sums) {
    map.voxels.push_back({index, sum.count, sum.manipulability / sum.count});
  }
  std::sort(map.voxels.begin(), map.voxels.end(),
            [](const ReachedVoxel& a, const ReachedVoxel& b) {
              return a.index < b.index;
            });
  return map;
}

}  // namespace gelenk
