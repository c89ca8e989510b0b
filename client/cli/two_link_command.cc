// gelenk two-link, gelenk two-bone: closed-form solutions.
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/picture/two_link_picture.h"
#include "client/cli/service.h"
#include "client/cli/text/number_list.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

struct TwoLinkOptions {
  v1::SolveTwoLinkRequest request;
  std::string picture_path;
  Format format = Format::kTable;
};

// `count` numbers as one argument. They were checked when they were parsed.
template <class Take>
CLI::Option* AddNumbers(CLI::App& app, const std::string& name, int count,
                        const std::string& text, const std::string& description,
                        Take take) {
  return app
      .add_option_function<std::string>(
          name,
          [count, take](const std::string& list) {
            take(ParseNumbers(list, count).value());
          },
          description)
      ->check(Parses([count](const std::string& list) {
        return ParseNumbers(list, count);
      }))
      ->option_text(text);
}

void SetPoint(const std::vector<double>& numbers, v1::Vector3* point) {
  point->set_x(numbers[0]);
  point->set_y(numbers[1]);
  point->set_z(numbers.size() > 2 ? numbers[2] : 0);
}

std::string PointText(const v1::Vector3& point) {
  return absl::StrCat(Fixed(point.x(), 9), " ", Fixed(point.y(), 9), " ",
                      Fixed(point.z(), 9));
}

Json PointJson(const v1::Vector3& point) {
  return {point.x(), point.y(), point.z()};
}

std::string TurnText(const v1::Quaternion& turn) {
  return absl::StrCat(Fixed(turn.x(), 9), " ", Fixed(turn.y(), 9), " ",
                      Fixed(turn.z(), 9), " ", Fixed(turn.w(), 9));
}

Json TurnJson(const v1::Quaternion& turn) {
  return {turn.x(), turn.y(), turn.z(), turn.w()};
}

std::string SolutionsText(const v1::SolveTwoLinkResponse& response) {
  const bool planar = response.solutions_size() > 0 &&
                      response.solutions(0).angles_rad_size() == 2;
  Table table(
      planar ? std::vector<Column>{{"solution"},
                                   {"phi 1 rad", Align::kRight},
                                   {"phi 2 rad", Align::kRight},
                                   {"middle m", Align::kRight},
                                   {"tip m", Align::kRight},
                                   {""}}
             : std::vector<Column>{{"solution"},
                                   {"turn of the upper bone", Align::kRight},
                                   {"turn of the lower bone", Align::kRight},
                                   {"middle m", Align::kRight},
                                   {"tip m", Align::kRight},
                                   {""}});
  for (int i = 0; i < response.solutions_size(); ++i) {
    const v1::TwoLinkSolution& solution = response.solutions(i);
    std::string remark = i == response.best() ? "best" : "";
    if (!solution.within_limits()) {
      absl::StrAppend(&remark, remark.empty() ? "" : ", ", "outside limits");
    }
    table.AddRow({absl::StrCat(i + 1),
                  planar ? Fixed(solution.angles_rad(0), 12)
                         : TurnText(solution.world_root_rotation()),
                  planar ? Fixed(solution.angles_rad(1), 12)
                         : TurnText(solution.world_mid_rotation()),
                  PointText(solution.world_mid()),
                  PointText(solution.world_tip()), remark});
  }
  Facts facts;
  facts.Add("reach",
            absl::StrCat(Significant(response.min_reach_m(), 9), " to ",
                         Significant(response.max_reach_m(), 9), " m"));
  facts.Add("target",
            response.unreachable()
                ? absl::StrCat("out of reach by ",
                               Significant(response.distance_m(), 9), " m")
                : absl::StrCat("met within ",
                               Significant(response.distance_m(), 3), " m"));
  if (response.stretch() > 1) {
    facts.Add("stretched by", Significant(response.stretch(), 9));
  }
  return table.ToString() + facts.ToString();
}

Json SolutionsJson(const v1::SolveTwoLinkResponse& response) {
  Json solutions = Json::array();
  for (const v1::TwoLinkSolution& solution : response.solutions()) {
    Json json;
    if (solution.angles_rad_size() == 2) {
      json["angles_rad"] = {solution.angles_rad(0), solution.angles_rad(1)};
      json["change_rad"] = solution.change_rad();
    } else {
      json["world_root_rotation_xyzw"] =
          TurnJson(solution.world_root_rotation());
      json["world_mid_rotation_xyzw"] = TurnJson(solution.world_mid_rotation());
    }
    json["world_mid_m"] = PointJson(solution.world_mid());
    json["world_tip_m"] = PointJson(solution.world_tip());
    json["within_limits"] = solution.within_limits();
    solutions.push_back(std::move(json));
  }
  return {{"solutions", solutions},
          {"best", response.best()},
          {"unreachable", response.unreachable()},
          {"distance_m", response.distance_m()},
          {"min_reach_m", response.min_reach_m()},
          {"max_reach_m", response.max_reach_m()},
          {"stretch", response.stretch()}};
}

absl::Status RunTwoLink(const TwoLinkOptions& options,
                        const GlobalOptions& globals, std::string* output) {
  const auto service = Service::Open(globals.server);
  if (!service.ok()) return service.status();
  const auto response = (*service)->connection()->Call(
      &v1::KinematicsService::Stub::SolveTwoLink, options.request);
  if (!response.ok()) return response.status();
  *output += options.format == Format::kJson
                 ? JsonText(SolutionsJson(*response))
                 : SolutionsText(*response);
  if (options.picture_path.empty()) return absl::OkStatus();
  return WriteFile(options.picture_path,
                   TwoLinkPictureSvg(options.request.planar(), *response));
}

Command CommandOf(CLI::App* app, std::shared_ptr<TwoLinkOptions> options) {
  AddFormatOption(*app, &options->format);
  return {app, [options](const GlobalOptions& globals, std::string* output) {
            return RunTwoLink(*options, globals, output);
          }};
}

}  // namespace

Command AddTwoLinkCommand(CLI::App& app) {
  auto options = std::make_shared<TwoLinkOptions>();
  v1::PlanarTwoLink* limb = options->request.mutable_planar();
  CLI::App* two_link = app.add_subcommand(
      "two-link", "Both closed-form solutions of two links in the plane");
  AddNumbers(*two_link, "--lengths", 2, "L1,L2", "Of the links, m",
             [limb](const std::vector<double>& lengths) {
               limb->set_upper_length_m(lengths[0]);
               limb->set_lower_length_m(lengths[1]);
             })
      ->required();
  AddNumbers(*two_link, "--target", 2, "X,Y", "Where the tip shall be, m",
             [limb](const std::vector<double>& point) {
               SetPoint(point, limb->mutable_target());
             })
      ->required();
  AddNumbers(*two_link, "--base", 2, "X,Y", "The first joint, m; default 0,0",
             [limb](const std::vector<double>& point) {
               SetPoint(point, limb->mutable_base());
             });
  AddNumbers(*two_link, "--current", 2, "PHI1,PHI2",
             "The angles now, rad: picks among equals",
             [limb](const std::vector<double>& angles) {
               limb->mutable_current_angles_rad()->Assign(angles.begin(),
                                                          angles.end());
             });
  AddNumbers(*two_link, "--limits", 4, "LO1,HI1,LO2,HI2",
             "Of the angles, rad; default none",
             [limb](const std::vector<double>& numbers) {
               for (int joint = 0; joint < 2; ++joint) {
                 v1::JointLimits& limits = *limb->add_limits();
                 limits.add_lower(numbers[2 * joint]);
                 limits.add_upper(numbers[2 * joint + 1]);
               }
             });
  two_link
      ->add_option("--picture", options->picture_path,
                   "Draw reach, target and solutions")
      ->check(EndsWith({".svg"}))
      ->option_text("FILE.svg");
  two_link->footer("Example:\n  gelenk two-link --lengths 10,10 --target 10,0");
  return CommandOf(two_link, options);
}

Command AddTwoBoneCommand(CLI::App& app) {
  auto options = std::make_shared<TwoLinkOptions>();
  v1::TwoBoneLimb* limb = options->request.mutable_two_bone();
  CLI::App* two_bone = app.add_subcommand(
      "two-bone",
      "A limb of two bones in space: hip, knee, ankle; shoulder, elbow, wrist");
  struct PointOption {
    const char* name;
    const char* description;
    v1::Vector3* point;
  };
  for (const PointOption& option :
       {PointOption{"--root", "The first joint at rest, m",
                    limb->mutable_world_root()},
        PointOption{"--mid", "The middle joint at rest, m",
                    limb->mutable_world_mid()},
        PointOption{"--tip", "The tip at rest, m", limb->mutable_world_tip()},
        PointOption{"--target", "Where the tip shall be, m",
                    limb->mutable_world_target()}}) {
    AddNumbers(*two_bone, option.name, 3, "X,Y,Z", option.description,
               [point = option.point](const std::vector<double>& numbers) {
                 SetPoint(numbers, point);
               })
        ->required();
  }
  CLI::Option* pole = AddNumbers(
      *two_bone, "--pole", 3, "X,Y,Z", "The middle joint bends towards it, m",
      [limb](const std::vector<double>& numbers) {
        SetPoint(numbers, limb->mutable_world_pole());
      });
  AddNumbers(*two_bone, "--swivel", 1, "RAD",
             "Turn about the line from root to target, from where the rest's "
             "bend is carried, rad",
             [limb](const std::vector<double>& numbers) {
               limb->set_swivel_rad(numbers[0]);
             })
      ->excludes(pole);
  AddNumbers(*two_bone, "--soft", 1, "M",
             "The last part of the reach is approached softly, m",
             [limb](const std::vector<double>& numbers) {
               limb->set_soft_distance_m(numbers[0]);
             });
  AddNumbers(*two_bone, "--stretch", 1, "FACTOR",
             "Largest factor by which the bones may stretch",
             [limb](const std::vector<double>& numbers) {
               limb->set_max_stretch(numbers[0]);
             });
  two_bone->footer(
      "Example:\n  gelenk two-bone --root 0,1,0 --mid 0,0.5,0.05 --tip 0,0,0 "
      "--target 0.2,0.2,0.3 --pole 0,0.5,1");
  return CommandOf(two_bone, options);
}

}  // namespace gelenk::cli
