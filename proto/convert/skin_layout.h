// What a client needs once to make vertices of a skin's frames.
#ifndef GELENK_CONVERT_SKIN_LAYOUT_H_
#define GELENK_CONVERT_SKIN_LAYOUT_H_

#include "gelenk/skin/control_plane_mesh.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/skin.h"
#include "gelenk/v1/skin_service.pb.h"

namespace gelenk::convert {

// All but name and volumes.
void ToProto(const Skin& skin, v1::SkinLayout* proto);

// For clients that deform the mesh themselves.
void ToProto(const LayeredSkin& skin, v1::VolumeLayout* proto);
// For ControlPlaneMesh, which checks it.
ControlPlaneLayout FromProto(const v1::VolumeLayout& proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_SKIN_LAYOUT_H_
