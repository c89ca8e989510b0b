#include "gelenk/import/gltf_writer.h"

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "gelenk/import/gltf_file.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"

namespace gelenk {
namespace {

using nlohmann::json;

class GltfWriter {
 public:
  explicit GltfWriter(const MotionClip& clip)
      : clip_(clip), skeleton_(*clip.skeleton()) {}

  absl::StatusOr<std::string> Write(GltfForm form);

 private:
  void AddNodes();
  absl::Status AddAnimation();
  // True when its tracks can be written as they are.
  bool IsDirect(int joint) const;
  void AddTrack(const JointTrack& track);
  absl::Status AddSampled(const std::vector<int>& joints);
  void AddChannel(int node, const char* path, int input, int output,
                  Interpolation interpolation);

  const MotionClip& clip_;
  const Skeleton& skeleton_;
  GltfFile file_;
  json& root_ = file_.root;
  json animation_ = {{"channels", json::array()}, {"samplers", json::array()}};
};

void GltfWriter::AddNodes() {
  json& nodes = root_["nodes"];
  json joints = json::array();
  std::vector<json> children(skeleton_.joint_count(), json::array());
  const Eigen::VectorXd& base = clip_.properties().base_positions;
  for (int i = 0; i < skeleton_.joint_count(); ++i) {
    const Joint& joint = skeleton_.joint(i);
    const RigidTransform local =
        joint.parent_from_joint * JointMotion(skeleton_, i, base);
    nodes.push_back({{"name", joint.id},
                     {"translation", GltfNumbers(local.translation)},
                     {"rotation", GltfNumbers(local.rotation.coeffs())}});
    joints.push_back(i);
    if (skeleton_.span(i).parent >= 0) {
      children[skeleton_.span(i).parent].push_back(i);
    }
  }
  for (const EndEffector& effector : skeleton_.end_effectors()) {
    const RigidTransform& local = effector.joint_from_end_effector;
    children[skeleton_.FindJoint(effector.joint_id)].push_back(nodes.size());
    nodes.push_back({{"name", effector.id},
                     {"translation", GltfNumbers(local.translation)},
                     {"rotation", GltfNumbers(local.rotation.coeffs())}});
  }
  for (size_t i = 0; i < children.size(); ++i) {
    if (!children[i].empty()) nodes[i]["children"] = std::move(children[i]);
  }
  root_["scenes"] = json::array({{{"nodes", json::array({0})}}});
  root_["scene"] = 0;
  root_["skins"] =
      json::array({{{"joints", std::move(joints)}, {"skeleton", 0}}});
}

void GltfWriter::AddChannel(int node, const char* path, int input, int output,
                            Interpolation interpolation) {
  const char* const name = interpolation == Interpolation::kStep ? "STEP"
                           : interpolation == Interpolation::kLinear
                               ? "LINEAR"
                               : "CUBICSPLINE";
  json& samplers = animation_["samplers"];
  animation_["channels"].push_back(
      {{"sampler", samplers.size()},
       {"target", {{"node", node}, {"path", path}}}});
  samplers.push_back(
      {{"input", input}, {"output", output}, {"interpolation", name}});
}

bool GltfWriter::IsDirect(int joint) const {
  const JointType type = skeleton_.joint(joint).type;
  if (type != JointType::kSpherical && type != JointType::kFree) return false;
  for (int i = 0; i < clip_.track_count(); ++i) {
    const JointTrack& track = clip_.track(i);
    if (track.joint == joint &&
        track.interpolation == Interpolation::kCatmullRom) {
      return false;
    }
  }
  return true;
}

void GltfWriter::AddTrack(const JointTrack& track) {
  const RigidTransform& rest = skeleton_.joint(track.joint).parent_from_joint;
  const bool is_rotation = track.kind == PosePartKind::kRotation;
  // In the parent's frame, as the format has it; both maps are linear.
  const auto mapped = [&](const Eigen::MatrixXd& columns, bool is_tangent) {
    Eigen::MatrixXd result(columns.rows(), columns.cols());
    for (Eigen::Index i = 0; i < columns.cols(); ++i) {
      if (is_rotation) {
        result.col(i) =
            (rest.rotation * QuaternionXyzw(columns.col(i).data())).coeffs();
      } else {
        const Eigen::Vector3d turned =
            rest.rotation * Eigen::Vector3d(columns.col(i));
        result.col(i) = is_tangent ? turned : turned + rest.translation;
      }
    }
    return result;
  };
  const int input =
      file_.AddFloats(Eigen::Map<const Eigen::RowVectorXd>(track.times_s.data(),
                                                           track.key_count()),
                      true);
  Eigen::MatrixXd values = mapped(track.values, false);
  if (track.interpolation == Interpolation::kCubicSpline) {
    const Eigen::MatrixXd in = mapped(track.in_tangents, true);
    const Eigen::MatrixXd out = mapped(track.out_tangents, true);
    Eigen::MatrixXd triples(values.rows(), 3 * values.cols());
    for (Eigen::Index i = 0; i < values.cols(); ++i) {
      triples.col(3 * i) = in.col(i);
      triples.col(3 * i + 1) = values.col(i);
      triples.col(3 * i + 2) = out.col(i);
    }
    values = std::move(triples);
  }
  AddChannel(track.joint, is_rotation ? "rotation" : "translation", input,
             file_.AddFloats(values), track.interpolation);
}

absl::Status GltfWriter::AddSampled(const std::vector<int>& joints) {
  if (joints.empty()) return absl::OkStatus();
  const double frame_time_s = FrameTimeOf(clip_);
  const absl::StatusOr<Eigen::MatrixXd> frames =
      FramesFromClip(clip_, frame_time_s);
  if (!frames.ok()) return frames.status();
  const Eigen::Index count = frames->cols();
  const int input = file_.AddFloats(
      frame_time_s * Eigen::RowVectorXd::LinSpaced(
                         count, 0, static_cast<double>(count - 1)),
      true);
  for (int joint : joints) {
    const RigidTransform& rest = skeleton_.joint(joint).parent_from_joint;
    Eigen::MatrixXd translations(3, count);
    Eigen::MatrixXd rotations(4, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const RigidTransform local =
          rest * JointMotion(skeleton_, joint, frames->col(i));
      translations.col(i) = local.translation;
      rotations.col(i) = local.rotation.coeffs();
      if (i > 0 && rotations.col(i).dot(rotations.col(i - 1)) < 0) {
        rotations.col(i) *= -1;
      }
    }
    AddChannel(joint, "rotation", input, file_.AddFloats(rotations),
               Interpolation::kLinear);
    const JointType type = skeleton_.joint(joint).type;
    if (type != JointType::kSpherical && type != JointType::kRevolute) {
      AddChannel(joint, "translation", input, file_.AddFloats(translations),
                 Interpolation::kLinear);
    }
  }
  return absl::OkStatus();
}

absl::Status GltfWriter::AddAnimation() {
  std::vector<int> sampled;
  for (int joint = 0; joint < skeleton_.joint_count(); ++joint) {
    if (skeleton_.joint(joint).type == JointType::kFixed) continue;
    bool moves = false;
    for (PosePartKind kind :
         {PosePartKind::kNumbers, PosePartKind::kRotation}) {
      const int driver = skeleton_.span(joint).mimicked;
      const int track = clip_.FindTrack(driver < 0 ? joint : driver, kind);
      if (track < 0) continue;
      moves = true;
      if (IsDirect(joint)) AddTrack(clip_.track(track));
    }
    if (moves && !IsDirect(joint)) sampled.push_back(joint);
  }
  const absl::Status status = AddSampled(sampled);
  if (!status.ok()) return status;
  if (animation_["channels"].empty()) return status;
  if (!clip_.name().empty()) animation_["name"] = clip_.name();
  root_["animations"] = json::array({std::move(animation_)});
  return status;
}

absl::StatusOr<std::string> GltfWriter::Write(GltfForm form) {
  root_["asset"] = {{"version", "2.0"}, {"generator", "gelenk"}};
  AddNodes();
  const absl::Status status = AddAnimation();
  if (!status.ok()) return status;
  return std::move(file_).Finish(form);
}

}  // namespace

absl::StatusOr<std::string> WriteGltf(const MotionClip& clip, GltfForm form) {
  return GltfWriter(clip).Write(form);
}

}  // namespace gelenk
