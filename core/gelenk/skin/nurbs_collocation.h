// The equations between a B-spline's net and its points.
#ifndef GELENK_SKIN_NURBS_COLLOCATION_H_
#define GELENK_SKIN_NURBS_COLLOCATION_H_

#include <Eigen/Core>
#include <vector>

#include "gelenk/skin/nurbs_surface.h"

namespace gelenk {

// points = matrix * net: functions of the columns, parameters of the rows.
Eigen::MatrixXd Collocation(const NurbsAxis& axis,
                            const std::vector<double>& parameters);

// The denominator at the Greville abscissae of both axes, in the order of the
// points.
std::vector<double> GrevilleWeights(const NurbsSurface& surface);

// Knots of the domain, each once.
std::vector<double> SpanEnds(const NurbsAxis& axis);

}  // namespace gelenk

#endif  // GELENK_SKIN_NURBS_COLLOCATION_H_
