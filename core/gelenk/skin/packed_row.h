// Sixteen small differences in few bytes: a row of a block of DELTA frames.
//
// The numbers are taken modulo 2^number_bits, which is 8 or 16. They are folded
// (0, -1, 1, -2 ... become 0, 1, 2, 3 ...), as they are or, "lateral", as the
// differences from the lane before, whichever is shorter. Bytes, little-endian:
//
//   1       bits 0-4: the width b, 0 to number_bits; bit 5: lateral; bits 6-7:
//           how many exceptions there are
//   2 b     the lowest b bits of sixteen folded numbers, from the lowest bit on
//   2 each  exceptions, by rising lanes: bits 0-3 the lane, bits 4-15 what its
//           folded number has above its lowest b bits
//
// Neighbours on a skin move alike, which is what lateral rows are for; an
// exception spares fifteen lanes the width of one.
#ifndef GELENK_SKIN_PACKED_ROW_H_
#define GELENK_SKIN_PACKED_ROW_H_

#include <cstdint>
#include <string>

#include "absl/strings/string_view.h"

namespace gelenk {

inline constexpr int kPackedLanes = 16;

// Appends to `bytes`. About 100 ns.
void PackRow(const uint16_t* numbers, int number_bits, std::string& bytes);

// Takes a row from the front of `bytes`; false when it is malformed or cut off,
// `numbers` may then have been changed.
bool UnpackRow(absl::string_view& bytes, int number_bits, uint16_t* numbers);

}  // namespace gelenk

#endif  // GELENK_SKIN_PACKED_ROW_H_
