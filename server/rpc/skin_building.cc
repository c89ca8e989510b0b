#include "server/rpc/skin_building.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/muscle.h"
#include "convert/pose.h"
#include "convert/skin_binding.h"
#include "convert/skin_deformer.h"
#include "convert/skin_surface.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/nurbs_skin.h"
#include "gelenk/skin/section_fit.h"
#include "gelenk/skin/weighted_skin.h"

namespace gelenk::server {
namespace {

using SkinOr = absl::StatusOr<std::shared_ptr<const Skin>>;

constexpr int kDefaultShapeVertices = 10000;

// Widens the pointer; keeps the error.
template <class Kind>
SkinOr AsSkin(absl::StatusOr<std::shared_ptr<const Kind>> skin) {
  if (!skin.ok()) return skin.status();
  return std::shared_ptr<const Skin>(*std::move(skin));
}

absl::Status Below(absl::string_view field, const absl::Status& status) {
  Violations violations;
  violations.AddStatus(field, status);
  return violations.ToStatus();
}

absl::Status Wrong(absl::string_view field, absl::string_view description) {
  Violations violations;
  violations.Add(field, description);
  return violations.ToStatus();
}

// The control points as a mesh: what the surface fits in.
TriangleMesh ControlNet(const NurbsSurface& surface) {
  TriangleMesh net;
  net.positions = surface.points;
  const int rows = surface.u.count();
  const int columns = surface.v.count();
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j + 1 < columns; ++j) {
      const int a = i * columns + j;
      net.triangles.push_back({a, a + columns, a + 1});
      net.triangles.push_back({a + 1, a + columns, a + columns + 1});
    }
  }
  return net;
}

class SkinBuilding {
 public:
  SkinBuilding(std::shared_ptr<const Skeleton> skeleton, const v1::Skin& proto,
               const Limits& limits)
      : skeleton_(std::move(skeleton)), proto_(proto), limits_(limits) {}

  SkinOr Build() {
    if (absl::Status status = ReadSurface(); !status.ok()) return status;
    if (proto_.has_bind_pose()) {
      absl::StatusOr<Eigen::VectorXd> pose =
          convert::FromProto(*skeleton_, proto_.bind_pose());
      if (!pose.ok()) return Below("bind_pose", pose.status());
      links_.rest_positions = *std::move(pose);
    }
    switch (proto_.deformer_case()) {
      case v1::Skin::kLinearBlend:
        return BuildWeighted("linear_blend", BlendMethod::kLinear,
                             proto_.linear_blend());
      case v1::Skin::kDualQuaternion:
        return BuildWeighted("dual_quaternion", BlendMethod::kDualQuaternion,
                             proto_.dual_quaternion());
      case v1::Skin::kRigidAttachment:
        return BuildRigid();
      default:
        return BuildLayered();
    }
  }

 private:
  MeshBounds Bounds() const {
    return {limits_.max_skin_vertices, limits_.max_skin_triangles};
  }
  int vertex_count() const { return static_cast<int>(mesh_.positions.size()); }

  absl::Status ReadSurface() {
    switch (proto_.surface_case()) {
      case v1::Skin::kMesh: {
        absl::StatusOr<TriangleMesh> mesh =
            convert::FromProto(proto_.mesh(), Bounds());
        if (!mesh.ok()) return Below("mesh", mesh.status());
        mesh_ = *std::move(mesh);
        return absl::OkStatus();
      }
      case v1::Skin::kShape:
        return ReadShape();
      case v1::Skin::kNurbs:
        if (!IsLayered()) {
          return Wrong("nurbs", "is deformed by layered_volumes only");
        }
        return absl::OkStatus();
      case v1::Skin::SURFACE_NOT_SET:
        break;
    }
    return Wrong("surface", "want one of mesh, nurbs and shape");
  }

  absl::Status ReadShape() {
    const int wanted = proto_.shape().vertex_count();
    absl::StatusOr<SkinShape> shape =
        MakeSkinShape(proto_.shape().shape_id(),
                      wanted == 0 ? kDefaultShapeVertices : wanted);
    if (!shape.ok()) return Below("shape", shape.status());
    const absl::Status status = CheckMesh(shape->mesh, Bounds());
    if (!status.ok()) return Below("shape", status);
    skeleton_ = std::move(shape->skeleton);
    mesh_ = std::move(shape->mesh);
    links_ = std::move(shape->links);
    muscles_ = std::move(shape->muscles);
    return absl::OkStatus();
  }

  bool IsLayered() const {
    return proto_.has_layered_volumes() ||
           proto_.deformer_case() == v1::Skin::DEFORMER_NOT_SET;
  }

  // What is told of links and muscles, over what a shape has.
  absl::Status ReadVolumes() {
    if (!proto_.has_layered_volumes()) return absl::OkStatus();
    const v1::LayeredVolumes& volumes = proto_.layered_volumes();
    const SkinLinkOptions told = convert::FromProto(volumes);
    if (volumes.has_slenderness()) links_.slenderness = told.slenderness;
    links_.overrides.insert(links_.overrides.end(), told.overrides.begin(),
                            told.overrides.end());
    absl::StatusOr<SkinMuscles> muscles =
        convert::FromProto(volumes.muscles(), volumes.fullness());
    if (!muscles.ok()) return muscles.status();
    // A shape keeps its own where none are told.
    if (volumes.muscles_size() > 0 || volumes.fullness_size() > 0) {
      muscles_ = *std::move(muscles);
    }
    return absl::OkStatus();
  }

  SkinOr BuildLayered() {
    if (absl::Status status = ReadVolumes(); !status.ok()) {
      return Below("layered_volumes", status);
    }
    absl::StatusOr<std::shared_ptr<const VolumeRig>> rig =
        VolumeRig::Create(skeleton_, links_, muscles_);
    if (!rig.ok()) return Below("layered_volumes", rig.status());
    return proto_.has_nurbs() ? BuildNurbs(**rig) : BindMeshIn(**rig);
  }

  SkinOr BindMeshIn(const VolumeRig& rig) {
    const absl::StatusOr<std::vector<VertexAssignment>> assignments =
        ReadAssignments(rig);
    if (!assignments.ok()) {
      return Below("layered_volumes", assignments.status());
    }
    const std::shared_ptr<const VolumeRig> fitted = Fitted(rig);
    absl::StatusOr<SkinBinding> binding =
        BindMesh(*fitted, mesh_, *assignments);
    if (!binding.ok()) return Below("layered_volumes", binding.status());
    return AsSkin(LayeredSkin::Create(
        fitted, mesh_,
        std::make_shared<const SkinBinding>(*std::move(binding))));
  }

  absl::StatusOr<std::vector<VertexAssignment>> ReadAssignments(
      const VolumeRig& rig) const {
    const auto& proto = proto_.layered_volumes().assignments();
    Violations violations;
    for (int i = 0; i < proto.size(); ++i) {
      if (rig.FindLink(proto[i].link_id()) >= 0) continue;
      violations.Add(absl::StrCat("assignments[", i, "].link_id"),
                     absl::StrCat("no link ", QuotedId(proto[i].link_id())));
    }
    if (!violations.empty()) return violations.ToStatus();
    return convert::FromProto(proto, vertex_count());
  }

  // `rig` with sections that fit the mesh, but for those that were given.
  std::shared_ptr<const VolumeRig> Fitted(const VolumeRig& rig) const {
    std::shared_ptr<const VolumeRig> fitted = FitSections(rig, mesh_);
    std::vector<Eigen::Vector2d> half_extents;
    for (const SkinLink& link : fitted->links()) {
      half_extents.push_back(link.half_extents_m);
    }
    bool are_given = false;
    for (const SkinLinkOverride& given : links_.overrides) {
      const int link = fitted->FindLink(given.joint_id);
      if (link < 0 || !given.half_extents_m) continue;
      half_extents[link] = *given.half_extents_m;
      are_given = true;
    }
    return are_given ? fitted->WithHalfExtents(half_extents) : fitted;
  }

  SkinOr BuildNurbs(const VolumeRig& rig) {
    if (proto_.layered_volumes().assignments_size() > 0) {
      return Wrong("layered_volumes.assignments",
                   "a NURBS surface has no vertices to assign");
    }
    const absl::StatusOr<NurbsSurface> surface =
        convert::FromProto(proto_.nurbs());
    if (!surface.ok()) return Below("nurbs", surface.status());
    const absl::Status status = CheckNurbs(*surface);
    if (absl::IsUnimplemented(status)) {
      return absl::UnimplementedError(
          absl::StrCat("skin.nurbs.", status.message()));
    }
    if (!status.ok()) return Below("nurbs", status);
    mesh_ = ControlNet(*surface);
    NurbsSkinOptions options;
    options.max_vertices =
        std::min(options.max_vertices, limits_.max_skin_vertices);
    if (proto_.nurbs().has_tolerance_m()) {
      options.tolerance_m = proto_.nurbs().tolerance_m();
    }
    absl::StatusOr<std::shared_ptr<const NurbsSkin>> skin =
        NurbsSkin::Create(*Fitted(rig), *surface, options);
    if (!skin.ok()) return Below("nurbs", skin.status());
    return AsSkin(std::move(skin));
  }

  SkinOr BuildWeighted(absl::string_view field, BlendMethod method,
                       const v1::VertexWeights& proto) {
    absl::StatusOr<convert::WeightsOfJoints> weights =
        convert::FromProto(*skeleton_, proto);
    if (!weights.ok()) return Below(field, weights.status());
    WeightedSkin::Options options;
    options.method = method;
    options.rest_positions = links_.rest_positions;
    options.joint_from_mesh = std::move(weights->joint_from_mesh);
    SkinOr skin = AsSkin(
        WeightedSkin::Create(skeleton_, mesh_, weights->weights, options));
    return skin.ok() ? skin : Below(field, skin.status());
  }

  SkinOr BuildRigid() const {
    const std::string& id = proto_.rigid_attachment().joint_id();
    const int joint = skeleton_->FindJoint(id);
    if (joint < 0) {
      return Wrong("rigid_attachment.joint_id",
                   absl::StrCat("no joint ", QuotedId(id)));
    }
    WeightedSkin::Options options;
    options.rest_positions = links_.rest_positions;
    options.rigid_joint = joint;
    return AsSkin(WeightedSkin::Create(
        skeleton_, mesh_, RigidWeights(vertex_count(), joint), options));
  }

  std::shared_ptr<const Skeleton> skeleton_;
  const v1::Skin& proto_;
  const Limits& limits_;
  TriangleMesh mesh_;
  SkinLinkOptions links_;
  SkinMuscles muscles_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const Skin>> BuildSkin(
    std::shared_ptr<const Skeleton> skeleton, const v1::Skin& proto,
    const Limits& limits) {
  return SkinBuilding(std::move(skeleton), proto, limits).Build();
}

SkinRevision MakeRevision(std::shared_ptr<const Skin> skin) {
  SkinRevision revision;
  if (const LayeredSkin* layered = AsLayered(*skin)) {
    const BindingReport report =
        ReportOf(layered->rig(), layered->mesh(), layered->binding());
    revision.class_counts = report.class_counts;
    revision.stretched_edge_count = report.stretched_edge_count;
  }
  revision.skin = std::move(skin);
  return revision;
}

const VolumeRig* RigOf(const Skin& skin) {
  if (const LayeredSkin* layered = AsLayered(skin)) return &layered->rig();
  const auto* nurbs = dynamic_cast<const NurbsSkin*>(&skin);
  return nurbs == nullptr ? nullptr : &nurbs->greville_skin().rig();
}

const LayeredSkin* AsLayered(const Skin& skin) {
  return dynamic_cast<const LayeredSkin*>(&skin);
}

}  // namespace gelenk::server
