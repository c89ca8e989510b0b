#include "gelenk/skin/packed_row.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "tests/testing/random.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::UniformIndex;

using Row = std::array<uint16_t, kPackedLanes>;

std::string Packed(const Row& row, int bits) {
  std::string bytes;
  PackRow(row.data(), bits, bytes);
  return bytes;
}

// Modulo 2^bits.
Row Masked(Row row, int bits) {
  for (uint16_t& number : row) number &= (1u << bits) - 1;
  return row;
}

void ExpectComesBack(const Row& row, int bits) {
  const std::string bytes = Packed(row, bits);
  absl::string_view left = bytes;
  Row back;
  ASSERT_TRUE(UnpackRow(left, bits, back.data()));
  EXPECT_TRUE(left.empty());
  EXPECT_EQ(Masked(back, bits), Masked(row, bits));
}

TEST(PackedRowTest, EveryWidthComesBack) {
  Random random(1);
  for (int bits : {8, 16}) {
    for (int width = 0; width <= bits; ++width) {
      for (int repeat = 0; repeat < 50; ++repeat) {
        Row row;
        for (uint16_t& number : row) {
          number = static_cast<uint16_t>(UniformIndex(random, 1 << width) -
                                         (1 << width) / 2);
        }
        // Now and then lanes that stand out.
        for (int k = repeat % 5; k > 0; --k) {
          row[UniformIndex(random, kPackedLanes)] =
              static_cast<uint16_t>(UniformIndex(random, 1 << bits));
        }
        ExpectComesBack(row, bits);
      }
    }
  }
}

TEST(PackedRowTest, TakesTheShortestForm) {
  const Row zeros = {};
  EXPECT_EQ(Packed(zeros, 16).size(), 1u);
  // -1 .. 1 take two bits.
  Row small = {};
  small[3] = 1, small[5] = 0xFFFF;
  EXPECT_EQ(Packed(small, 16).size(), 1u + 4);
  // One that stands out: an exception of two bytes, not sixteen wide lanes.
  small[7] = 1000;
  EXPECT_EQ(Packed(small, 16).size(), 1u + 4 + 2);
  // All far from zero and near each other: lateral, the first an exception.
  Row alike;
  for (int i = 0; i < kPackedLanes; ++i) {
    alike[i] = static_cast<uint16_t>(5000 + i % 2);
  }
  EXPECT_LE(Packed(alike, 16).size(), 1u + 4 + 4);
  // Never longer than the numbers as they are.
  Random random(2);
  for (int repeat = 0; repeat < 100; ++repeat) {
    Row noise;
    for (uint16_t& number : noise) {
      number = static_cast<uint16_t>(UniformIndex(random, 1 << 16));
    }
    EXPECT_LE(Packed(noise, 16).size(), 1u + 32);
    EXPECT_LE(Packed(noise, 8).size(), 1u + 16);
  }
}

TEST(PackedRowTest, RefusesWhatIsMalformed) {
  Row back;
  const auto unpacks = [&](absl::string_view bytes, int bits) {
    return UnpackRow(bytes, bits, back.data());
  };
  EXPECT_FALSE(unpacks("", 16));
  Row row = {};
  row[3] = 3, row[4] = 900, row[9] = 700;
  const std::string bytes = Packed(row, 16);
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(unpacks(bytes.substr(0, size), 16)) << size;
  }
  // Wider than a number can be.
  EXPECT_FALSE(unpacks(std::string(1, 17) + std::string(40, 1), 16));
  EXPECT_FALSE(unpacks(std::string(1, 9) + std::string(40, 1), 8));
  // Two exceptions at one lane, or in falling order; one that leaves 8 bits.
  const auto with_exceptions = [](int count, const char* exceptions) {
    return std::string(1, static_cast<char>(count << 6)) + exceptions;
  };
  EXPECT_TRUE(unpacks(with_exceptions(2, "\x13\x01\x14\x01"), 16));
  EXPECT_FALSE(unpacks(with_exceptions(2, "\x13\x01\x13\x01"), 16));
  EXPECT_FALSE(unpacks(with_exceptions(2, "\x14\x01\x13\x01"), 16));
  EXPECT_FALSE(unpacks(with_exceptions(1, "\x13\x10"), 8));
}

// Any bytes: sixteen numbers or false, and never more bytes than there are.
TEST(PackedRowTest, NoiseIsHarmless) {
  Random random(3);
  for (int repeat = 0; repeat < 20000; ++repeat) {
    std::string bytes(UniformIndex(random, 50), '\0');
    for (char& c : bytes) c = static_cast<char>(UniformIndex(random, 256));
    for (int bits : {8, 16}) {
      absl::string_view left = bytes;
      Row row;
      if (UnpackRow(left, bits, row.data())) ExpectComesBack(row, bits);
      EXPECT_LE(left.size(), bytes.size());
    }
  }
}

}  // namespace
}  // namespace gelenk
