#include "gelenk/formats/obj_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <system_error>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "gelenk/formats/decimal_number.h"
#include "gelenk/formats/file_unit.h"
#include "gelenk/formats/text_position.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

// No length in any unit comes near; keeps squares finite.
constexpr double kMaxMagnitude = 1e9;

// Of which there can be one for each corner of the triangles around a vertex.
constexpr int kNormalsPerVertex = 6;

// What is read, and what says nothing about the mesh.
constexpr absl::string_view kKnown[] = {
    "v", "vn", "f", "vt", "g", "o", "s", "usemtl", "mtllib", "mg", "lod"};

bool IsKnown(absl::string_view keyword) {
  return keyword.empty() || keyword[0] == '#' ||
         std::find(std::begin(kKnown), std::end(kKnown), keyword) !=
             std::end(kKnown);
}

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

bool EndsLine(char c) { return c == '\n' || c == '\r'; }

// Cuts the text into statements, and those into tokens.
class ObjScanner {
 public:
  explicit ObjScanner(absl::string_view text) : text_(text), position_(text) {}

  // Goes on to the next statement; false at the end of the text.
  bool NextStatement();
  // The next token of the statement, left in place; empty at its end.
  absl::string_view Peek();
  void Take() { at_ += Peek().size(); }

  absl::StatusOr<double> TakeNumber();

  std::string Position() { return position_.Of(at_); }
  absl::Status Expected(absl::string_view what) {
    const absl::string_view token = Peek();
    return position_.Expected(at_, what, token, "the end of the line");
  }

 private:
  // Bytes of a backslash and the line's end behind it; 0 where there is none.
  size_t ContinuationAt(size_t at) const;

  absl::string_view text_;
  size_t at_ = 0;
  TextPosition position_;
};

size_t ObjScanner::ContinuationAt(size_t at) const {
  if (text_[at] != '\\' || at + 1 == text_.size()) return 0;
  if (absl::StartsWith(text_.substr(at + 1), "\r\n")) return 3;
  return EndsLine(text_[at + 1]) ? 2 : 0;
}

bool ObjScanner::NextStatement() {
  // What is left of a statement ends with its line, even behind a backslash:
  // names of files on Windows end with one.
  if (at_ > 0) {
    while (at_ < text_.size() && !EndsLine(text_[at_])) ++at_;
  }
  while (at_ < text_.size() && (IsBlank(text_[at_]) || EndsLine(text_[at_]))) {
    ++at_;
  }
  return at_ < text_.size();
}

absl::string_view ObjScanner::Peek() {
  while (at_ < text_.size()) {
    if (IsBlank(text_[at_])) {
      ++at_;
    } else if (const size_t size = ContinuationAt(at_); size > 0) {
      at_ += size;
    } else {
      break;
    }
  }
  size_t end = at_;
  while (end < text_.size() && !IsBlank(text_[end]) && !EndsLine(text_[end]) &&
         ContinuationAt(end) == 0) {
    ++end;
  }
  return text_.substr(at_, end - at_);
}

absl::StatusOr<double> ObjScanner::TakeNumber() {
  double number = 0;
  std::errc error{};
  if (!ParseDecimal(Peek(), number, error)) return Expected("a number");
  if (error != std::errc{} || !(std::abs(number) <= kMaxMagnitude)) {
    return Expected("a finite number of at most 1e9");
  }
  Take();
  return number;
}

class ObjParser {
 public:
  ObjParser(absl::string_view text, const ObjOptions& options)
      : options_(options), scanner_(text) {}

  absl::StatusOr<ObjMesh> Parse();

 private:
  // A list that faces number, and the first of the largest numbers that faces
  // have used before there was so much of it.
  struct Numbered {
    const char* name;
    std::vector<Vector3d> vectors = {};
    int64_t most_used = 0;
    std::string used_at = {};
  };
  struct Corner {
    int vertex = -1;
    // -1 for none.
    int normal = -1;
  };

  absl::Status ReadVector(double unit, Numbered& list);
  absl::Status ReadFace();
  absl::StatusOr<Corner> TakeCorner();
  // The place that `number` means in `list`.
  absl::StatusOr<int> Resolve(absl::string_view number, Numbered& list);
  absl::Status CheckUse(const Numbered& list) const;
  absl::StatusOr<ObjMesh> Finish();

  const ObjOptions& options_;
  ObjScanner scanner_;
  Numbered vertices_{.name = "vertex"};
  Numbered normals_{.name = "normal"};
  std::vector<Triangle> triangles_;
  // Corners that name a normal.
  std::vector<Corner> normal_corners_;
  // Of the face that is read.
  std::vector<Corner> corners_;
  int left_out_ = 0;
  std::string first_left_out_;
};

absl::StatusOr<ObjMesh> ObjParser::Parse() {
  while (scanner_.NextStatement()) {
    const absl::string_view keyword = scanner_.Peek();
    if (!IsKnown(keyword) && left_out_++ == 0) {
      first_left_out_ = scanner_.Position();
    }
    scanner_.Take();
    absl::Status status;
    if (keyword == "v") status = ReadVector(options_.unit_m, vertices_);
    if (keyword == "vn") status = ReadVector(1, normals_);
    if (keyword == "f") status = ReadFace();
    if (!status.ok()) return status;
  }
  return Finish();
}

absl::Status ObjParser::ReadVector(double unit, Numbered& list) {
  const size_t most = static_cast<size_t>(options_.bounds.max_vertices) *
                      (&list == &normals_ ? kNormalsPerVertex : 1);
  if (list.vectors.size() == most) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: more than %d times a %s", scanner_.Position(), most, list.name));
  }
  Vector3d vector;
  for (double& number : vector) {
    const absl::StatusOr<double> read = scanner_.TakeNumber();
    if (!read.ok()) return read.status();
    number = unit * *read;
  }
  // Behind it weights and colours may follow.
  list.vectors.push_back(vector);
  return absl::OkStatus();
}

absl::StatusOr<int> ObjParser::Resolve(absl::string_view number,
                                       Numbered& list) {
  const auto count = static_cast<int64_t>(list.vectors.size());
  int64_t index = 0;
  std::errc error{};
  if (!ParseDecimal(number, index, error) || error != std::errc{} ||
      index == 0 || index < -count || index > kMaxMagnitude) {
    return scanner_.Expected(
        absl::StrFormat("the number of a %s, from 1 or, of %d so far, from -1",
                        list.name, count));
  }
  if (index < 0) return static_cast<int>(count + index);
  if (index > count && index > list.most_used) {
    list.most_used = index;
    list.used_at = scanner_.Position();
  }
  return static_cast<int>(index - 1);
}

absl::StatusOr<ObjParser::Corner> ObjParser::TakeCorner() {
  const absl::string_view token = scanner_.Peek();
  const size_t first = token.find('/');
  const size_t second =
      first == token.npos ? token.npos : token.find('/', first + 1);
  Corner corner;
  const absl::StatusOr<int> vertex = Resolve(token.substr(0, first), vertices_);
  if (!vertex.ok()) return vertex.status();
  corner.vertex = *vertex;
  if (second != token.npos) {
    const absl::StatusOr<int> normal =
        Resolve(token.substr(second + 1), normals_);
    if (!normal.ok()) return normal.status();
    corner.normal = *normal;
  }
  scanner_.Take();
  return corner;
}

absl::Status ObjParser::ReadFace() {
  corners_.clear();
  while (!scanner_.Peek().empty()) {
    const absl::StatusOr<Corner> corner = TakeCorner();
    if (!corner.ok()) return corner.status();
    corners_.push_back(*corner);
    if (corners_.size() < 3) continue;
    if (triangles_.size() ==
        static_cast<size_t>(options_.bounds.max_triangles)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: more than %d triangles", scanner_.Position(),
                          options_.bounds.max_triangles));
    }
    triangles_.emplace_back(corners_[0].vertex,
                            corners_[corners_.size() - 2].vertex,
                            corner->vertex);
  }
  if (corners_.size() < 3) return scanner_.Expected("three corners of a face");
  for (const Corner& corner : corners_) {
    if (corner.normal >= 0) normal_corners_.push_back(corner);
  }
  return absl::OkStatus();
}

absl::Status ObjParser::CheckUse(const Numbered& list) const {
  if (list.most_used <= static_cast<int64_t>(list.vectors.size())) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("%s: expected a %s, 1 to %d, got %d", list.used_at,
                      list.name, list.vectors.size(), list.most_used));
}

absl::StatusOr<ObjMesh> ObjParser::Finish() {
  if (vertices_.vectors.empty() || triangles_.empty()) {
    return absl::InvalidArgumentError(
        "there is no vertex or no face: this is no OBJ");
  }
  for (const Numbered* list : {&vertices_, &normals_}) {
    if (absl::Status status = CheckUse(*list); !status.ok()) return status;
  }
  ObjMesh result;
  TriangleMesh& mesh = result.mesh;
  mesh.positions = std::move(vertices_.vectors);
  mesh.triangles = std::move(triangles_);
  if (!normal_corners_.empty()) {
    mesh.normals.assign(mesh.positions.size(), Vector3d::Zero());
    for (const Corner& corner : normal_corners_) {
      mesh.normals[corner.vertex] +=
          normals_.vectors[corner.normal].stableNormalized();
    }
    FillMissingNormals(mesh);
  }
  if (absl::Status status = CheckMesh(mesh, options_.bounds); !status.ok()) {
    return status;
  }
  if (left_out_ > 0) {
    result.warnings.push_back(
        absl::StrFormat("%d statements of other kinds are left out, the first "
                        "at %s",
                        left_out_, first_left_out_));
  }
  return result;
}

}  // namespace

absl::StatusOr<ObjMesh> ReadObj(absl::string_view text,
                                const ObjOptions& options) {
  if (absl::Status status = CheckFileUnit(options.unit_m); !status.ok()) {
    return status;
  }
  if (text.size() > options.max_bytes) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "want at most %d bytes, got %d", options.max_bytes, text.size()));
  }
  absl::ConsumePrefix(&text, "\xEF\xBB\xBF");
  return ObjParser(text, options).Parse();
}

}  // namespace gelenk
