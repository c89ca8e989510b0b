#include "client/cli/motion/quality_text.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

Json QualityJson(const MotionQuality& quality) {
  return {{"skate_cm_s", quality.skate.label_cm_s},
          {"skate_with_turning_cm_s", quality.skate.label_with_turning_cm_s},
          {"weighted_skate_cm_s", quality.skate.weighted_cm_s},
          {"rule_skate_cm_s", quality.skate.rule_cm_s},
          {"skate_m_per_contact_s", quality.skate.m_per_contact_s},
          {"contact_ratio", quality.skate.contact_ratio},
          {"penetration_max_m", quality.penetration.max_m},
          {"penetration_mean_m", quality.penetration.mean_m},
          {"hyper_extended_frames", quality.hyper_extended_frames},
          {"jerk_m_s3", quality.jerk_m_s3},
          {"largest_turn_deg", quality.largest_turn_deg}};
}

using Number = double (*)(const MotionQuality&);

struct Line {
  const char* name;
  Number number;
  int decimals;
};

constexpr Line kLines[] = {
    {"skate of planted points, cm/s",
     [](const MotionQuality& q) { return q.skate.label_cm_s; }, 2},
    {"weighted skate, cm/s",
     [](const MotionQuality& q) { return q.skate.weighted_cm_s; }, 2},
    {"skate of low, slow points, cm/s",
     [](const MotionQuality& q) { return q.skate.rule_cm_s; }, 2},
    {"slide, m a second of contact",
     [](const MotionQuality& q) { return q.skate.m_per_contact_s; }, 4},
    {"in contact, %",
     [](const MotionQuality& q) { return 100 * q.skate.contact_ratio; }, 1},
    {"penetration, greatest, mm",
     [](const MotionQuality& q) { return 1000 * q.penetration.max_m; }, 2},
    {"penetration, mean, mm",
     [](const MotionQuality& q) { return 1000 * q.penetration.mean_m; }, 2},
    {"hyper-extended frames of legs",
     [](const MotionQuality& q) { return double(q.hyper_extended_frames); }, 0},
    {"jerk, m/s^3", [](const MotionQuality& q) { return q.jerk_m_s3; }, 1},
    {"largest turn in a frame, degrees",
     [](const MotionQuality& q) { return q.largest_turn_deg; }, 2}};

}  // namespace

std::string MeasuredText(const MeasuredMotion& measured) {
  std::vector<Column> columns = {{""}, {"motion", Align::kRight}};
  if (measured.source) columns.push_back({"source", Align::kRight});
  Table table(columns);
  for (const Line& line : kLines) {
    std::vector<std::string> row = {
        line.name, Fixed(line.number(measured.quality), line.decimals)};
    if (measured.source) {
      row.push_back(Fixed(line.number(*measured.source), line.decimals));
    }
    table.AddRow(row);
  }
  if (!measured.comparison) return table.ToString();
  const MotionComparison& beside = *measured.comparison;
  Facts facts;
  facts.Add("skate by leg length, of the source's",
            Fixed(beside.label_skate_ratio, 3));
  facts.Add("skate of low, slow points, of the source's",
            Fixed(beside.rule_skate_ratio, 3));
  facts.Add("jerk, of the source's", Fixed(beside.jerk_ratio, 3));
  facts.Add("new hyper-extended frames",
            absl::StrCat(beside.new_hyper_extended_frames));
  facts.Add("largest extra turn in a frame, degrees",
            Fixed(beside.largest_extra_turn_deg, 2));
  return absl::StrCat(table.ToString(), "\n", facts.ToString());
}

Json MeasuredJson(const MeasuredMotion& measured) {
  Json json = QualityJson(measured.quality);
  if (measured.source) json["source"] = QualityJson(*measured.source);
  if (measured.comparison) {
    const MotionComparison& beside = *measured.comparison;
    json["beside_source"] = {
        {"skate_ratio", beside.label_skate_ratio},
        {"rule_skate_ratio", beside.rule_skate_ratio},
        {"jerk_ratio", beside.jerk_ratio},
        {"new_hyper_extended_frames", beside.new_hyper_extended_frames},
        {"largest_extra_turn_deg", beside.largest_extra_turn_deg}};
  }
  return json;
}

}  // namespace gelenk::cli
