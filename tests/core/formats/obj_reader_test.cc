#include "gelenk/formats/obj_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::Fails;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;

// A square pyramid without its base: every form of a corner.
constexpr char kPyramid[] = R"(# by hand
mtllib C:\models\
o pyramid
v -1 0 -1
v 1 0 -1 1.0
v 1 0 1 0.5 0.5 0.5
v -1 0 1
v 0 2 0
vt 0.5 0.5
vn 0 1 1
vn 0 1 -1
g sides
usemtl stone
s off
f 1 5 2
f 2/1 5/1 3/1
f 3//1 5//1 4//1
f -2/-1/-1 -1/1/2 1/1/2
)";

ObjMesh Read(absl::string_view text, const ObjOptions& options = {}) {
  absl::StatusOr<ObjMesh> mesh = ReadObj(text, options);
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return mesh.value_or(ObjMesh());
}

absl::Status StatusOf(absl::string_view text, const ObjOptions& options = {}) {
  return ReadObj(text, options).status();
}

// `faces` on three vertices and one normal, in lines 5 and on.
std::string Triangles(absl::string_view faces) {
  return absl::StrCat("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n", faces);
}

TEST(ObjReaderTest, ReadsVerticesAndEveryFormOfCorner) {
  const ObjMesh read = Read(kPyramid);
  EXPECT_THAT(read.warnings, IsEmpty());
  EXPECT_THAT(
      read.mesh.positions,
      ElementsAre(Vector3d(-1, 0, -1), Vector3d(1, 0, -1), Vector3d(1, 0, 1),
                  Vector3d(-1, 0, 1), Vector3d(0, 2, 0)));
  EXPECT_THAT(read.mesh.triangles,
              ElementsAre(Triangle(0, 4, 1), Triangle(1, 4, 2),
                          Triangle(2, 4, 3), Triangle(3, 4, 0)));
}

TEST(ObjReaderTest, NormalsAreMeansOfTheCornersOrOfTheTriangles) {
  const ObjMesh read = Read(kPyramid);
  ASSERT_EQ(read.mesh.normals.size(), 5u);
  // The top has one of each; the third vertex one; the second has none.
  EXPECT_LT((read.mesh.normals[4].normalized() - Vector3d::UnitY()).norm(),
            1e-12);
  EXPECT_LT((read.mesh.normals[2] - Vector3d(0, 1, 1).normalized()).norm(),
            1e-12);
  TriangleMesh bare = read.mesh;
  bare.normals.clear();
  EXPECT_LT((read.mesh.normals[1] - VertexNormals(bare)[1]).norm(), 1e-12);
  EXPECT_THAT(Read(Triangles("f 1 2 3")).mesh.normals, IsEmpty());
}

TEST(ObjReaderTest, PolygonsAreFans) {
  const ObjMesh read = Read(
      "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5\nf 2 3 4 5\n");
  EXPECT_THAT(
      read.mesh.triangles,
      ElementsAre(Triangle(0, 1, 2), Triangle(0, 2, 3), Triangle(0, 3, 4),
                  Triangle(1, 2, 3), Triangle(1, 3, 4)));
}

TEST(ObjReaderTest, AnySpellingIsTheSameMesh) {
  const TriangleMesh want = Read(kPyramid).mesh;
  for (const std::string& text :
       {absl::StrReplaceAll(kPyramid, {{"\n", "\r\n"}}),
        absl::StrReplaceAll(kPyramid, {{"\n", "\r"}}),
        absl::StrCat("\xEF\xBB\xBF", kPyramid),
        absl::StrReplaceAll(kPyramid, {{"\n", "  \t\n\n"}}),
        absl::StrReplaceAll(kPyramid, {{"f 1 5", "f \\\n 1 5 \\\n"}}),
        absl::StrReplaceAll(kPyramid, {{"f 1 5", "f \\\r\n 1 5\\\r\n"}}),
        absl::StrReplaceAll(kPyramid, {{"v 1 0", "  v\t+1.0e0 .0"}})}) {
    const TriangleMesh got = Read(text).mesh;
    EXPECT_EQ(got.positions, want.positions) << text;
    EXPECT_EQ(got.triangles, want.triangles) << text;
    EXPECT_EQ(got.normals, want.normals) << text;
  }
}

TEST(ObjReaderTest, NumbersBackCountFromWhereTheyStand) {
  const ObjMesh read = Read(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 1 1 0\nf -3 -1 -2\n"
      // Forward is fine as well.
      "f 1 2 5\nv 9 9 9\n");
  EXPECT_THAT(
      read.mesh.triangles,
      ElementsAre(Triangle(0, 1, 2), Triangle(1, 3, 2), Triangle(0, 1, 4)));
}

TEST(ObjReaderTest, TheUnitScalesPositions) {
  EXPECT_EQ(Read(kPyramid, {.unit_m = 0.01}).mesh.positions[4],
            Vector3d(0, 0.02, 0));
  for (double bad :
       {0.0, -1.0, 1e7, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(StatusOf(kPyramid, {.unit_m = bad}),
                Fails(kBad, "unit_m: want 1e-09 to 1e+06"));
  }
}

TEST(ObjReaderTest, TellsWhatIsLeftOut) {
  EXPECT_THAT(
      Read(absl::StrCat(kPyramid, "l 1 2 3\np 1\ncurv2 1 2\n")).warnings,
      ElementsAre(HasSubstr("3 statements of other kinds are left out, the "
                            "first at line 19, column 1")));
}

struct Mistake {
  const char* faces;
  const char* words;
};

TEST(ObjReaderTest, SaysWhereAndWhatIsMalformed) {
  const Mistake mistakes[] = {
      {"v 1 2", "line 5, column 6: expected a number, got the end of the line"},
      {"v 1 2,5 3", "line 5, column 5: expected a number, got \"2,5\""},
      {"v 1 nan 3", "expected a finite number of at most 1e9, got \"nan\""},
      {"v 1 1e999 3", "expected a finite number"},
      {"v 1 0x10 3", "expected a number, got \"0x10\""},
      {"vn 1 2 \\\n x", "line 6, column 2: expected a number, got \"x\""},
      {"f 1 2", "line 5, column 6: expected three corners of a face"},
      {"f", "expected three corners of a face, got the end of the line"},
      {"f 1 2 0", "line 5, column 7: expected the number of a vertex, from 1"},
      {"f 1 2 -4", "of 3 so far, from -1, got \"-4\""},
      {"f 1 2 4", "line 5, column 7: expected a vertex, 1 to 3, got 4"},
      {"f 1 2 99999999999", "expected the number of a vertex"},
      {"f 1 2 3.5", "expected the number of a vertex"},
      {"f 1//1 2//1 3//2", "line 5, column 13: expected a normal, 1 to 1"},
      {"f 1//0 2 3", "expected the number of a normal, from 1"},
      {"f 1// 2 3", "expected the number of a normal"},
      {"f / 2 3", "expected the number of a vertex"},
      {"f a b c", "got \"a\""},
      {"v 2000 0 0\nf 1 2 4", "positions[3]: want coordinates within 1000"},
  };
  for (const Mistake& mistake : mistakes) {
    EXPECT_THAT(StatusOf(Triangles(absl::StrCat(mistake.faces, "\n"))),
                Fails(kBad, mistake.words))
        << mistake.faces;
  }
  for (const char* none :
       {"", "\n", "#", "\\\n", "\\", "v 0 0 0", "hello", "f", "\xEF\xBB\xBF"}) {
    EXPECT_EQ(StatusOf(none).code(), kBad) << none;
  }
}

// Normals that cancel, or are zero, give way to the triangles'.
TEST(ObjReaderTest, ZeroNormalsAreReplaced) {
  const ObjMesh read = Read(Triangles("vn 0 0 0\nf 1//2 2//1 3//1\n"));
  EXPECT_EQ(read.mesh.normals[0], Vector3d::UnitZ());
}

TEST(ObjReaderTest, BoundsHoldFromBothSides) {
  ObjOptions options;
  options.bounds = {.max_vertices = 5, .max_triangles = 4};
  EXPECT_TRUE(StatusOf(kPyramid, options).ok());
  options.bounds.max_vertices = 4;
  EXPECT_THAT(StatusOf(kPyramid, options),
              Fails(kBad, "line 8, column 2: more than 4 times a vertex"));
  options.bounds = {.max_vertices = 5, .max_triangles = 3};
  EXPECT_THAT(StatusOf(kPyramid, options),
              Fails(kBad, "more than 3 triangles"));
  options.bounds = {};
  options.max_bytes = std::string(kPyramid).size();
  EXPECT_TRUE(StatusOf(kPyramid, options).ok());
  --options.max_bytes;
  EXPECT_THAT(StatusOf(kPyramid, options), Fails(kBad, "bytes"));
}

}  // namespace
}  // namespace gelenk
