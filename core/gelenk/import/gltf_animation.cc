#include "gelenk/import/gltf_animation.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/types/span.h"
#include "gelenk/base/violations.h"
#include "gelenk/import/glb_container.h"
#include "gelenk/import/gltf_accessor.h"
#include "gelenk/import/gltf_json.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

using nlohmann::json;

constexpr absl::string_view kKeptAtTop[] = {"animations", "accessors",
                                            "bufferViews", "buffers"};
constexpr absl::string_view kKeptBelow[] = {
    "buffer",        "bufferView",    "byteLength", "byteOffset", "byteStride",
    "channels",      "componentType", "count",      "indices",    "input",
    "interpolation", "name",          "node",       "normalized", "output",
    "path",          "sampler",       "samplers",   "sparse",     "target",
    "type",          "uri",           "values"};

absl::Status Fault(absl::string_view path, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", reason));
}

std::string StringOf(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) return "";
  return found->get<std::string>();
}

std::optional<GltfPath> PathOf(absl::string_view name) {
  if (name == "translation") return GltfPath::kTranslation;
  if (name == "rotation") return GltfPath::kRotation;
  if (name == "scale") return GltfPath::kScale;
  return std::nullopt;
}

std::optional<Interpolation> InterpolationOf(absl::string_view name) {
  if (name.empty() || name == "LINEAR") return Interpolation::kLinear;
  if (name == "STEP") return Interpolation::kStep;
  if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
  return std::nullopt;
}

absl::Status CheckTimes(const std::vector<double>& times_s) {
  for (size_t i = 0; i < times_s.size(); ++i) {
    // NaN fails the comparison.
    if (times_s[i] >= 0 && (i == 0 || times_s[i] > times_s[i - 1])) continue;
    return Fault(
        absl::StrCat("input[", i, "]"),
        absl::StrFormat("times want to grow from >= 0 on, got %g", times_s[i]));
  }
  return absl::OkStatus();
}

// Key by key in tangent, value, out tangent, as CUBICSPLINE has them.
void SplitTangents(const Eigen::MatrixXd& triples, GltfChannel& channel) {
  const Eigen::Index keys = triples.cols() / 3;
  channel.in_tangents.resize(triples.rows(), keys);
  channel.out_tangents.resize(triples.rows(), keys);
  channel.values.resize(triples.rows(), keys);
  for (Eigen::Index key = 0; key < keys; ++key) {
    channel.in_tangents.col(key) = triples.col(3 * key);
    channel.values.col(key) = triples.col(3 * key + 1);
    channel.out_tangents.col(key) = triples.col(3 * key + 2);
  }
}

// The keys of `channel`, whose node and path are known.
absl::Status ReadKeys(const json& animation, const json& channel_json,
                      GltfAccessors& accessors, GltfChannel& channel) {
  const auto sampler_index =
      ReadWhole(channel_json, "sampler", "channel", std::nullopt);
  if (!sampler_index.ok()) return sampler_index.status();
  const auto sampler = ObjectAt(animation, "samplers", *sampler_index);
  if (!sampler.ok()) return sampler.status();
  const std::string path = absl::StrCat("samplers[", *sampler_index, "]");
  const std::string name = StringOf(**sampler, "interpolation");
  const std::optional<Interpolation> interpolation = InterpolationOf(name);
  if (!interpolation) {
    return Fault(
        path + ".interpolation",
        absl::StrCat("want STEP, LINEAR or CUBICSPLINE, got ", QuotedId(name)));
  }
  channel.interpolation = *interpolation;
  const auto input = ReadWhole(**sampler, "input", path, std::nullopt);
  const auto output = ReadWhole(**sampler, "output", path, std::nullopt);
  if (!input.ok()) return input.status();
  if (!output.ok()) return output.status();
  const absl::StatusOr<Eigen::MatrixXd> times = accessors.Read(*input, 1);
  if (!times.ok()) return times.status();
  channel.times_s.assign(times->data(), times->data() + times->size());
  if (absl::Status status = CheckTimes(channel.times_s); !status.ok()) {
    return status;
  }
  absl::StatusOr<Eigen::MatrixXd> values =
      accessors.Read(*output, channel.path == GltfPath::kRotation ? 4 : 3);
  if (!values.ok()) return values.status();
  const bool is_cubic = *interpolation == Interpolation::kCubicSpline;
  const Eigen::Index want = times->cols() * (is_cubic ? 3 : 1);
  if (values->cols() != want) {
    return Fault(absl::StrCat("accessors[", *output, "].count"),
                 absl::StrFormat("want %d for %d keys, got %d", want,
                                 times->cols(), values->cols()));
  }
  if (!values->allFinite()) {
    return Fault(absl::StrCat("accessors[", *output, "]"),
                 "has a number that is not finite");
  }
  if (is_cubic) {
    SplitTangents(*values, channel);
  } else {
    channel.values = *std::move(values);
  }
  return absl::OkStatus();
}

absl::Status ReadChannel(const json& animation, const json& channel_json,
                         size_t node_count, GltfAccessors& accessors,
                         GltfAnimation& result) {
  const auto target = channel_json.find("target");
  if (target == channel_json.end() || !target->is_object()) {
    return Fault("target", "want an object");
  }
  const std::string path_name = StringOf(*target, "path");
  const std::optional<GltfPath> path = PathOf(path_name);
  // Weights move meshes; without a node an extension says what moves.
  if (path_name == "weights" || !target->contains("node")) {
    ++result.skipped_channels;
    return absl::OkStatus();
  }
  if (!path) {
    return Fault("target.path", absl::StrCat("got ", QuotedId(path_name)));
  }
  const auto node = ReadWhole(*target, "node", "target", std::nullopt);
  if (!node.ok()) return node.status();
  if (*node >= node_count) {
    return Fault("target.node", absl::StrFormat("want a node, 0 to %d, got %d",
                                                node_count - 1, *node));
  }
  GltfChannel channel;
  channel.node = static_cast<int>(*node);
  channel.path = *path;
  const absl::Status status =
      ReadKeys(animation, channel_json, accessors, channel);
  if (!status.ok()) return status;
  for (const GltfChannel& other : result.channels) {
    if (other.node == channel.node && other.path == channel.path) {
      return Fault("target", absl::StrFormat("node %d has such a channel "
                                             "already",
                                             channel.node));
    }
  }
  result.channels.push_back(std::move(channel));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<GltfAnimation>> ReadGltfAnimations(
    absl::string_view bytes, const GltfDocument& document,
    const OpenUri& open_uri, const GltfBounds& bounds) {
  const absl::StatusOr<json> root =
      ParseGltfJson(bytes, bounds, {kKeptAtTop, kKeptBelow});
  if (!root.ok()) return root.status();
  std::vector<GltfAnimation> animations;
  const auto list = root->find("animations");
  if (list == root->end()) return animations;
  if (!list->is_array()) return Fault("animations", "want an array");
  GltfAccessors accessors(*root, BinaryOfGltf(bytes), open_uri,
                          bounds.max_animation_numbers);
  Violations violations;
  for (size_t i = 0; i < list->size(); ++i) {
    const json& animation = (*list)[i];
    const std::string path = absl::StrCat("animations[", i, "]");
    GltfAnimation& result = animations.emplace_back();
    if (!animation.is_object() || !animation.contains("channels") ||
        !animation["channels"].is_array()) {
      violations.Add(path, "want an object with an array of channels");
      continue;
    }
    result.name = StringOf(animation, "name");
    const json& channels = animation["channels"];
    for (size_t k = 0; k < channels.size(); ++k) {
      const absl::Status status =
          channels[k].is_object()
              ? ReadChannel(animation, channels[k], document.nodes.size(),
                            accessors, result)
              : absl::InvalidArgumentError("want an object");
      violations.AddStatus(absl::StrCat(path, ".channels[", k, "]"), status);
    }
  }
  if (!violations.empty()) return violations.ToStatus();
  return animations;
}

}  // namespace gelenk
