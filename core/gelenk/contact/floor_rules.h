// What both detectors of contacts take a floor for. For a leg of
// kReferenceLegM; m and m/s.
#ifndef GELENK_CONTACT_FLOOR_RULES_H_
#define GELENK_CONTACT_FLOOR_RULES_H_

namespace gelenk {

// Points that are slower than this may stand on it, ...
inline constexpr double kFloorMaxSpeed = 0.2;
// ... when they are within this of the lowest, or of it.
inline constexpr double kFloorBand = 0.06;
// One point's soles are off by this at most.
inline constexpr double kMaxFloorBias = 0.04;

}  // namespace gelenk

#endif  // GELENK_CONTACT_FLOOR_RULES_H_
