#include "gelenk/import/gltf_skin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "gelenk/import/gltf_reader.h"
#include "tests/core/import/gltf_buffer.h"
#include "tests/core/import/gltf_skin_oracle.h"
#include "tests/testing/gltf_files.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::Fails;
using ::gelenk::testing::Glb;
using ::gelenk::testing::GltfBuffer;
using ::gelenk::testing::GltfSkinOracle;
using ::gelenk::testing::LargestError;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomTurns;
using ::gelenk::testing::TurnedPose;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;
// Of the mesh's size: vertices are floats.
constexpr double kSinglePrecision = 1e-6;

constexpr int kFloat = 5126;
constexpr int kByte = 5121;
constexpr int kShort = 5123;
constexpr int kInt = 5125;

// A file in centimetres, z up, below an armature given as a matrix that makes
// metres and y up of it. Hip, knee and a joint "toe" with a scale of its own;
// the mesh's own node stands somewhere, which says nothing. Two primitives:
// indexed triangles with normals and one set of joints; a strip without
// indices and normals with two sets, as shorts and normalised bytes. What a
// test wants otherwise it changes before it takes Gltf().
struct File : GltfBuffer {
  std::vector<std::string> meshes;
  std::vector<std::string> skins;
  std::string more_nodes;
  // Children of the armature beside the hip.
  std::string more_children;

  std::string Json(const std::string& members) const {
    std::string text = absl::StrCat(
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)",
        R"("nodes":[{"name":"armature","children":[1,4)", more_children,
        R"(],"matrix":[0.01,0,0,0, 0,0,-0.01,0, 0,0.01,0,0, 0.5,0,0.25,1]},)",
        R"({"name":"hip","children":[2],"translation":[0,3,95]},)",
        R"({"name":"knee","children":[3],"translation":[0,0,-45],)",
        R"("rotation":[0.6,0,0,0.8]},)",
        R"({"name":"toe","translation":[0,4,-45],"scale":[2,0.5,1]},)",
        R"({"name":"body","mesh":0,"skin":0,"translation":[7,7,7]})",
        more_nodes, R"(],"meshes":[)");
    for (size_t i = 0; i < meshes.size(); ++i) {
      absl::StrAppend(&text, i > 0 ? "," : "", meshes[i]);
    }
    absl::StrAppend(&text, R"(],"skins":[)");
    for (size_t i = 0; i < skins.size(); ++i) {
      absl::StrAppend(&text, i > 0 ? "," : "", skins[i]);
    }
    return absl::StrCat(text, "],", members, "}");
  }
  std::string Gltf() const { return Json(Members()); }
};

std::string Skin(const char* joints, int matrices) {
  return absl::StrCat(R"({"joints":)", joints, R"(,"inverseBindMatrices":)",
                      matrices, "}");
}

// Three columns of a bind matrix by rows of its transpose, as files have them.
// The bind pose is not the rest pose.
const std::vector<float> kBindMatrices = {
    1, 0, 0,  0, 0, 1, 0, 0, 0, 0,  1, 0, 0, -3, -95, 1,  //
    1, 0, 0,  0, 0, 0, 1, 0, 0, -1, 0, 0, 2, 50, 4,   1,  //
    0, 0, -2, 0, 0, 1, 0, 0, 2, 0,  0, 0, 1, 5,  -3,  1};

File BodyFile() {
  File file;
  const int triangles =
      file.AddNumbers<uint16_t>({0, 1, 2, 0, 2, 3}, kShort, "SCALAR", 6);
  const int positions = file.AddNumbers<float>(
      {-9, 0, 95, 9, 0, 95, 9, 0, 40, -9, 1, 40}, kFloat, "VEC3", 4);
  const int normals = file.AddNumbers<float>(
      {0, 1, 0, 0, 0.6F, 0.8F, 0, 1, 0, 0, 0, 0}, kFloat, "VEC3", 4);
  const int joints = file.AddNumbers<uint8_t>(
      {0, 1, 0, 0, 1, 0, 9, 0, 2, 1, 0, 0, 1, 2, 0, 0}, kByte, "VEC4", 4);
  const int weights = file.AddNumbers<float>(
      {1, 0, 0, 0, 0.75F, 0.25F, 0, 0, 2, 2, 4, 0, 0.5F, 0.5F, 0, 0}, kFloat,
      "VEC4", 4);
  const int strip = file.AddNumbers<float>(
      {-5, 0, 30, 5, 0, 30, -5, 2, 10, 5, 2, 10}, kFloat, "VEC3", 4);
  const int strip_joints = file.AddNumbers<uint16_t>(
      {1, 0, 2, 0, 1, 0, 2, 0, 2, 0, 0, 0, 2, 1, 0, 0}, kShort, "VEC4", 4);
  const int strip_weights = file.AddNumbers<uint8_t>(
      {255, 0, 0, 0, 100, 55, 100, 0, 255, 0, 0, 0, 51, 51, 0, 0}, kByte,
      "VEC4", 4, R"(,"normalized":true)");
  const int more_joints = file.AddNumbers<uint8_t>(
      {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 1, 0, 0}, kByte, "VEC4", 4);
  // Only the last vertex has some: sparse.
  const int view_of_indices = file.AddView(std::string("\3", 1));
  const int view_of_values =
      file.AddView(gelenk::testing::Bytes<float>({0.3F, 0.3F, 0, 0}));
  const int more_weights = file.AddAccessor(absl::StrCat(
      R"("componentType":5126,"count":4,"type":"VEC4","sparse":{"count":1,)",
      R"("indices":{"bufferView":)", view_of_indices,
      R"(,"componentType":5121},"values":{"bufferView":)", view_of_values,
      "}}"));
  file.meshes = {absl::StrCat(
      R"({"name":"body","primitives":[{"indices":)", triangles,
      R"(,"attributes":{"POSITION":)", positions, R"(,"NORMAL":)", normals,
      R"(,"JOINTS_0":)", joints, R"(,"WEIGHTS_0":)", weights,
      R"(}},{"mode":5,"attributes":{"POSITION":)", strip, R"(,"JOINTS_0":)",
      strip_joints, R"(,"WEIGHTS_0":)", strip_weights, R"(,"JOINTS_1":)",
      more_joints, R"(,"WEIGHTS_1":)", more_weights, "}}]}")};
  file.skins = {
      Skin("[1,2,3]", file.AddNumbers(kBindMatrices, kFloat, "MAT4", 3))};
  return file;
}

struct Read {
  GltfImport import;
  GltfSkinnedMesh skinned;
  std::shared_ptr<const WeightedSkin> skin;
};

absl::StatusOr<Read> ReadFile(const std::string& bytes,
                              const GltfSkinOptions& options = {}) {
  const absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
  if (!document.ok()) return document.status();
  absl::StatusOr<GltfImport> import = ImportGltf(*document);
  if (!import.ok()) return import.status();
  absl::StatusOr<GltfSkinnedMesh> skinned =
      ReadGltfSkin(bytes, *document, *import, options);
  if (!skinned.ok()) return skinned.status();
  auto skin = WeightedSkin::Create(import->skeleton, skinned->mesh,
                                   skinned->weights, BindOptions(*skinned));
  if (!skin.ok()) return skin.status();
  return Read{*std::move(import), *std::move(skinned), *std::move(skin)};
}

void ExpectDeformsAsTheFormulaSays(const Read& read, const std::string& bytes) {
  const GltfSkinOracle oracle(bytes);
  Random random(1);
  SkinWorkspace workspace;
  VertexBlocks blocks;
  for (int i = 0; i < 20; ++i) {
    const TurnedPose pose = RandomTurns(random, read.import, 0.2 * i);
    read.skin->Deform(pose.positions, {}, workspace, blocks);
    EXPECT_LT(LargestError(oracle.Positions(pose.turns), *read.skin, blocks),
              kSinglePrecision)
        << i;
  }
}

TEST(GltfSkinTest, DeformsAsTheFormulaSays) {
  const std::string bytes = BodyFile().Gltf();
  const absl::StatusOr<Read> read = ReadFile(bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_THAT(read->skinned.warnings, IsEmpty());
  EXPECT_THAT(read->skinned.mesh.triangles,
              ElementsAre(Triangle(0, 1, 2), Triangle(0, 2, 3),
                          Triangle(4, 5, 6), Triangle(6, 5, 7)));
  // Three of the first set, one of them without weight; two and two.
  EXPECT_EQ(read->skinned.weights.influences_per_vertex, 4);
  ExpectDeformsAsTheFormulaSays(*read, bytes);
}

TEST(GltfSkinTest, RestMeshIsWhereTheSceneShowsIt) {
  const std::string bytes = BodyFile().Gltf();
  const absl::StatusOr<Read> read = ReadFile(bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  const TriangleMesh rest =
      RestMesh(*read->import.skeleton, read->skinned.mesh,
               read->skinned.weights, BindOptions(read->skinned));
  const std::vector<Vector3d> want = GltfSkinOracle(bytes).Positions({});
  ASSERT_EQ(rest.positions.size(), want.size());
  for (size_t i = 0; i < want.size(); ++i) {
    EXPECT_LT((rest.positions[i] - want[i]).norm(), kSinglePrecision) << i;
    EXPECT_NEAR(rest.normals[i].norm(), 1, 1e-12) << i;
  }
}

// The skeleton's unit is the skin's.
TEST(GltfSkinTest, AnotherUnitScalesTheSkin) {
  const std::string bytes = BodyFile().Gltf();
  const GltfDocument document = ReadGltf(bytes).value();
  const GltfImport import = ImportGltf(document, {.unit_m = 0.01}).value();
  const GltfSkinnedMesh skinned = ReadGltfSkin(bytes, document, import).value();
  const TriangleMesh rest = RestMesh(*import.skeleton, skinned.mesh,
                                     skinned.weights, BindOptions(skinned));
  const std::vector<Vector3d> want = GltfSkinOracle(bytes).Positions({});
  for (size_t i = 0; i < want.size(); ++i) {
    EXPECT_LT((rest.positions[i] - 0.01 * want[i]).norm(), 1e-8) << i;
  }
}

// A triangle that hangs from the hip, of half a metre.
File PlateFile() {
  File file;
  const int positions =
      file.AddNumbers<float>({0, 0, 0, 50, 0, 0, 0, 50, 0}, kFloat, "VEC3", 3);
  const int joints =
      file.AddNumbers<uint8_t>(std::vector<uint8_t>(12, 0), kByte, "VEC4", 3);
  const int weights = file.AddNumbers<float>(
      {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, kFloat, "VEC4", 3);
  file.meshes = {absl::StrCat(R"({"primitives":[{"attributes":{"POSITION":)",
                              positions, R"(,"JOINTS_0":)", joints,
                              R"(,"WEIGHTS_0":)", weights, "}}]}")};
  // Without matrices, which are then identities.
  file.skins = {R"({"joints":[1,2,3]})"};
  return file;
}

TEST(GltfSkinTest, MissingNormalsAreMeansAndTurnWithTheScene) {
  const absl::StatusOr<Read> read = ReadFile(PlateFile().Gltf());
  ASSERT_TRUE(read.ok()) << read.status();
  // z of the file is y of the world.
  for (const Vector3d& normal : read->skinned.mesh.normals) {
    EXPECT_LT((normal - Vector3d::UnitY()).norm(), 1e-12);
  }
  EXPECT_EQ(read->skinned.weights.influences_per_vertex, 1);
}

// Triangles still run counter-clockwise seen from where the normals point.
TEST(GltfSkinTest, MirroredBindingsTurnTrianglesOver) {
  File file = PlateFile();
  std::vector<float> matrices = kBindMatrices;
  matrices[0] = -1;
  file.skins = {Skin("[1,2,3]", file.AddNumbers(matrices, kFloat, "MAT4", 3))};
  const std::string bytes = file.Gltf();
  const absl::StatusOr<Read> read = ReadFile(bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  TriangleMesh bare = read->skinned.mesh;
  bare.normals.clear();
  EXPECT_LT((VertexNormals(bare)[0] - read->skinned.mesh.normals[0]).norm(),
            1e-12);
  ExpectDeformsAsTheFormulaSays(*read, bytes);
}

// A second mesh with a skin of its own that shares a joint, and a rigid piece.
File DressedFile() {
  File file = BodyFile();
  const int positions = file.AddNumbers<float>({-9, 0, 60, 9, 0, 60, 9, 2, 20},
                                               kFloat, "VEC3", 3);
  const int joints = file.AddNumbers<uint8_t>(
      {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, kByte, "VEC4", 3);
  const int weights = file.AddNumbers<float>(
      {1, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, kFloat, "VEC4", 3);
  file.meshes.push_back(absl::StrCat(
      R"({"name":"trousers","primitives":[{"attributes":{"POSITION":)",
      positions, R"(,"JOINTS_0":)", joints, R"(,"WEIGHTS_0":)", weights,
      "}}]}"));
  file.meshes.push_back(
      absl::StrCat(R"({"name":"spur","primitives":[{"attributes":)",
                   R"({"POSITION":)", positions, "}}]}"));
  // The toe, then the knee, bound as in the first skin.
  std::vector<float> matrices(kBindMatrices.begin() + 32, kBindMatrices.end());
  matrices.insert(matrices.end(), kBindMatrices.begin() + 16,
                  kBindMatrices.begin() + 32);
  file.skins.push_back(
      Skin("[3,2]", file.AddNumbers(matrices, kFloat, "MAT4", 2)));
  file.more_children = ",5,6";
  file.more_nodes =
      R"(,{"mesh":1,"skin":1},{"mesh":2},)"
      R"({"name":"heel","mesh":2,"translation":[0,1,2],"scale":[1,-2,1]})";
  return file;
}

TEST(GltfSkinTest, MeshesOnOneSkeletonAreJoined) {
  File file = DressedFile();
  // The heel hangs from the toe; the spur at node 6 from nothing.
  const std::string bytes = absl::StrReplaceAll(
      file.Gltf(), {{R"("name":"toe",)", R"("name":"toe","children":[7],)"}});
  const absl::StatusOr<Read> read = ReadFile(bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_THAT(read->skinned.warnings,
              ElementsAre(HasSubstr("1 meshes are left out: they hang from no "
                                    "joint")));
  EXPECT_EQ(read->skinned.mesh.positions.size(), 8u + 3 + 3);
  const std::string without_spur = absl::StrReplaceAll(
      bytes, {{R"(,{"mesh":2},)", R"(,{"name":"nothing"},)"}});
  ExpectDeformsAsTheFormulaSays(*read, without_spur);
}

TEST(GltfSkinTest, OneMeshByNameOrIndex) {
  const std::string bytes = DressedFile().Gltf();
  for (const char* mesh : {"trousers", "1"}) {
    const absl::StatusOr<Read> read = ReadFile(bytes, {.mesh = mesh});
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(read->skinned.mesh.positions.size(), 3u);
  }
  EXPECT_THAT(ReadFile(bytes, {.mesh = "hat"}).status(),
              Fails(kBad, "mesh: there is none called \"hat\" among the 3"));
  EXPECT_THAT(ReadFile(bytes, {.mesh = "spur"}).status(),
              Fails(kBad, "none is moved by this skeleton's joints"));
}

TEST(GltfSkinTest, RefusesAJointThatIsBoundInTwoPlaces) {
  File file = DressedFile();
  std::vector<float> matrices(kBindMatrices.begin(),
                              kBindMatrices.begin() + 32);
  file.skins[1] = Skin("[3,2]", file.AddNumbers(matrices, kFloat, "MAT4", 2));
  EXPECT_THAT(ReadFile(file.Gltf()).status(),
              Fails(kBad, "skins[1]: binds joint \"knee\" in another place"));
  EXPECT_TRUE(ReadFile(file.Gltf(), {.mesh = "trousers"}).ok());
}

TEST(GltfSkinTest, LeavesOutWhatTheSkeletonDoesNotMove) {
  File file = DressedFile();
  // Joints that are not among those of the largest skin.
  file.skins[1] = R"({"joints":[0]})";
  const absl::StatusOr<Read> read = ReadFile(file.Gltf());
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_THAT(read->skinned.warnings,
              Contains(HasSubstr("1 meshes are left out: their skin")));
  EXPECT_EQ(read->skinned.mesh.positions.size(), 8u);
}

TEST(GltfSkinTest, LinesAndVerticesWithoutWeightAreTold) {
  File file = BodyFile();
  const int weights = file.AddNumbers<float>(
      {1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, kFloat, "VEC4", 4);
  file.meshes[0] = absl::StrReplaceAll(
      file.meshes[0],
      {{R"("WEIGHTS_0":4)", absl::StrCat(R"("WEIGHTS_0":)", weights)},
       {R"("mode":5)", R"("mode":1)"}});
  const absl::StatusOr<Read> read = ReadFile(file.Gltf());
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_THAT(read->skinned.warnings,
              ElementsAre(HasSubstr("1 primitives of points or lines"),
                          HasSubstr("1 vertices have no weight")));
  EXPECT_EQ(read->skinned.mesh.positions.size(), 4u);
}

TEST(GltfSkinTest, BuffersInAGlbAndInOtherFiles) {
  const File file = BodyFile();
  const std::string in_glb = file.Json(
      file.Members(absl::StrCat("{\"byteLength\":", file.buffer.size(), "}")));
  EXPECT_TRUE(ReadFile(Glb(in_glb, file.buffer)).ok());
  for (const char* uri : {"body.bin", "../../etc/passwd", "/etc/passwd",
                          "http://localhost/body.bin"}) {
    const std::string bytes = file.Json(
        file.Members(absl::StrCat(R"({"byteLength":9,"uri":")", uri, "\"}")));
    EXPECT_THAT(ReadFile(bytes).status(),
                Fails(kBad, absl::StrCat("buffers[0].uri: is in another file, ",
                                         "\"", uri, "\"")));
  }
}

struct Mistake {
  const char* from;
  const char* to;
  const char* words;
};

TEST(GltfSkinTest, RefusesWhatIsMalformedByPath) {
  const std::string right = BodyFile().Gltf();
  ASSERT_TRUE(ReadFile(right).ok()) << ReadFile(right).status();
  const Mistake mistakes[] = {
      {R"("mesh":0)", R"("mesh":3)", "meshes[3]: there are 1"},
      {R"("mesh":0)", R"("mesh":-1)", "nodes[4].mesh: want a whole number"},
      {R"("skin":0)", R"("skin":5)", "skins[5]: there are 1"},
      {R"("primitives":[)", R"("primitives":[],"_":[)",
       "meshes[0].primitives: want an array of at least one"},
      {R"("mode":5)", R"("mode":7)", "primitives[1]: mode: want 0 to 6, got 7"},
      {R"("POSITION":1)", R"("_":1)",
       "meshes[0].primitives[0]: attributes.POSITION: missing"},
      {R"("POSITION":1)", R"("POSITION":0)", "accessors[0].type: want VEC3"},
      {R"("POSITION":1)", R"("POSITION":99)", "accessors[99]: there are"},
      {R"("JOINTS_0":3,)", "", "attributes.JOINTS_0: missing"},
      {R"("WEIGHTS_0":4)", R"("_":4)", "attributes.WEIGHTS_0: missing"},
      {R"("WEIGHTS_1")", R"("_")", "attributes.WEIGHTS_1: missing"},
      {R"("JOINTS_1":8)", R"("JOINTS_1":8,"JOINTS_2":8)",
       "JOINTS_2: want at most 8 joints a vertex"},
      {R"("JOINTS_0":3)", R"("JOINTS_0":1)", "accessors[1].type: want VEC4"},
      {R"("JOINTS_0":3)", R"("JOINTS_0":4)",
       "accessors[4].componentType: want 5121, 5123 or 5125"},
      {R"("WEIGHTS_0":4)", R"("WEIGHTS_0":3)",
       "accessors[3].componentType: want 5126, or normalized"},
      {R"("indices":0)", R"("indices":1)", "accessors[1].type: want SCALAR"},
      {R"("inverseBindMatrices":10)", R"("inverseBindMatrices":1)",
       "accessors[1].type: want MAT4"},
      {R"("joints":[1,2,3])", R"("joints":[1,2,3,0])",
       "skins[0].inverseBindMatrices: want 4, one a joint, got 3"},
      {R"("joints":[1,2,3])", R"("joints":[1,2])",
       "skins[0]: want a joint, 0 to 1, of every vertex, got 2"},
      // Absurd counts are refused before anything is made room for.
      {R"("count":4,"type":"VEC3")", R"("count":4000000000,"type":"VEC3")",
       "POSITION: want at most 1048576 vertices altogether, got 4000000000"},
      {R"("count":6,)", R"("count":4000000000000,)", "indices: want at most"},
      {R"("count":6,)", R"("count":5,)", "want three for a triangle, got 5"},
      {R"("count":6,)", R"("count":9,)",
       "accessors[0]: 9 elements end at byte 18 of bufferViews[0], which has "
       "12"},
      {R"("byteOffset":12,"byteLength":48)",
       R"("byteOffset":12,"byteLength":999999)", "bufferViews[1]: bytes 12"},
      {R"("byteOffset":12,"byteLength":48)",
       R"("byteOffset":-12,"byteLength":48)", "want a whole number >= 0"},
      {R"("byteOffset":12,"byteLength":48)",
       R"("byteOffset":12,"byteLength":48,"byteStride":1)",
       "bufferViews[1].byteStride: want at least 12, got 1"},
      {R"("mode":5)",
       R"("mode":5,"extensions":{"KHR_draco_mesh_compression":{}})",
       "is compressed"},
  };
  for (const Mistake& mistake : mistakes) {
    SCOPED_TRACE(mistake.to);
    const std::string wrong =
        absl::StrReplaceAll(right, {{mistake.from, mistake.to}});
    ASSERT_NE(right, wrong) << mistake.from;
    EXPECT_THAT(ReadFile(wrong).status(), Fails(kBad, mistake.words));
  }
}

// The accessor `name` of the first primitive, replaced by other numbers.
template <class T>
std::string WithNumbers(const char* name, int old_index,
                        const std::vector<T>& numbers, int component_type,
                        const char* type, size_t count) {
  File file = BodyFile();
  const int index = file.AddNumbers(numbers, component_type, type, count);
  const std::string from = absl::StrCat("\"", name, "\":", old_index);
  for (std::string* text : {&file.meshes[0], &file.skins[0]}) {
    *text = absl::StrReplaceAll(
        *text, {{from, absl::StrCat("\"", name, "\":", index)}});
  }
  return file.Gltf();
}

TEST(GltfSkinTest, RefusesNumbersOutOfRange) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  const std::vector<float> none = {1, 0, 0, 0, 1, 0, 0, 0,
                                   1, 0, 0, 0, 1, 0, 0, 0};
  EXPECT_THAT(ReadFile(WithNumbers<uint32_t>("indices", 0, {0, 1, 4}, kInt,
                                             "SCALAR", 3))
                  .status(),
              Fails(kBad, "indices[2]: want a vertex, 0 to 3, got 4"));
  EXPECT_THAT(ReadFile(WithNumbers<uint32_t>("indices", 0, {0, 1, 0xFFFFFFFF},
                                             kInt, "SCALAR", 3))
                  .status(),
              Fails(kBad, "got 4294967295"));
  EXPECT_THAT(
      ReadFile(WithNumbers<float>("POSITION", 1,
                                  {0, 0, 0, 0, 0, 0, 0, kNan, 0, 0, 0, 0},
                                  kFloat, "VEC3", 4))
          .status(),
      Fails(kBad,
            "attributes.POSITION[2]: has a number that is not "
            "finite"));
  EXPECT_THAT(
      ReadFile(WithNumbers<float>("POSITION", 1,
                                  {0, 0, 0, 0, 0, 0, 0, 1e9F, 0, 0, 0, 0},
                                  kFloat, "VEC3", 4))
          .status(),
      Fails(kBad, "positions[2]: want coordinates within 1000"));
  EXPECT_THAT(
      ReadFile(WithNumbers<float>("POSITION", 1, {0, 0, 0}, kFloat, "VEC3", 1))
          .status(),
      Fails(kBad, "indices[1]: want a vertex, 0 to 0, got 1"));
  for (float bad : {kNan, kInfinite, -0.5F}) {
    std::vector<float> weights = none;
    weights[13] = bad;
    EXPECT_THAT(
        ReadFile(WithNumbers("WEIGHTS_0", 4, weights, kFloat, "VEC4", 4))
            .status(),
        Fails(kBad, "attributes.WEIGHTS_0[3]"));
  }
  EXPECT_THAT(
      ReadFile(
          WithNumbers<float>("WEIGHTS_0", 4, {1, 0, 0, 0}, kFloat, "VEC4", 1))
          .status(),
      Fails(kBad, "WEIGHTS_0: want 4, as many as there are positions, got 1"));
  std::vector<uint8_t> joints(16, 0);
  joints[4] = 77;
  EXPECT_THAT(
      ReadFile(WithNumbers("JOINTS_0", 3, joints, kByte, "VEC4", 4)).status(),
      Fails(kBad,
            "skins[0]: want a joint, 0 to 2, of every vertex, "
            "got 77"));
  for (size_t at : {3, 12}) {
    std::vector<float> matrices = kBindMatrices;
    matrices[at] = at == 3 ? 1 : kNan;
    EXPECT_THAT(ReadFile(WithNumbers("inverseBindMatrices", 10, matrices,
                                     kFloat, "MAT4", 3))
                    .status(),
                Fails(kBad, "skins[0].inverseBindMatrices[0]: want finite"));
  }
  EXPECT_THAT(
      ReadFile(WithNumbers("inverseBindMatrices", 10,
                           std::vector<float>{
                               0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1,
                               0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1,
                               0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1},
                           kFloat, "MAT4", 3))
          .status(),
      Fails(kBad, "has no inverse"));
}

TEST(GltfSkinTest, BoundsHoldForAllMeshesTogether) {
  const std::string bytes = DressedFile().Gltf();
  GltfSkinOptions options;
  options.bounds.max_vertices = 11;
  options.bounds.max_triangles = 5;
  EXPECT_TRUE(ReadFile(bytes, options).ok());
  options.bounds.max_vertices = 10;
  EXPECT_THAT(ReadFile(bytes, options).status(),
              Fails(kBad, "vertices altogether"));
  options.bounds = {.max_vertices = 11, .max_triangles = 4};
  EXPECT_THAT(ReadFile(bytes, options).status(),
              Fails(kBad, "triangles altogether"));
}

}  // namespace
}  // namespace gelenk
