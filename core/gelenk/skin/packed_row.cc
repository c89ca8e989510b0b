#include "gelenk/skin/packed_row.h"

#include <algorithm>
#include <bit>

namespace gelenk {
namespace {

constexpr int kLanes = kPackedLanes;
constexpr int kWidthMask = 0x1F;
constexpr int kLateral = 0x20;
constexpr int kExceptionShift = 6;
constexpr int kMaxExceptions = 3;
constexpr int kLaneBits = 4;
// What an exception has room for above the width of its row.
constexpr int kHighBits = 16 - kLaneBits;

// Small numbers of either sign as small numbers.
uint16_t Fold(uint16_t number, int number_bits) {
  const int32_t wide = number_bits == 8 ? static_cast<int8_t>(number)
                                        : static_cast<int16_t>(number);
  return static_cast<uint16_t>((wide << 1) ^ (wide >> 31));
}

uint16_t Unfold(uint16_t folded) {
  return static_cast<uint16_t>((folded >> 1) ^ -(folded & 1));
}

// The width of a row, and how many of its numbers are wider.
struct RowForm {
  int width = 0;
  int exceptions = 0;

  int bytes() const { return 2 * (width + exceptions); }
};

RowForm ShortestForm(const uint16_t* folded) {
  unsigned any = 0;
  for (int i = 0; i < kLanes; ++i) any |= folded[i];
  RowForm best{static_cast<int>(std::bit_width(any)), 0};
  const int least = std::max(0, best.width - kHighBits);
  for (int width = best.width - 1; width >= least; --width) {
    int wider = 0;
    for (int i = 0; i < kLanes; ++i) wider += (folded[i] >> width) != 0;
    if (wider > kMaxExceptions) break;
    const RowForm form{width, wider};
    if (form.bytes() < best.bytes()) best = form;
  }
  return best;
}

void AppendRow(const uint16_t* folded, const RowForm& form, int flags,
               std::string& bytes) {
  char row[1 + 2 * 16 + 2 * kMaxExceptions];
  int size = 0;
  row[size++] = static_cast<char>(form.width | flags |
                                  form.exceptions << kExceptionShift);
  const unsigned mask = (1u << form.width) - 1;
  uint64_t pending = 0;
  int pending_bits = 0;
  for (int i = 0; i < kLanes; ++i) {
    pending |= uint64_t{folded[i] & mask} << pending_bits;
    pending_bits += form.width;
    for (; pending_bits >= 8; pending_bits -= 8) {
      row[size++] = static_cast<char>(pending);
      pending >>= 8;
    }
  }
  for (int i = 0; i < kLanes && form.exceptions > 0; ++i) {
    const int high = folded[i] >> form.width;
    if (high == 0) continue;
    const int exception = i | high << kLaneBits;
    row[size++] = static_cast<char>(exception);
    row[size++] = static_cast<char>(exception >> 8);
  }
  bytes.append(row, size);
}

uint16_t ByteAt(absl::string_view bytes, size_t at) {
  return static_cast<uint8_t>(bytes[at]);
}

}  // namespace

void PackRow(const uint16_t* numbers, int number_bits, std::string& bytes) {
  uint16_t plain[kLanes], lateral[kLanes];
  for (int i = 0; i < kLanes; ++i) plain[i] = Fold(numbers[i], number_bits);
  lateral[0] = plain[0];
  for (int i = 1; i < kLanes; ++i) {
    lateral[i] =
        Fold(static_cast<uint16_t>(numbers[i] - numbers[i - 1]), number_bits);
  }
  const RowForm plain_form = ShortestForm(plain);
  const RowForm lateral_form = ShortestForm(lateral);
  if (plain_form.bytes() <= lateral_form.bytes()) {
    AppendRow(plain, plain_form, 0, bytes);
  } else {
    AppendRow(lateral, lateral_form, kLateral, bytes);
  }
}

bool UnpackRow(absl::string_view& bytes, int number_bits, uint16_t* numbers) {
  if (bytes.empty()) return false;
  const int head = ByteAt(bytes, 0);
  const int width = head & kWidthMask;
  const int exceptions = head >> kExceptionShift;
  const size_t size = 1 + 2 * static_cast<size_t>(width + exceptions);
  if (width > number_bits || bytes.size() < size) return false;
  uint64_t pending = 0;
  int pending_bits = 0;
  size_t next = 1;
  for (int i = 0; i < kLanes; ++i) {
    for (; pending_bits < width; pending_bits += 8) {
      pending |= uint64_t{ByteAt(bytes, next++)} << pending_bits;
    }
    numbers[i] = static_cast<uint16_t>(pending & ((1u << width) - 1));
    pending >>= width;
    pending_bits -= width;
  }
  int last_lane = -1;
  for (int k = 0; k < exceptions; ++k, next += 2) {
    const int exception = ByteAt(bytes, next) | ByteAt(bytes, next + 1) << 8;
    const int lane = exception & (kLanes - 1);
    const int number = exception >> kLaneBits << width | numbers[lane];
    if (lane <= last_lane || number >> number_bits != 0) return false;
    last_lane = lane;
    numbers[lane] = static_cast<uint16_t>(number);
  }
  for (int i = 0; i < kLanes; ++i) numbers[i] = Unfold(numbers[i]);
  if ((head & kLateral) != 0) {
    for (int i = 1; i < kLanes; ++i) {
      numbers[i] = static_cast<uint16_t>(numbers[i] + numbers[i - 1]);
    }
  }
  bytes.remove_prefix(size);
  return true;
}

}  // namespace gelenk
