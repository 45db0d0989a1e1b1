// Computes the figures of the paper for one face: the normal of each scheme, and the intermediate points.
#include "workflow/compare/face_figure.h"

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include "chronormal/analysis/quality.h"
#include "chronormal/core/views.h"
#include "chronormal/workflow/compare.h"
#include "core/charconv.h"
#include "core/text.h"
#include "motion/segment_end.h"
#include "schemes/arc.h"
#include "schemes/frames.h"

namespace chronormal::inline internal {
namespace {

constexpr std::string_view kQuaternion = "quaternion:", kRandom = "quaternion:random";

// Returns the vector that a scheme computes at t, before it is normalized: the weighted sum of its coefficients.
Vec3d sum_at(const FittedCurves& fitted, double t) {
  const WeightBasis& basis = *fitted.basis;
  const ElementCoefficients coefficients = coefficients_of(fitted.coefficients, 0);
  Vec3d sum;
  for (std::size_t k = 0; k < basis.count(); ++k) {
    WeightBasis::Coefficients weight = basis.weight(k);
    const std::span<double> bernstein = std::span(weight).first(basis.degree() + 1);
    keep_after(bernstein, t);
    sum = sum + bernstein[0] * to_double(coefficients.vector(k));
  }
  return sum;
}

// Appends the points of all levels of de Casteljau's algorithm at t. `level` has the nodes, which are not appended.
void append_levels(std::vector<Vec3d> level, double t, std::vector<Vec3d>& points) {
  while (level.size() > 1) {
    for (std::size_t i = 0; i + 1 < level.size(); ++i)
      level[i] = unit(CircleFamily(level[i], level[i + 1]).great_arc().at(t));
    level.pop_back();
    points.insert(points.end(), level.begin(), level.end());
  }
}

// Returns the two frames between which a quaternion scheme interpolates, or nothing if the scheme used its fallback.
std::optional<FramePair> frames_of(std::string_view scheme, const ElementMotion& element) {
  if (scheme == "quaternion:matrix") return matrix_frames(element);
  if (scheme == "quaternion:edge") return edge_frames(element);
  if (scheme == "quaternion:polar") return polar_frames(element);
  std::uint64_t seed = 1;
  if (scheme.size() > kRandom.size()) {
    const std::string_view number = scheme.substr(kRandom.size() + 1);
    from_chars(number.data(), number.data() + number.size(), seed);
  }
  return random_frames(element, seed);
}

// Returns the tangents of the frames of a quaternion scheme at all times. The scheme quaternion:optimal allows any
// tangent, because all tangents turn with the same rotation and give the same normals. For this scheme, the tangent at
// t = 0 lies along the first edge.
std::vector<Vec3d> tangents_of(std::string_view scheme, const ElementMotion& element, const FittedCurves* fitted,
                               std::span<const double> times) {
  Vec3d start;
  Rotation rotation;
  if (scheme == "quaternion:optimal") {
    const auto frames = edge_frames(element);
    if (!frames || fitted == nullptr) return {};
    start = frames->at_start.tangent;
    const ElementCoefficients arc = coefficients_of(fitted->coefficients, 0);
    rotation = {unit(cross(to_double(arc.vector(1)), to_double(arc.vector(2)))), static_cast<double>(arc[9])};
  } else {
    const auto frames = frames_of(scheme, element);
    if (!frames) return {};
    start = frames->at_start.tangent;
    rotation = shorter_rotation(*frames);
  }
  const bool turns = rotation.axis != Vec3d{};
  const Arc arc = turns ? arc_about(rotation.axis, start, rotation.angle) : Arc{{}, start, {}, 0};
  std::vector<Vec3d> tangents;
  for (const double t : times) tangents.push_back(arc.at(t));
  return tangents;
}

// Returns the matrix M of the paper (eq. 8), which takes the face from t = 0 to t = 1. Its linear part is e1 e^0 + f1
// f^0 + u1 u^0, where e^0, f^0, u^0 is the dual basis of e0, f0, u0; e and f are edges, and u is the unit normal.
std::optional<std::array<std::array<double, 4>, 3>> matrix_of(const FaceFigure& figure, const ControlNormals& normals) {
  const auto edge = [&](std::size_t corner, std::size_t end) {
    return figure.corners[corner][end] - figure.corners[0][end];
  };
  const std::size_t last = figure.corners.size() - 1;
  const Vec3d u0 = unit(normals.n0), u1 = unit(normals.n1), e0 = edge(1, 0), f0 = edge(last, 0);
  const double volume = dot(u0, cross(e0, f0));
  if (!(std::fabs(volume) > 0) || u1 == Vec3d{}) return std::nullopt;
  const std::array<Vec3d, 3> dual = {cross(f0, u0), cross(u0, e0), cross(e0, f0)};
  const std::array<Vec3d, 3> images = {edge(1, 1), edge(last, 1), u1};
  std::array<std::array<double, 4>, 3> matrix{};
  const auto add_row = [&](std::size_t row, double Vec3d::*axis) {
    Vec3d linear;
    for (std::size_t k = 0; k < 3; ++k) linear = linear + (images[k].*axis / volume) * dual[k];
    matrix[row] = {linear.x, linear.y, linear.z, figure.corners[0][1].*axis - dot(linear, figure.corners[0][0])};
  };
  add_row(0, &Vec3d::x);
  add_row(1, &Vec3d::y);
  add_row(2, &Vec3d::z);
  return matrix;
}

SchemeFigure figure_of(const std::string& name, const ElementBlock& block, const FaceFigure& figure,
                       std::span<const Vec3d> exact) {
  SchemeFigure result;
  result.scheme = name;
  const auto scheme = make_scheme(name).value();
  scheme->prepare(block);
  const auto fitted = scheme->fitted_curves();
  const bool is_sum_of_known = fitted && fitted->basis;
  const bool is_de_casteljau = fitted && fitted->formula == Formula::kDeCasteljau;
  if (is_de_casteljau) {
    const ElementCoefficients coefficients = coefficients_of(fitted->coefficients, 0);
    for (std::size_t k = 0; 3 * k < fitted->coefficients.plane_count; ++k)
      result.nodes.push_back(to_double(coefficients.vector(k)));
  }
  if (name == "polynomial" || name == "recompute") result.lengths = figure.lengths;
  Quality quality;
  for (std::size_t i = 0; i < figure.times.size(); ++i) {
    const double t = figure.times[i];
    float normal[3];
    scheme->evaluate(t, VectorView<float>::packed(normal, 1));
    result.normals.push_back({normal[0], normal[1], normal[2]});
    Quality one;
    one.add(exact.subspan(i, 1), VectorView<const float>::packed(normal, 1), {figure.segment, figure.face, t});
    result.angles.push_back(one.count > 0 ? one.sum : std::numeric_limits<double>::quiet_NaN());
    quality.add(one);
    if (is_sum_of_known) result.lengths.push_back(length(sum_at(*fitted, t)));
    if (is_de_casteljau) append_levels(result.nodes, t, result.points);
  }
  result.sum = quality.sum;
  if (name.starts_with(kQuaternion))
    result.tangents = tangents_of(name, ElementMotion(block, 0), fitted.get(), figure.times);
  return result;
}

}  // namespace

Result<FaceFigure> face_figure(const Motion& motion, const FaceFigureOptions& options) {
  const auto misused = [](std::string message) { return Error{ErrorCode::kUsage, "", std::move(message)}; };
  if (options.segment >= motion.segments.size())
    return misused("there is no segment " + std::to_string(options.segment) +
                   "; choose another, since the motion has " + counted(motion.segments.size(), "segment", "segments") +
                   ", counted from 0");
  if (options.face >= motion.topology.face_count())
    return misused("there is no face " + std::to_string(options.face) + "; choose another, since the mesh has " +
                   counted(motion.topology.face_count(), "face", "faces") + ", counted from 0");
  if (options.samples < 2) return misused("the number of samples must be at least 2");
  const std::vector<std::string> names = options.schemes.empty() ? default_schemes() : options.schemes;
  for (const std::string& name : names) {
    if (const auto scheme = make_scheme(name); !scheme) return scheme.error();
  }

  const Segment segment = motion.segment(options.segment);
  FaceFigure figure;
  figure.face = options.face;
  figure.segment = options.segment;
  for (const std::uint32_t corner : motion.topology.face(options.face))
    figure.corners.push_back({SegmentEnd::from(segment)[corner], SegmentEnd::to(segment)[corner]});
  ControlNormals normals;
  face_control_normals(segment, {options.face, 1}, {&normals, 1});
  std::vector<Vec3d> exact(options.samples);
  for (std::size_t i = 0; i < options.samples; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(options.samples - 1);
    figure.times.push_back(t);
    reference_normals(segment, {options.face, 1}, t, std::span(exact).subspan(i, 1));
    figure.normals.push_back(unit_normal_at(normals, t).vector);
    figure.lengths.push_back(length(exact[i]));
  }
  figure.matrix = matrix_of(figure, normals);
  const ElementBlock block{&segment, {options.face, 1}, {&normals, 1}};
  for (const std::string& name : names) figure.schemes.push_back(figure_of(name, block, figure, exact));
  return figure;
}

}  // namespace chronormal::inline internal
