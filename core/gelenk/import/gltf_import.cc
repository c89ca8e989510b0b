#include "gelenk/import/gltf_import.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/formats/file_unit.h"
#include "gelenk/formats/unique_names.h"
#include "gelenk/import/gltf_joints.h"
#include "gelenk/import/gltf_placement.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

// Products of single precision numbers may be so far from 1.
constexpr double kScaleTolerance = 1e-4;

// Axes whose angle is this far from right are meant to be right; rad.
constexpr double kShearTolerance = 1e-3;

// Nobody acts in a skeleton of this size; its numbers are centimetres.
constexpr double kGiant_m = 20;

// Far above any length in any unit; keeps squares finite.
constexpr double kMaxCoordinate_m = 1e9;

bool IsUniform(const Eigen::Vector3d& scale) {
  return scale.maxCoeff() - scale.minCoeff() <=
         kScaleTolerance * scale.cwiseAbs().maxCoeff();
}

bool IsOne(const Eigen::Vector3d& scale) {
  return (scale.array() - 1).abs().maxCoeff() <= kScaleTolerance;
}

class GltfSkeletonBuilder {
 public:
  GltfSkeletonBuilder(const GltfDocument& document, const GltfJoints& joints,
                      const GltfImportOptions& options)
      : document_(document),
        joints_(joints),
        options_(options),
        placements_(PlaceGltfNodes(document)),
        ids_(kMaxIdBytes) {
    import_.warnings = joints.warnings;
    import_.unit_m = options.unit_m;
  }

  absl::StatusOr<GltfImport> Build();

 private:
  // What bends the way from the scene to the joints.
  absl::Status CheckScales();
  absl::Status CheckPositions() const;
  void TakeIds();
  std::string TakeId(int node);
  void AddCommonRoot();
  void AddJoint(size_t place);
  void AddEndEffectors();
  void WarnOfSize();

  // `nodes[3] ("hip")`
  std::string Called(int node) const;
  RigidTransform WorldFrom(int node) const;

  const GltfDocument& document_;
  const GltfJoints& joints_;
  const GltfImportOptions& options_;
  const std::vector<GltfPlacement> placements_;
  UniqueNames ids_;
  // Of `joints_.nodes`.
  std::vector<std::string> joint_ids_;
  // The parent of what hangs from no joint; empty where that is the root.
  std::string common_root_id_;
  std::vector<double> rest_positions_;
  SkeletonBuilder builder_;
  GltfImport import_;
};

absl::StatusOr<GltfImport> GltfSkeletonBuilder::Build() {
  if (absl::Status status = CheckScales(); !status.ok()) return status;
  if (absl::Status status = CheckPositions(); !status.ok()) return status;
  TakeIds();
  AddCommonRoot();
  import_.joint_of_node.assign(document_.nodes.size(), -1);
  const int first = common_root_id_.empty() ? 0 : 1;
  for (size_t i = 0; i < joints_.nodes.size(); ++i) {
    AddJoint(i);
    import_.joint_of_node[joints_.nodes[i]] = first + static_cast<int>(i);
  }
  AddEndEffectors();
  WarnOfSize();
  builder_.SetBounds(options_.bounds)
      .SetRestPositions(Eigen::Map<const Eigen::VectorXd>(
          rest_positions_.data(), rest_positions_.size()));
  absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton = builder_.Build();
  if (!skeleton.ok()) return skeleton.status();
  import_.skeleton = *std::move(skeleton);
  return std::move(import_);
}

std::string GltfSkeletonBuilder::Called(int node) const {
  const std::string& name = document_.nodes[node].name;
  return absl::StrCat(
      "nodes[", node, "]",
      name.empty() ? "" : absl::StrCat(" (", QuotedId(name), ")"));
}

absl::Status GltfSkeletonBuilder::CheckScales() {
  // Only what is above a joint moves it.
  std::vector<bool> is_above(document_.nodes.size(), false);
  for (int joint : joints_.nodes) {
    int node = document_.nodes[joint].parent;
    for (; node >= 0 && !is_above[node]; node = document_.nodes[node].parent) {
      is_above[node] = true;
    }
  }
  std::vector<int> scaled;
  std::vector<int> bent;
  for (size_t i = 0; i < is_above.size(); ++i) {
    if (!is_above[i]) continue;
    const GltfNode& node = document_.nodes[i];
    if (node.scale.prod() < 0) {
      return absl::InvalidArgumentError(absl::StrCat(
          Called(static_cast<int>(i)), ".scale: ", Text(node.scale),
          " mirrors what is below, which has then no rigid frames"));
    }
    if (!IsUniform(node.scale) || node.shear > kShearTolerance) {
      bent.push_back(static_cast<int>(i));
    } else if (!IsOne(node.scale)) {
      scaled.push_back(static_cast<int>(i));
    }
  }
  if (!scaled.empty()) {
    import_.warnings.push_back(absl::StrFormat(
        "%d nodes are scaled, the first is %s by %g: lengths are those of the "
        "scene",
        scaled.size(), Called(scaled[0]),
        document_.nodes[scaled[0]].scale.x()));
  }
  if (!bent.empty()) {
    import_.warnings.push_back(absl::StrFormat(
        "%d nodes are sheared or not scaled alike along all axes, the first "
        "is %s by %s: what is below is exact in the rest pose only",
        bent.size(), Called(bent[0]), Text(document_.nodes[bent[0]].scale)));
  }
  return absl::OkStatus();
}

absl::Status GltfSkeletonBuilder::CheckPositions() const {
  for (int node : joints_.nodes) {
    const Eigen::Vector3d position =
        options_.unit_m * placements_[node].position;
    // NaN fails the comparison.
    if (position.cwiseAbs().maxCoeff() <= kMaxCoordinate_m &&
        position.allFinite()) {
      continue;
    }
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: more than %g m from the origin", Called(node), kMaxCoordinate_m));
  }
  return absl::OkStatus();
}

// Joints first: what is called like a joint is the joint.
void GltfSkeletonBuilder::TakeIds() {
  for (int node : joints_.nodes) joint_ids_.push_back(TakeId(node));
}

std::string GltfSkeletonBuilder::TakeId(int node) {
  const std::string& name = document_.nodes[node].name;
  if (name.empty()) return ids_.Take(absl::StrCat("node", node));
  const std::string printable = PrintableUtf8(name);
  std::string id = ids_.Take(printable);
  if (id != name) {
    import_.warnings.push_back(absl::StrCat(
        "node ", node, ", \"", TruncateUtf8(printable, kMaxIdBytes),
        "\", is called \"", id, "\""));
  }
  return id;
}

void GltfSkeletonBuilder::AddCommonRoot() {
  if (std::count(joints_.parents.begin(), joints_.parents.end(), -1) == 1) {
    return;
  }
  const std::string name = PrintableUtf8(joints_.name);
  common_root_id_ = ids_.Take(name.empty() ? "root" : name);
  import_.warnings.push_back(
      absl::StrCat("several joints hang from nothing: \"", common_root_id_,
                   "\" is a root for them"));
  Joint root;
  root.id = common_root_id_;
  builder_.AddJoint(std::move(root));
}

RigidTransform GltfSkeletonBuilder::WorldFrom(int node) const {
  const GltfPlacement& placement = placements_[node];
  return {placement.rotation, options_.unit_m * placement.position};
}

void GltfSkeletonBuilder::AddJoint(size_t place) {
  const RigidTransform world_from_joint = WorldFrom(joints_.nodes[place]);
  const int parent = joints_.parents[place];
  Joint joint;
  joint.id = joint_ids_[place];
  if (parent < 0) {
    joint.type = JointType::kFree;
    joint.parent_id = common_root_id_;
    const Eigen::Vector3d& at = world_from_joint.translation;
    double xyzw[4];
    StoreXyzw(world_from_joint.rotation, xyzw);
    rest_positions_.insert(rest_positions_.end(), at.begin(), at.end());
    rest_positions_.insert(rest_positions_.end(), xyzw, xyzw + 4);
  } else {
    joint.type = JointType::kSpherical;
    joint.parent_id = joint_ids_[parent];
    joint.parent_from_joint =
        WorldFrom(joints_.nodes[parent]).Inverse() * world_from_joint;
    rest_positions_.insert(rest_positions_.end(), {0, 0, 0, 1});
  }
  builder_.AddJoint(std::move(joint));
}

void GltfSkeletonBuilder::AddEndEffectors() {
  const size_t most = std::max(0, options_.bounds.max_end_effectors);
  size_t count = 0;
  for (size_t i = 0; i < document_.nodes.size(); ++i) {
    const GltfNode& node = document_.nodes[i];
    const int place = joints_.place_above[i];
    if (place < 0 || import_.joint_of_node[i] >= 0) continue;
    // A frame without a name is of no use, and a skinned mesh is nowhere.
    if (node.name.empty() || node.has_skin) continue;
    if (++count > most) continue;
    EndEffector effector;
    effector.id = TakeId(static_cast<int>(i));
    effector.joint_id = joint_ids_[place];
    effector.joint_from_end_effector =
        WorldFrom(joints_.nodes[place]).Inverse() *
        WorldFrom(static_cast<int>(i));
    builder_.AddEndEffector(std::move(effector));
  }
  if (count > most) {
    import_.warnings.push_back(absl::StrFormat(
        "%d nodes below joints are no end effectors: there are %d already",
        count - most, most));
  }
}

void GltfSkeletonBuilder::WarnOfSize() {
  Eigen::AlignedBox3d box;
  for (int node : joints_.nodes) {
    box.extend(options_.unit_m * placements_[node].position);
  }
  const double size_m = box.sizes().maxCoeff();
  if (size_m <= kGiant_m) return;
  import_.warnings.push_back(absl::StrFormat(
      "the skeleton is %.3g m large; should the file's unit be another than "
      "the metre, give it",
      size_m));
}

}  // namespace

absl::StatusOr<GltfImport> ImportGltf(const GltfDocument& document,
                                      const GltfImportOptions& options) {
  if (absl::Status status = CheckFileUnit(options.unit_m); !status.ok()) {
    return status;
  }
  const absl::StatusOr<GltfJoints> joints =
      FindGltfJoints(document, options.skin);
  if (!joints.ok()) return joints.status();
  return GltfSkeletonBuilder(document, *joints, options).Build();
}

}  // namespace gelenk
