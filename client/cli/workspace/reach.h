// What the service says an end effector can reach, as one value.
#ifndef CLIENT_CLI_WORKSPACE_REACH_H_
#define CLIENT_CLI_WORKSPACE_REACH_H_

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "gelenk/client/connection.h"
#include "gelenk/v1/workspace.pb.h"
#include "gelenk/workspace/planar_annulus.h"
#include "gelenk/workspace/workspace_map.h"

namespace gelenk::cli {

// An exact annulus, or a sampled map.
struct Reach {
  std::optional<PlanarAnnulus> annulus;
  WorkspaceMap map;
};

// Calls ComputeWorkspace and reads its stream to the end. Errors are those of
// the call.
absl::StatusOr<Reach> AskForReach(client::Connection& connection,
                                  const v1::ComputeWorkspaceRequest& request);

// The reached voxels, a row each: x_m,y_m,z_m,reach_count,mean_manipulability.
std::string PointCloudCsv(const WorkspaceMap& map);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_WORKSPACE_REACH_H_
