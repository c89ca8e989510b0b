// Writes BVH text that reads back as the same document, number for number.
#ifndef GELENK_FORMATS_BVH_WRITER_H_
#define GELENK_FORMATS_BVH_WRITER_H_

#include <string>

#include "gelenk/formats/bvh_document.h"

namespace gelenk {

// `document` is well formed: joints depth first, as ReadBvh gives them, names
// without line breaks and braces, channel_count rows of motion. Each number is
// the shortest decimal that reads back exactly. Cost: linear.
std::string WriteBvh(const BvhDocument& document);

}  // namespace gelenk

#endif  // GELENK_FORMATS_BVH_WRITER_H_
