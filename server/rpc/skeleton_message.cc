#include "server/rpc/skeleton_message.h"

#include <string>

#include "convert/skeleton.h"
#include "server/rpc/session_message.h"

namespace gelenk::server {

void ToListedProto(const StoredSkeleton& stored, v1::Skeleton* proto) {
  proto->set_name(stored.name);
  proto->set_display_name(stored.display_name);
  proto->set_dimension(stored.planar ? v1::DIMENSION_PLANAR
                                     : v1::DIMENSION_SPATIAL);
  for (const std::string& warning : stored.warnings) {
    proto->add_warnings(warning);
  }
  proto->set_position_count(stored.skeleton->position_count());
  proto->set_velocity_count(stored.skeleton->velocity_count());
  ToProto(stored.create_time, proto->mutable_create_time());
}

void ToProto(const StoredSkeleton& stored, v1::Skeleton* proto) {
  convert::ToProto(*stored.skeleton, proto);
  ToListedProto(stored, proto);
}

}  // namespace gelenk::server
