// What was measured of a motion, for the contract.
#ifndef GELENK_CONVERT_MOTION_QUALITY_H_
#define GELENK_CONVERT_MOTION_QUALITY_H_

#include "gelenk/retarget/motion_quality.h"
#include "gelenk/v1/motion_quality.pb.h"

namespace gelenk::convert {

void ToProto(const MotionQuality& quality, v1::MotionQuality* proto);
void ToProto(const MotionComparison& comparison, v1::MotionComparison* proto);

// The same back.
MotionQuality FromProto(const v1::MotionQuality& proto);
MotionComparison FromProto(const v1::MotionComparison& proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_MOTION_QUALITY_H_
