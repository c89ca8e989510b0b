#include "client/cli/workspace/reach.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "convert/geometry.h"

namespace gelenk::cli {
namespace {

// Ten million samples take some 20 s of one core.
constexpr absl::Duration kPatience = absl::Minutes(5);

void Append(const v1::Voxels& voxels, WorkspaceMap& map) {
  const int count = std::min({voxels.indices_size(), voxels.reach_counts_size(),
                              voxels.mean_manipulabilities_size()});
  for (int i = 0; i < count; ++i) {
    map.voxels.push_back({voxels.indices(i), voxels.reach_counts(i),
                          voxels.mean_manipulabilities(i)});
  }
}

}  // namespace

absl::StatusOr<Reach> AskForReach(client::Connection& connection,
                                  const v1::ComputeWorkspaceRequest& request) {
  grpc::ClientContext context;
  client::CallOptions options;
  options.timeout = kPatience;
  connection.Prepare(options, context);
  const auto reader =
      connection.kinematics().ComputeWorkspace(&context, request);
  absl::StatusOr<Reach> reach = Reach();
  v1::ComputeWorkspaceResponse part;
  while (reader->Read(&part)) {
    if (part.has_annulus()) {
      reach->annulus = PlanarAnnulus{
          convert::FromProto(part.annulus().world_center()),
          convert::FromProto(part.annulus().world_normal()),
          part.annulus().inner_radius_m(), part.annulus().outer_radius_m()};
    } else if (part.has_grid()) {
      const v1::VoxelGrid& grid = part.grid();
      reach->map.world_min = convert::FromProto(grid.world_min());
      reach->map.voxel_size_m = grid.voxel_size_m();
      reach->map.size = {grid.size_x(), grid.size_y(), grid.size_z()};
      reach->map.sample_count = grid.sample_count();
    } else {
      Append(part.voxels(), reach->map);
    }
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return client::FromGrpc(status);
  return reach;
}

std::string PointCloudCsv(const WorkspaceMap& map) {
  std::string csv = "x_m,y_m,z_m,reach_count,mean_manipulability\n";
  for (const ReachedVoxel& voxel : map.voxels) {
    const Eigen::Vector3d center = map.CenterOf(voxel);
    absl::StrAppendFormat(&csv, "%.9g,%.9g,%.9g,%d,%.6g\n", center.x(),
                          center.y(), center.z(), voxel.reach_count,
                          voxel.mean_manipulability);
  }
  return csv;
}

}  // namespace gelenk::cli
