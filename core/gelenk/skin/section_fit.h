// How thick the limbs of a mesh are: sections for the links of a rig.
#ifndef GELENK_SKIN_SECTION_FIT_H_
#define GELENK_SKIN_SECTION_FIT_H_

#include <memory>

#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

// The same rig with sections that fit the mesh: a little more than the limbs
// are thick (tight ones leave fewer vertices ambiguous), and caps that reach as
// far as the surface goes on beyond the ends of chains.
//
// Looks from each bone outwards, in every direction: what comes first is the
// limb's own surface, whatever lies beyond. What is nearer to the bone of
// another chain does not count. A link whose bone lies outside the surface (a
// root on the ground, below the body) carries nothing and gets a section next
// to nothing; one that has too little around it to see keeps what it has.
// Cost: linear in links times vertices, some 20 ns each.
std::shared_ptr<const VolumeRig> FitSections(const VolumeRig& rig,
                                             const TriangleMesh& mesh);

}  // namespace gelenk

#endif  // GELENK_SKIN_SECTION_FIT_H_
