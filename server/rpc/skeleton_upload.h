// KinematicsService.ImportSkeleton: a file comes in pieces, a skeleton is
// stored.
#ifndef GELENK_SERVER_RPC_SKELETON_UPLOAD_H_
#define GELENK_SERVER_RPC_SKELETON_UPLOAD_H_

#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

void ServeSkeletonUploads(v1::KinematicsService::AsyncService* service,
                          ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKELETON_UPLOAD_H_
