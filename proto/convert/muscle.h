// Muscles between the contract and the core.
#ifndef GELENK_CONVERT_MUSCLE_H_
#define GELENK_CONVERT_MUSCLE_H_

#include <google/protobuf/repeated_ptr_field.h>

#include "absl/status/statusor.h"
#include "gelenk/skin/muscle.h"
#include "gelenk/v1/skin.pb.h"

namespace gelenk::convert {

using MuscleList = google::protobuf::RepeatedPtrField<v1::Muscle>;
using FullnessList = google::protobuf::RepeatedPtrField<v1::JointFullness>;

// INVALID_ARGUMENT for a muscle without a mode; else unchecked: VolumeRig does.
absl::StatusOr<SkinMuscles> FromProto(const MuscleList& muscles,
                                      const FullnessList& fullness);

void ToProto(const SkinMuscles& muscles, MuscleList* muscles_proto,
             FullnessList* fullness_proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_MUSCLE_H_
