#include "gelenk/skin/nurbs_skin.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

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
// Of the surface's size: points of a row that is one point.
constexpr double kPole = 1e-9;
constexpr int kMaxSegmentsPerSpan = 16;
// Where in each knot span the skin is compared.
constexpr double kCheckAt[] = {0.25, 0.75};

// Functions of the columns, points of the rows.
MatrixXd Collocation(const NurbsAxis& axis,
                     const std::vector<double>& parameters) {
  MatrixXd matrix = MatrixXd::Zero(parameters.size(), axis.count());
  for (size_t row = 0; row < parameters.size(); ++row) {
    const NurbsBasis basis = BasisAt(axis, parameters[row]);
    for (int i = 0; i <= axis.degree; ++i) {
      matrix(row, basis.first + i) = basis.values[i];
    }
  }
  return matrix;
}

// Knots of the domain, each once.
std::vector<double> SpanEnds(const NurbsAxis& axis) {
  std::vector<double> ends;
  for (double knot : axis.knots) {
    if (knot < axis.start() || knot > axis.end()) continue;
    if (ends.empty() || knot > ends.back()) ends.push_back(knot);
  }
  return ends;
}

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

// Whether the ends of the net in each direction are single points, and whether
// it is closed.
struct Topology {
  bool closed_u;
  bool closed_v;
  bool pole[4];  // first and last row, first and last column
};

Topology TopologyOf(const NurbsSurface& surface) {
  double size = 0;
  for (const Vector3d& point : surface.points) {
    size = std::max(size, (point - surface.points[0]).norm());
  }
  const int rows = surface.u.count();
  const int columns = surface.v.count();
  const auto is_point = [&](int first, int step, int count) {
    for (int k = 1; k < count; ++k) {
      if ((surface.points[first + k * step] - surface.points[first]).norm() >
          kPole * size) {
        return false;
      }
    }
    return true;
  };
  return {IsClosedInU(surface),
          IsClosedInV(surface),
          {is_point(0, 1, columns),
           is_point(surface.index(rows - 1, 0), 1, columns),
           is_point(0, columns, rows),
           is_point(surface.index(0, columns - 1), columns, rows)}};
}

// A grid of parameters whose doubles at seams and poles are one vertex.
struct WeldedGrid {
  int rows;
  int columns;
  std::vector<int> vertex;                 // of each row and column
  std::vector<std::pair<int, int>> first;  // row and column of each vertex

  WeldedGrid(int row_count, int column_count, const Topology& topology)
      : rows(row_count),
        columns(column_count),
        vertex(static_cast<size_t>(row_count) * column_count, -1) {
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < columns; ++j) {
        const int r = topology.closed_u && i == rows - 1 ? 0 : i;
        const int c = topology.closed_v && j == columns - 1 ? 0 : j;
        int to_row = r, to_column = c;
        if ((topology.pole[0] && r == 0) ||
            (topology.pole[1] && r == rows - 1)) {
          to_column = 0;
        }
        if ((topology.pole[2] && c == 0) ||
            (topology.pole[3] && c == columns - 1)) {
          to_row = 0;
        }
        int& own = vertex[i * columns + j];
        if (to_row != i || to_column != j) {
          own = vertex[to_row * columns + to_column];
        } else {
          own = static_cast<int>(first.size());
          first.emplace_back(i, j);
        }
      }
    }
  }

  std::vector<Triangle> Triangles() const {
    std::vector<Triangle> triangles;
    const auto add = [&](int a, int b, int c) {
      if (a != b && b != c && c != a) triangles.push_back({a, b, c});
    };
    for (int i = 0; i + 1 < rows; ++i) {
      for (int j = 0; j + 1 < columns; ++j) {
        const int* at = &vertex[i * columns + j];
        add(at[0], at[columns], at[columns + 1]);
        add(at[0], at[columns + 1], at[1]);
      }
    }
    return triangles;
  }
};

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

kernel::TessellateFunction TessellateFor(
    [[maybe_unused]] InstructionSet level) {
#ifdef GELENK_X86_LEVELS
  if (level == InstructionSet::kAvx2) return kernel::avx2::Tessellate;
  if (level == InstructionSet::kAvx512) return kernel::avx512::Tessellate;
#endif
  return kernel::baseline::Tessellate;
}

}  // namespace

// Finds the net that is fine enough, and the triangles.
class NurbsFitting {
 public:
  NurbsFitting(const VolumeRig& rig, const NurbsSkinOptions& options)
      : rig_(rig), options_(options), poses_(ProbePoses(rig)) {}

  absl::StatusOr<std::shared_ptr<const NurbsSkin>> Run(
      const NurbsSurface& surface) {
    topology_ = TopologyOf(surface);
    absl::StatusOr<Fit> fit = FitOf(surface);
    if (!fit.ok()) return fit.status();
    for (int round = 0;
         round < kMaxRefinements && fit->error_m > options_.tolerance_m;
         ++round) {
      // Finer along u or along v, whichever helps more.
      std::vector<Fit> finer;
      for (bool along_u : {true, false}) {
        NurbsSurface refined = fit->surface;
        if (along_u) {
          RefineU(fit->bad_u, refined);
        } else {
          RefineV(fit->bad_v, refined);
        }
        if (static_cast<int>(refined.points.size()) > options_.max_points ||
            std::max(refined.u.count(), refined.v.count()) > kMaxNurbsCount) {
          continue;
        }
        absl::StatusOr<Fit> candidate = FitOf(refined);
        if (candidate.ok()) finer.push_back(*std::move(candidate));
      }
      const auto best = std::min_element(
          finer.begin(), finer.end(),
          [](const Fit& a, const Fit& b) { return a.error_m < b.error_m; });
      if (best == finer.end()) break;
      *fit = std::move(*best);
    }
    NurbsSkin::Tessellation tessellation;
    if (absl::Status status = Tessellate(*fit, tessellation); !status.ok()) {
      return status;
    }
    return std::shared_ptr<const NurbsSkin>(new NurbsSkin(
        rig_, std::move(fit->surface), std::move(fit->greville),
        std::move(fit->vertices), std::move(fit->u_inverse),
        std::move(fit->v_inverse), fit->error_m, std::move(tessellation)));
  }

 private:
  struct Fit {
    NurbsSurface surface;
    std::shared_ptr<const LayeredSkin> greville;
    std::vector<int> vertices;  // of each point of the net
    MatrixXd u_inverse, v_inverse;
    std::vector<NurbsSurface> deformed;  // at the probe poses
    double error_m = 0;
    std::vector<double> bad_u, bad_v;  // middles of spans
  };

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

  absl::StatusOr<Fit> FitOf(const NurbsSurface& surface) const {
    Fit fit;
    fit.surface = surface;
    const std::vector<double> us = GrevilleAbscissae(surface.u);
    const std::vector<double> vs = GrevilleAbscissae(surface.v);
    const Eigen::PartialPivLU<MatrixXd> by_u(Collocation(surface.u, us));
    const Eigen::PartialPivLU<MatrixXd> by_v(Collocation(surface.v, vs));
    for (const auto& [lu, field] :
         {std::pair(&by_u, "u.knots"), std::pair(&by_v, "v.knots")}) {
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
  absl::Status Compare(Fit& fit) const {
    const std::vector<double> us = CheckParameters(fit.surface.u);
    const std::vector<double> vs = CheckParameters(fit.surface.v);
    const WeldedGrid grid(static_cast<int>(us.size()),
                          static_cast<int>(vs.size()), Topology{});
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

  NurbsSurface Deformed(const Fit& fit, const VolumeFrame& frame) const {
    std::vector<Vector3d> greville;
    fit.greville->DeformExactly(frame, greville, nullptr);
    NurbsSurface surface = fit.surface;
    const int rows = surface.u.count(), columns = surface.v.count();
    const std::vector<double> us = GrevilleAbscissae(surface.u);
    const std::vector<double> vs = GrevilleAbscissae(surface.v);
    const Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>
        weights(surface.weights.data(), rows, columns);
    const MatrixXd greville_weights = Collocation(surface.u, us) * weights *
                                      Collocation(surface.v, vs).transpose();
    for (int c = 0; c < 3; ++c) {
      MatrixXd values(rows, columns);
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
          values(i, j) = greville_weights(i, j) *
                         greville[fit.vertices[surface.index(i, j)]][c];
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
      if (error > options_.tolerance_m) {
        middles.push_back(0.5 * (ends[i] + ends[i + 1]));
      }
    }
    return middles;
  }

  // Parameters so close that chords are within the tolerance.
  std::vector<double> ChordParameters(const Fit& fit, bool along_u) const {
    const NurbsAxis& axis = along_u ? fit.surface.u : fit.surface.v;
    const NurbsAxis& other = along_u ? fit.surface.v : fit.surface.u;
    std::vector<NurbsSurface> surfaces = fit.deformed;
    surfaces.push_back(fit.surface);
    const std::vector<double> ends = SpanEnds(axis);
    const std::vector<double> across = GrevilleAbscissae(other);
    std::vector<double> parameters = {ends[0]};
    for (size_t i = 0; i + 1 < ends.size(); ++i) {
      double sagitta = 0;
      for (const NurbsSurface& surface : surfaces) {
        for (double w : across) {
          const auto at = [&](double x) {
            return along_u ? EvaluateNurbs(surface, x, w).position
                           : EvaluateNurbs(surface, w, x).position;
          };
          const Vector3d chord = 0.5 * (at(ends[i]) + at(ends[i + 1]));
          sagitta = std::max(
              sagitta, (at(0.5 * (ends[i] + ends[i + 1])) - chord).norm());
        }
      }
      // It falls with the square of the number of chords.
      const int segments =
          std::clamp(static_cast<int>(
                         std::ceil(std::sqrt(sagitta / options_.tolerance_m))),
                     1, kMaxSegmentsPerSpan);
      for (int k = 1; k <= segments; ++k) {
        parameters.push_back(
            k == segments ? ends[i + 1]
                          : ends[i] + k * (ends[i + 1] - ends[i]) / segments);
      }
    }
    return parameters;
  }

  absl::Status Tessellate(const Fit& fit,
                          NurbsSkin::Tessellation& tessellation) const {
    tessellation.u.parameters = ChordParameters(fit, true);
    tessellation.v.parameters = ChordParameters(fit, false);
    const int rows = static_cast<int>(tessellation.u.parameters.size());
    const int columns = static_cast<int>(tessellation.v.parameters.size());
    if (static_cast<int64_t>(rows) * columns > options_.max_vertices) {
      return absl::InvalidArgumentError(absl::StrCat(
          "tolerance: ", options_.tolerance_m, " m makes ", rows, " x ",
          columns, " vertices, want at most ", options_.max_vertices));
    }
    tessellation.column_count = columns;
    const int padded = BlocksFor(columns) * kVerticesPerBlock;
    const WeldedGrid grid(rows, columns, topology_);
    for (const auto& [i, j] : grid.first) {
      const Vector2d at(tessellation.u.parameters[i],
                        tessellation.v.parameters[j]);
      tessellation.grid.slots.push_back(padded * i + j);
      tessellation.grid.parameters.push_back(at);
      tessellation.grid.positions.push_back(
          EvaluateNurbs(fit.surface, at[0], at[1]).position);
    }
    tessellation.grid.triangles = grid.Triangles();
    tessellation.v.parameters.resize(padded, tessellation.v.parameters.back());
    FillTable(fit.surface.u, false, tessellation.u);
    FillTable(fit.surface.v, true, tessellation.v);
    return absl::OkStatus();
  }

  // By parameter, or, transposed, by function.
  static void FillTable(const NurbsAxis& axis, bool transposed,
                        NurbsSkin::AxisTable& table) {
    const size_t count = table.parameters.size();
    const size_t functions = axis.degree + 1;
    table.values.resize(count * functions);
    table.slopes.resize(count * functions);
    for (size_t i = 0; i < count; ++i) {
      const NurbsBasis basis = BasisAt(axis, table.parameters[i]);
      table.first.push_back(basis.first);
      for (size_t k = 0; k < functions; ++k) {
        const size_t at = transposed ? k * count + i : i * functions + k;
        table.values[at] = static_cast<float>(basis.values[k]);
        table.slopes[at] = static_cast<float>(basis.slopes[k]);
      }
    }
  }

  const VolumeRig& rig_;
  const NurbsSkinOptions& options_;
  std::vector<Eigen::VectorXd> poses_;
  Topology topology_ = {};
};

absl::StatusOr<std::shared_ptr<const NurbsSkin>> NurbsSkin::Create(
    const VolumeRig& rig, const NurbsSurface& surface,
    const NurbsSkinOptions& options) {
  if (absl::Status status = CheckNurbs(surface); !status.ok()) return status;
  if (!(options.tolerance_m > 0)) {
    Violations violations;
    violations.Add("tolerance",
                   absl::StrCat("want > 0 m, got ", options.tolerance_m));
    return violations.ToStatus();
  }
  return NurbsFitting(rig, options).Run(surface);
}

NurbsSkin::NurbsSkin(const VolumeRig& rig, NurbsSurface surface,
                     std::shared_ptr<const LayeredSkin> greville,
                     std::vector<int> greville_vertices, MatrixXd u_inverse,
                     MatrixXd v_inverse, double error_m,
                     Tessellation tessellation)
    : Skin(rig.shared_skeleton(), tessellation.grid.slots,
           static_cast<int>(tessellation.u.parameters.size() *
                            tessellation.v.parameters.size()) /
               kVerticesPerBlock,
           tessellation.grid.triangles, tessellation.grid.positions,
           rig.rest_positions()),
      surface_(std::move(surface)),
      greville_(std::move(greville)),
      greville_vertices_(std::move(greville_vertices)),
      u_inverse_(std::move(u_inverse)),
      v_inverse_(std::move(v_inverse)),
      estimated_error_m_(error_m),
      tessellation_(std::move(tessellation)),
      tessellate_(TessellateFor(BestInstructionSet())) {
  const Topology topology = TopologyOf(surface_);
  closed_u_ = topology.closed_u;
  closed_v_ = topology.closed_v;
  std::copy(std::begin(topology.pole), std::end(topology.pole), pole_);
  const int rows = surface_.u.count(), columns = surface_.v.count();
  const MatrixXd by_u = Collocation(surface_.u, GrevilleAbscissae(surface_.u));
  const MatrixXd by_v = Collocation(surface_.v, GrevilleAbscissae(surface_.v));
  greville_weights_.resize(surface_.points.size());
  Eigen::Map<Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(
      greville_weights_.data(), rows, columns) =
      by_u *
      Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(
          surface_.weights.data(), rows, columns) *
      by_v.transpose();
}

Eigen::Vector2d NurbsSkin::parameters(int vertex) const {
  return tessellation_.grid.parameters[vertex];
}

void NurbsSkin::FitNet(const VolumeFrame& frame,
                       SkinWorkspace& workspace) const {
  const int rows = surface_.u.count(), columns = surface_.v.count();
  greville_->DeformExactly(frame, workspace.vertices, nullptr);
  workspace.points.resize(rows, 3 * columns);
  workspace.fitted.resize(rows, 3 * columns);
  workspace.net.resize(rows, 3 * columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int at = surface_.index(i, j);
      for (int c = 0; c < 3; ++c) {
        workspace.points(i, c * columns + j) =
            greville_weights_[at] *
            workspace.vertices[greville_vertices_[at]][c];
      }
    }
  }
  // Coefficient by coefficient: products in blocks take memory.
  workspace.fitted = u_inverse_.lazyProduct(workspace.points);
  for (int c = 0; c < 3; ++c) {
    workspace.net.middleCols(c * columns, columns) =
        workspace.fitted.middleCols(c * columns, columns)
            .lazyProduct(v_inverse_.transpose());
  }
}

void NurbsSkin::Deform(const ConstVectorView& positions,
                       const RigidTransform& world_from_skeleton,
                       SkinWorkspace& workspace, VertexBlocks& blocks) const {
  greville_->rig().Evaluate(positions, world_from_skeleton, workspace.frame);
  FitNet(workspace.frame, workspace);
  const int rows = surface_.u.count(), columns = surface_.v.count();
  workspace.rows.resize(4 * surface_.points.size());
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int at = surface_.index(i, j);
      for (int c = 0; c < 3; ++c) {
        workspace.rows[4 * at + c] =
            static_cast<float>(workspace.net(i, c * columns + j));
      }
      workspace.rows[4 * at + 3] = static_cast<float>(surface_.weights[at]);
    }
  }
  const kernel::TessellateLayout layout = {
      rows,
      columns,
      surface_.u.degree,
      surface_.v.degree,
      static_cast<int>(tessellation_.u.parameters.size()),
      static_cast<int>(tessellation_.v.parameters.size()),
      tessellation_.u.first.data(),
      tessellation_.v.first.data(),
      tessellation_.u.values.data(),
      tessellation_.u.slopes.data(),
      tessellation_.v.values.data(),
      tessellation_.v.slopes.data()};
  workspace.sums.resize(static_cast<size_t>(kernel::kSumsPerColumn) * rows *
                        layout.columns);
  blocks.Resize(block_count());
  tessellate_(layout, workspace.rows.data(), workspace.sums.data(),
              blocks.data());
  MendNormals(blocks);
}

// At a pole the surface has no two directions, at a seam it is there twice: the
// mean of what is around.
void NurbsSkin::MendNormals(VertexBlocks& blocks) const {
  const int rows = static_cast<int>(tessellation_.u.parameters.size());
  const int columns = tessellation_.column_count;
  const int padded = static_cast<int>(tessellation_.v.parameters.size());
  const auto slot = [&](int i, int j) { return padded * i + j; };
  const auto set = [&](int at, const Eigen::Vector3f& normal) {
    blocks.Set(at, blocks.position(at), normal.stableNormalized());
  };
  if (closed_u_) {
    for (int j = 0; j < columns; ++j) {
      set(slot(0, j),
          blocks.normal(slot(0, j)) + blocks.normal(slot(rows - 1, j)));
    }
  }
  if (closed_v_) {
    for (int i = 0; i < rows; ++i) {
      set(slot(i, 0),
          blocks.normal(slot(i, 0)) + blocks.normal(slot(i, columns - 1)));
    }
  }
  for (int end = 0; end < 2; ++end) {
    if (pole_[end]) {
      const int beside = end == 0 ? 1 : rows - 2;
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (int j = 0; j < columns - (closed_v_ ? 1 : 0); ++j) {
        sum += blocks.normal(slot(beside, j));
      }
      set(slot(end == 0 ? 0 : rows - 1, 0), sum);
    }
    if (pole_[2 + end]) {
      const int beside = end == 0 ? 1 : columns - 2;
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (int i = 0; i < rows - (closed_u_ ? 1 : 0); ++i) {
        sum += blocks.normal(slot(i, beside));
      }
      set(slot(0, end == 0 ? 0 : columns - 1), sum);
    }
  }
}

NurbsSurface NurbsSkin::DeformedSurface(
    const ConstVectorView& positions,
    const RigidTransform& world_from_skeleton) const {
  SkinWorkspace workspace;
  greville_->rig().Evaluate(positions, world_from_skeleton, workspace.frame);
  FitNet(workspace.frame, workspace);
  NurbsSurface deformed = surface_;
  const int columns = surface_.v.count();
  for (int i = 0; i < surface_.u.count(); ++i) {
    for (int j = 0; j < columns; ++j) {
      const int at = surface_.index(i, j);
      for (int c = 0; c < 3; ++c) {
        deformed.points[at][c] =
            workspace.net(i, c * columns + j) / surface_.weights[at];
      }
    }
  }
  return deformed;
}

size_t NurbsSkin::ByteSize() const {
  const auto table = [](const AxisTable& t) {
    return t.parameters.size() * sizeof(double) + t.first.size() * sizeof(int) +
           (t.values.size() + t.slopes.size()) * sizeof(float);
  };
  return Skin::ByteSize() + sizeof(*this) + greville_->ByteSize() +
         surface_.points.size() * (sizeof(Vector3d) + 2 * sizeof(double)) +
         (u_inverse_.size() + v_inverse_.size()) * sizeof(double) +
         table(tessellation_.u) + table(tessellation_.v) +
         tessellation_.grid.positions.size() *
             (sizeof(Vector3d) + sizeof(Vector2d) + sizeof(int));
}

}  // namespace gelenk
