#include "client/cli/picture/svg.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "gelenk/formats/unique_names.h"

namespace gelenk::cli {
namespace {

// Two decimals are a hundredth of a pixel.
std::string Number(double value) {
  const double rounded = std::round(value * 100) / 100;
  return absl::StrCat(rounded == 0 ? 0.0 : rounded);
}

std::string PointList(absl::Span<const Point> points) {
  std::string list;
  for (const Point& point : points) {
    absl::StrAppend(&list, list.empty() ? "" : " ", Number(point.x()), ",",
                    Number(point.y()));
  }
  return list;
}

}  // namespace

std::string EscapeXml(absl::string_view text) {
  return absl::StrReplaceAll(
      PrintableUtf8(text),
      {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

Svg::Svg(double width, double height, absl::string_view title,
         absl::string_view style) {
  const std::string w = Number(width);
  const std::string h = Number(height);
  absl::StrAppend(&text_,
                  "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" "
                  "viewBox=\"0 0 ",
                  w, " ", h, "\" width=\"", w, "\" height=\"", h, "\">\n");
  absl::StrAppend(&text_, "<title>", EscapeXml(title), "</title>\n<style>\n",
                  style, "</style>\n");
}

void Svg::Open(absl::string_view element, absl::string_view classes) {
  absl::StrAppend(&text_, "<", element);
  if (!classes.empty()) absl::StrAppend(&text_, " class=\"", classes, "\"");
}

void Svg::Attribute(absl::string_view name, double value) {
  absl::StrAppend(&text_, " ", name, "=\"", Number(value), "\"");
}

void Svg::OpenGroup(absl::string_view classes) {
  Open("g", classes);
  text_ += ">\n";
}

void Svg::CloseGroup() { text_ += "</g>\n"; }

void Svg::Line(const Point& from, const Point& to, absl::string_view classes) {
  Open("line", classes);
  Attribute("x1", from.x());
  Attribute("y1", from.y());
  Attribute("x2", to.x());
  Attribute("y2", to.y());
  text_ += "/>\n";
}

void Svg::Polyline(absl::Span<const Point> points, absl::string_view classes) {
  if (points.empty()) return;
  Open("polyline", classes);
  absl::StrAppend(&text_, " points=\"", PointList(points), "\"/>\n");
}

void Svg::Polygon(absl::Span<const Point> points, absl::string_view classes) {
  if (points.empty()) return;
  Open("polygon", classes);
  absl::StrAppend(&text_, " points=\"", PointList(points), "\"/>\n");
}

void Svg::Circle(const Point& center, double radius,
                 absl::string_view classes) {
  Open("circle", classes);
  Attribute("cx", center.x());
  Attribute("cy", center.y());
  Attribute("r", radius);
  text_ += "/>\n";
}

void Svg::Rectangle(const Box& box, double corner, absl::string_view classes) {
  Open("rect", classes);
  Attribute("x", box.left);
  Attribute("y", box.top);
  Attribute("width", box.width);
  Attribute("height", box.height);
  if (corner > 0) Attribute("rx", corner);
  text_ += "/>\n";
}

void Svg::Text(const Point& at, absl::string_view text,
               absl::string_view classes) {
  Open("text", classes);
  Attribute("x", at.x());
  Attribute("y", at.y());
  absl::StrAppend(&text_, ">", EscapeXml(text), "</text>\n");
}

std::string Svg::Finish() && {
  text_ += "</svg>\n";
  return std::move(text_);
}

}  // namespace gelenk::cli
