#include "client/cli/skin/selector_argument.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/cli/command.h"
#include "client/cli/text/number_list.h"

namespace gelenk::cli {
namespace {

void SetVector(const double* numbers, v1::Vector3* proto) {
  proto->set_x(numbers[0]);
  proto->set_y(numbers[1]);
  proto->set_z(numbers[2]);
}

// The numbers of an option, of a certain count.
absl::StatusOr<std::vector<double>> NumbersOf(absl::string_view option,
                                              const std::string& text,
                                              int count) {
  absl::StatusOr<std::vector<double>> numbers = ParseNumbers(text, count);
  if (numbers.ok()) return numbers;
  return absl::InvalidArgumentError(
      absl::StrCat(option, ": ", std::string(numbers.status().message())));
}

}  // namespace

absl::StatusOr<v1::VertexRuns> ParseVertexRuns(absl::string_view text) {
  std::vector<std::pair<int, int>> runs;  // first, last
  for (absl::string_view piece : absl::StrSplit(text, ',')) {
    const std::vector<absl::string_view> ends =
        absl::StrSplit(piece, absl::MaxSplits('-', 1));
    int first = 0, last = 0;
    if (!absl::SimpleAtoi(ends.front(), &first) ||
        !absl::SimpleAtoi(ends.back(), &last) || first < 0 || last < first) {
      return absl::InvalidArgumentError(
          absl::StrCat("want vertices such as 0-99,120, got \"", piece, "\""));
    }
    runs.emplace_back(first, last);
  }
  std::sort(runs.begin(), runs.end());
  v1::VertexRuns proto;
  int next = 0;
  for (const auto& [first, last] : runs) {
    const int start = std::max(first, next);
    if (last < start) continue;
    proto.add_starts(start);
    proto.add_lengths(last - start + 1);
    next = last + 1;
  }
  return proto;
}

void AddSelectorOptions(CLI::App& app, SelectorArguments* arguments) {
  CLI::Option_group* group =
      app.add_option_group("Selection", "Which vertices; m, at the bind pose");
  group->add_option("--ids", arguments->ids, "By number, from 0")
      ->check(
          Parses([](const std::string& text) { return ParseVertexRuns(text); }))
      ->option_text("0-99,120,...");
  group->add_option("--sphere", arguments->sphere, "Within R of a point")
      ->option_text("X,Y,Z,R");
  group->add_option("--box", arguments->box, "Between two corners")
      ->option_text("X,Y,Z,X,Y,Z");
  group
      ->add_option("--component", arguments->component,
                   "All that hangs together with a vertex")
      ->option_text("VERTEX");
  group
      ->add_option("--ray", arguments->ray,
                   "What a ray from a point meets first, and R around that "
                   "along the surface")
      ->option_text("X,Y,Z,DX,DY,DZ,R");
  group->require_option(0, 1);
}

absl::StatusOr<v1::VertexSelector> SelectorOf(
    const SelectorArguments& arguments) {
  v1::VertexSelector selector;
  if (!arguments.ids.empty()) {
    absl::StatusOr<v1::VertexRuns> runs = ParseVertexRuns(arguments.ids);
    if (!runs.ok()) return runs.status();
    *selector.mutable_vertices() = *std::move(runs);
  }
  if (!arguments.sphere.empty()) {
    const auto numbers = NumbersOf("--sphere", arguments.sphere, 4);
    if (!numbers.ok()) return numbers.status();
    SetVector(numbers->data(), selector.mutable_sphere()->mutable_center());
    selector.mutable_sphere()->set_radius_m((*numbers)[3]);
  }
  if (!arguments.box.empty()) {
    const auto numbers = NumbersOf("--box", arguments.box, 6);
    if (!numbers.ok()) return numbers.status();
    SetVector(numbers->data(), selector.mutable_box()->mutable_lowest());
    SetVector(numbers->data() + 3, selector.mutable_box()->mutable_highest());
  }
  if (arguments.component) {
    selector.set_component_vertex(*arguments.component);
  }
  if (!arguments.ray.empty()) {
    const auto numbers = NumbersOf("--ray", arguments.ray, 7);
    if (!numbers.ok()) return numbers.status();
    SetVector(numbers->data(), selector.mutable_ray()->mutable_origin());
    SetVector(numbers->data() + 3, selector.mutable_ray()->mutable_direction());
    selector.mutable_ray()->set_geodesic_radius_m((*numbers)[6]);
  }
  return selector;
}

}  // namespace gelenk::cli
