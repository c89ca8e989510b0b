#include "gelenk/skin/nurbs_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/skin/nurbs_collocation.h"

namespace gelenk {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Joints are bent by this much, one way and the other, to see how well a net
// follows.
constexpr double kProbeBendRad = 0.8;
constexpr int kMaxRefinements = 12;
// Below this reciprocal condition the Greville points do not determine the net.
constexpr double kSingular = 1e-10;
// Where in each knot span the skin is compared.
constexpr double kCheckAt[] = {0.25, 0.75};

std::vector<double> CheckParameters(const NurbsAxis& axis) {
  const std::vector<double> ends = SpanEnds(axis);
  std::vector<double> parameters;
  for (size_t i = 0; i + 1 < ends.size(); ++i) {
    for (double at : kCheckAt) {
      parameters.push_back(ends[i] + at * (ends[i + 1] - ends[i]));
    }
  }
  return parameters;
}

// Every joint that turns, bent either way, within its limits.
std::vector<Eigen::VectorXd> ProbePoses(const VolumeRig& rig) {
  const Skeleton& skeleton = rig.skeleton();
  std::vector<Eigen::VectorXd> poses;
  for (double sign : {1.0, -1.0}) {
    Eigen::VectorXd velocity = Eigen::VectorXd::Zero(skeleton.velocity_count());
    for (int i = 0; i < skeleton.joint_count(); ++i) {
      const int offset = skeleton.span(i).velocity_offset;
      if (offset < 0) continue;
      if (skeleton.joint(i).type == JointType::kRevolute) {
        velocity[offset] = sign * kProbeBendRad;
      } else if (skeleton.joint(i).type == JointType::kSpherical) {
        velocity.segment<3>(offset) =
            sign * kProbeBendRad * Vector3d(0.3, 0.8, -0.5).normalized();
      }
    }
    Eigen::VectorXd& pose = poses.emplace_back(rig.rest_positions());
    Integrate(skeleton, rig.rest_positions(), velocity, pose);
    ClampToLimits(skeleton, pose);
  }
  return poses;
}

class NurbsFitting {
 public:
  NurbsFitting(const VolumeRig& rig, double tolerance_m, int max_points)
      : rig_(rig),
        tolerance_m_(tolerance_m),
        max_points_(max_points),
        poses_(ProbePoses(rig)) {}

  absl::StatusOr<NurbsFit> Run(const NurbsSurface& surface) {
    topology_ = TopologyOf(surface);
    absl::StatusOr<NurbsFit> fit = FitOf(surface);
    if (!fit.ok()) return fit.status();
    for (int round = 0; round < kMaxRefinements && fit->error_m > tolerance_m_;
         ++round) {
      // Finer along u or along v, whichever helps more.
      std::vector<NurbsFit> finer;
      for (bool along_u : {true, false}) {
        NurbsSurface refined = fit->surface;
        if (along_u) {
          RefineU(fit->bad_u, refined);
        } else {
          RefineV(fit->bad_v, refined);
        }
        if (static_cast<int>(refined.points.size()) > max_points_ ||
            std::max(refined.u.count(), refined.v.count()) > kMaxNurbsCount) {
          continue;
        }
        absl::StatusOr<NurbsFit> candidate = FitOf(refined);
        if (candidate.ok()) finer.push_back(*std::move(candidate));
      }
      const auto best = std::min_element(
          finer.begin(), finer.end(), [](const NurbsFit& a, const NurbsFit& b) {
            return a.error_m < b.error_m;
          });
      if (best == finer.end()) break;
      *fit = std::move(*best);
    }
    return fit;
  }

 private:
  absl::StatusOr<std::shared_ptr<const LayeredSkin>> BindGrid(
      const NurbsSurface& surface, const std::vector<double>& us,
      const std::vector<double>& vs, const WeldedGrid& grid) const {
    TriangleMesh mesh;
    for (const auto& [i, j] : grid.first) {
      mesh.positions.push_back(EvaluateNurbs(surface, us[i], vs[j]).position);
    }
    mesh.triangles = grid.Triangles();
    absl::StatusOr<SkinBinding> binding = BindMesh(rig_, mesh);
    if (!binding.ok()) return binding.status();
    return LayeredSkin::Create(
        rig_.WithHalfExtents(HalfExtents()), mesh,
        std::make_shared<const SkinBinding>(*std::move(binding)));
  }

  std::vector<Vector2d> HalfExtents() const {
    std::vector<Vector2d> half_extents;
    for (const SkinLink& link : rig_.links()) {
      half_extents.push_back(link.half_extents_m);
    }
    return half_extents;
  }

  absl::StatusOr<NurbsFit> FitOf(const NurbsSurface& surface) const {
    NurbsFit fit;
    fit.surface = surface;
    fit.topology = topology_;
    const std::vector<double> us = GrevilleAbscissae(surface.u);
    const std::vector<double> vs = GrevilleAbscissae(surface.v);
    const Eigen::PartialPivLU<MatrixXd> by_u(Collocation(surface.u, us));
    const Eigen::PartialPivLU<MatrixXd> by_v(Collocation(surface.v, vs));
    for (const auto& [lu, field] :
         {std::pair(&by_u, "u_knots"), std::pair(&by_v, "v_knots")}) {
      if (lu->rcond() > kSingular) continue;
      return absl::InvalidArgumentError(absl::StrCat(
          field,
          ": points of the surface do not determine the net; clamp the "
          "knots"));
    }
    fit.u_inverse = by_u.inverse();
    fit.v_inverse = by_v.inverse();
    const WeldedGrid grid(surface.u.count(), surface.v.count(), topology_);
    fit.vertices = grid.vertex;
    auto greville = BindGrid(surface, us, vs, grid);
    if (!greville.ok()) return greville.status();
    fit.greville = *std::move(greville);
    if (absl::Status status = Compare(fit); !status.ok()) return status;
    return fit;
  }

  // The skin against the deformed surface at the probe poses.
  absl::Status Compare(NurbsFit& fit) const {
    const std::vector<double> us = CheckParameters(fit.surface.u);
    const std::vector<double> vs = CheckParameters(fit.surface.v);
    const WeldedGrid grid(static_cast<int>(us.size()),
                          static_cast<int>(vs.size()), NurbsTopology{});
    auto checks = BindGrid(fit.surface, us, vs, grid);
    if (!checks.ok()) return checks.status();
    std::vector<double> worst_u(us.size(), 0), worst_v(vs.size(), 0);
    for (const Eigen::VectorXd& pose : poses_) {
      VolumeFrame frame;
      rig_.Evaluate(pose, {}, frame);
      fit.deformed.push_back(Deformed(fit, frame));
      std::vector<Vector3d> want;
      (*checks)->DeformExactly(frame, want, nullptr);
      for (int i = 0; i < grid.rows; ++i) {
        for (int j = 0; j < grid.columns; ++j) {
          const double error =
              (EvaluateNurbs(fit.deformed.back(), us[i], vs[j]).position -
               want[i * grid.columns + j])
                  .norm();
          worst_u[i] = std::max(worst_u[i], error);
          worst_v[j] = std::max(worst_v[j], error);
        }
      }
    }
    fit.error_m = *std::max_element(worst_u.begin(), worst_u.end());
    fit.bad_u = BadSpans(fit.surface.u, worst_u);
    fit.bad_v = BadSpans(fit.surface.v, worst_v);
    return absl::OkStatus();
  }

  NurbsSurface Deformed(const NurbsFit& fit, const VolumeFrame& frame) const {
    std::vector<Vector3d> greville;
    fit.greville->DeformExactly(frame, greville, nullptr);
    NurbsSurface surface = fit.surface;
    const int rows = surface.u.count(), columns = surface.v.count();
    const std::vector<double> greville_weights = GrevilleWeights(surface);
    for (int c = 0; c < 3; ++c) {
      MatrixXd values(rows, columns);
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
          const int at = surface.index(i, j);
          values(i, j) = greville_weights[at] * greville[fit.vertices[at]][c];
        }
      }
      const MatrixXd net = fit.u_inverse * values * fit.v_inverse.transpose();
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
          const int at = surface.index(i, j);
          surface.points[at][c] = net(i, j) / surface.weights[at];
        }
      }
    }
    return surface;
  }

  // The middles of the spans that are off, or of all when none is much.
  std::vector<double> BadSpans(const NurbsAxis& axis,
                               const std::vector<double>& worst) const {
    const std::vector<double> ends = SpanEnds(axis);
    const size_t per_span = std::size(kCheckAt);
    std::vector<double> middles;
    for (size_t i = 0; i + 1 < ends.size(); ++i) {
      const double error = *std::max_element(
          worst.begin() + per_span * i, worst.begin() + per_span * (i + 1));
      if (error > tolerance_m_) {
        middles.push_back(0.5 * (ends[i] + ends[i + 1]));
      }
    }
    return middles;
  }

  const VolumeRig& rig_;
  const double tolerance_m_;
  const int max_points_;
  const std::vector<Eigen::VectorXd> poses_;
  NurbsTopology topology_;
};

}  // namespace

absl::StatusOr<NurbsFit> FitNurbs(const VolumeRig& rig,
                                  const NurbsSurface& surface,
                                  double tolerance_m, int max_points) {
  return NurbsFitting(rig, tolerance_m, max_points).Run(surface);
}

}  // namespace gelenk
