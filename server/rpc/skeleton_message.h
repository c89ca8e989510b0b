// Stored skeletons as gelenk.v1.Skeleton.
#ifndef GELENK_SERVER_RPC_SKELETON_MESSAGE_H_
#define GELENK_SERVER_RPC_SKELETON_MESSAGE_H_

#include "gelenk/v1/skeleton.pb.h"
#include "server/store/skeleton_store.h"

namespace gelenk::server {

// Everything but the joints, as lists show it.
void ToListedProto(const StoredSkeleton& stored, v1::Skeleton* proto);
void ToProto(const StoredSkeleton& stored, v1::Skeleton* proto);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKELETON_MESSAGE_H_
