// Durations between the contract and Abseil.
#ifndef GELENK_CONVERT_DURATION_H_
#define GELENK_CONVERT_DURATION_H_

#include <google/protobuf/duration.pb.h>

#include "absl/time/time.h"

namespace gelenk::convert {

// Whatever stands in the message: out of range saturates.
absl::Duration FromProto(const google::protobuf::Duration& proto);

void ToProto(absl::Duration duration, google::protobuf::Duration* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_DURATION_H_
