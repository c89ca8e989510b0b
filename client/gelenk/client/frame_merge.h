// Two waiting frames become one.
#ifndef GELENK_CLIENT_FRAME_MERGE_H_
#define GELENK_CLIENT_FRAME_MERGE_H_

#include "gelenk/v1/session_service.pb.h"

namespace gelenk::client {

// Makes `older` mean what `older` and then `newer` mean, with the number and
// time of `newer`. False, and nothing changed, when `newer` patches goals: the
// indices in `older` belong to the goals before that.
bool Merge(const v1::TargetFrame& newer, v1::TargetFrame* older);

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_FRAME_MERGE_H_
