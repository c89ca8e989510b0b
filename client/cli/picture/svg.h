// Writes SVG text, element by element.
//
// Lengths are in the picture's units, origin at the top left, y down; numbers
// are written with at most two decimals. Text and attributes are escaped.
#ifndef CLIENT_CLI_PICTURE_SVG_H_
#define CLIENT_CLI_PICTURE_SVG_H_

#include <Eigen/Core>
#include <string>

#include "absl/strings/string_view.h"
#include "absl/types/span.h"

namespace gelenk::cli {

// A place on the picture.
using Point = Eigen::Vector2d;

struct Box {
  double left = 0;
  double top = 0;
  double width = 0;
  double height = 0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
  Point center() const { return {left + width / 2, top + height / 2}; }
};

class Svg {
 public:
  Svg(double width, double height, absl::string_view title,
      absl::string_view style);

  // Looks come from classes of `style`.
  void OpenGroup(absl::string_view classes);
  void CloseGroup();
  void Line(const Point& from, const Point& to, absl::string_view classes);
  void Polyline(absl::Span<const Point> points, absl::string_view classes);
  // A closed area.
  void Polygon(absl::Span<const Point> points, absl::string_view classes);
  void Circle(const Point& center, double radius, absl::string_view classes);
  void Rectangle(const Box& box, double corner, absl::string_view classes);
  // `at` is on the base line: its start, middle or end by the class.
  void Text(const Point& at, absl::string_view text, absl::string_view classes);

  // Ends the picture; nothing may follow.
  std::string Finish() &&;

 private:
  void Open(absl::string_view element, absl::string_view classes);
  void Attribute(absl::string_view name, double value);

  std::string text_;
};

// `text` with & < > " replaced by entities, and what XML forbids by U+FFFD.
std::string EscapeXml(absl::string_view text);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_SVG_H_
