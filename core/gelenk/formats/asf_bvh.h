// An ASF skeleton and its motion as a BVH document, from where all that BVH has
// goes on: the import as a skeleton, poses, clips, files.
//
// A bone becomes a joint where the bone starts; it turns about axes that are
// those of the world at rest, as joints of BVH do. Bones that move get three
// angles, Z X Y: those that had fewer are free to turn all ways afterwards, and
// a warning says so.
#ifndef GELENK_FORMATS_ASF_BVH_H_
#define GELENK_FORMATS_ASF_BVH_H_

#include "gelenk/formats/asf_document.h"
#include "gelenk/formats/bvh_document.h"

namespace gelenk {

// AMC files do not tell their rate; this is that of the largest collection.
inline constexpr double kAmcFrameTime_s = 1.0 / 120;

// `motion` is of `skeleton`, and may have no frame. Cost: linear.
BvhDocument BvhFromAsf(const AsfDocument& skeleton, const AmcMotion& motion,
                       double frame_time_s = kAmcFrameTime_s);

}  // namespace gelenk

#endif  // GELENK_FORMATS_ASF_BVH_H_
