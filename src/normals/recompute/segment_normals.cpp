#include "chronormal/normals/segment_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <utility>

#include "chronormal/normals/control_normals.h"
#include "motion/coherence.h"

namespace chronormal {
namespace {

// Where the data of a pass lie, by their size: in the cache of a core, in the shared one, in memory.
enum Level { kNear, kShared, kMemory };

// Nanoseconds, one for each level. Medians of one core of a Zen 5 server, meshes of 15 k, 45 k, 1 M and 10 M triangles
// in grid order and shuffled; see docs/benchmarks.md. What is added for polygons, and for a cache line that is far
// away, is the difference between two of them.
struct Row {
  std::array<double, 3> at;
};

// Recompute, faces: a triangle; the triangle of a polygon; a line of positions that was not at hand.
constexpr Row kRecomputeTriangle = {1.9, 2.0, 2.5}, kRecomputePolygon = {12.7, 12.9, 13.3};
constexpr Row kRecomputeMiss = {0.2, 0.64, 2.97};
// Recompute, groups: a triangle kept for its sum; a term of a sum; one that was not at hand.
constexpr Row kRecomputeKept = {2.1, 2.35, 2.75}, kRecomputeTerm = {0.55, 0.67, 0.7},
              kRecomputeTermMiss = {0.02, 1.6, 3.5};

// The same of preparing curves.
constexpr Row kPrepareTriangle = {4.5, 4.7, 5.6}, kPreparePolygon = {22, 22, 22}, kPrepareMiss = {0.7, 2.05, 4};
constexpr Row kPrepareKept = {5, 5.2, 6.2}, kPrepareTerm = {0.75, 0.83, 0.9}, kPrepareTermMiss = {1.1, 4.5, 16.4};
// For each byte of curves and scratch: memory that the system gives for the first time has to be cleared.
constexpr double kNewByte = 0.02;

// Evaluating curves: an element, and each byte read and written.
constexpr Row kEvaluate = {0.19, 0, 0}, kEvaluateByte = {0.0003, 0.0083, 0.0195};

constexpr double kResultBytes = 3 * sizeof(float);
constexpr double kPositionBytes = 6 * sizeof(float);  // of both ends
constexpr double kIndexBytes = sizeof(std::uint32_t);
constexpr double kTermBytes = 4 * sizeof(float);
constexpr double kFullMiss = 3;  // lines of a face of which no corner was at hand

Level level_of(double bytes) {
  if (bytes <= kModelledNearCache) return kNear;
  return bytes <= kModelledSharedCache ? kShared : kMemory;
}

double cost(const Row& row, Level level) { return row.at[level]; }

// Of a curve, between degrees: 16 to 36 where lengths are kept, 12 to 20 where there is tolerance.
double curve_bytes_of_element(double degree, double tolerance) {
  const bool is_exact = tolerance <= kExactTolerance;
  const double of_degree[] = {is_exact ? 16.0 : 12.0, is_exact ? 24.0 : 12.0, is_exact ? 36.0 : 20.0};
  const double low = std::clamp(std::floor(degree), 0.0, 1.0);
  const auto i = static_cast<std::size_t>(low);
  return of_degree[i] + (degree - low) * (of_degree[i + 1] - of_degree[i]);
}

// On a sample of faces.
double average_degree(const Segment& segment) {
  constexpr std::size_t kSamples = 64;
  const std::size_t faces = segment.topology->face_count(), samples = std::min(faces, kSamples);
  if (samples == 0) return 0;
  int sum = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    ControlNormals normals;
    face_control_normals(segment, {faces / samples * i, 1}, {&normals, 1});
    sum += degree(normals);
  }
  return sum / static_cast<double>(samples);
}

template <class... Values>
std::string text_of(const char* format, Values... values) {
  std::array<char, 256> text{};
  const int size = std::snprintf(text.data(), text.size(), format, values...);
  return {text.data(), std::min(static_cast<std::size_t>(std::max(size, 0)), text.size() - 1)};
}

std::string reason_of(const StrategyChoice& choice, const MeshShape& shape, const StrategyOptions& options,
                      double evaluations) {
  const std::string anew = options.float_recompute != nullptr ? "recompute in float32" : "recompute";
  const std::string name = choice.strategy == NormalStrategy::kPolynomial ? "polynomial" : anew;
  if (shape.elements == 0) return anew + ": there is nothing to do";
  if (options.forced) return name + std::string(" because it was asked for");
  const std::string costs =
      text_of("%.3g ns an element for %.6g evaluation%s, ", std::min(choice.polynomial_cost, choice.recompute_cost),
              evaluations, evaluations == 1 ? "" : "s");
  const double break_even =
      options.float_recompute != nullptr ? choice.costs.break_even_in_float32() : choice.costs.break_even();
  std::string reason = name + ": " + costs;
  if (choice.strategy == NormalStrategy::kPolynomial)
    reason.append(text_of("%.3g by %s", choice.recompute_cost, anew.c_str()));
  else
    reason.append(text_of("%.3g by polynomial", choice.polynomial_cost));
  if (std::isfinite(break_even))
    reason.append(text_of("; they are even at %.3g", break_even));
  else
    reason.append("; curves never pay here");
  return reason;
}

}  // namespace

std::string_view name_of(NormalStrategy strategy) noexcept {
  return strategy == NormalStrategy::kPolynomial ? "polynomial" : "recompute";
}

MeshShape shape_of(const Segment& segment) {
  const Topology& topology = *segment.topology;
  MeshShape shape;
  shape.elements = shape.faces = topology.face_count();
  shape.vertices = topology.vertex_count();
  if (shape.faces == 0) return shape;
  shape.triangles_per_face =
      static_cast<double>(topology.corner_count()) / static_cast<double>(topology.face_count()) - 2;
  shape.lines_per_face = lines_per_face(topology);
  shape.degree = average_degree(segment);
  return shape;
}

MeshShape shape_of(const Segment& segment, const NormalGroups& groups) {
  MeshShape shape = shape_of(segment);
  shape.elements = groups.size();
  if (shape.elements > 0) {
    shape.faces_per_element =
        static_cast<double>(segment.topology->corner_count()) / static_cast<double>(shape.elements);
  }
  return shape;
}

double StrategyCosts::break_even_with(double rival) const noexcept {
  return rival > evaluate ? prepare / (rival - evaluate) : std::numeric_limits<double>::infinity();
}

StrategyCosts model_costs(const MeshShape& shape, double tolerance) noexcept {
  StrategyCosts costs;
  if (shape.elements == 0) return costs;
  const auto elements = static_cast<double>(shape.elements), faces = static_cast<double>(shape.faces);
  const auto vertices = static_cast<double>(shape.vertices);
  const double corners = (shape.triangles_per_face + 2) * faces;
  const bool is_sum = shape.faces_per_element > 0, is_polygon = shape.triangles_per_face > 1;
  // In good order the lines at the rim of what was read last are no misses.
  const double misses = std::max(0.0, shape.lines_per_face - 0.5) / (kFullMiss - 0.5);

  // What is read in order comes at the pace of all of it; what is missed comes from where the array is.
  const double read = kPositionBytes * vertices + kIndexBytes * corners * (is_sum ? 2 : 1);
  const Level level = level_of(read + kResultBytes * elements);
  const Level level_of_positions = level_of(kPositionBytes * vertices), level_of_terms = level_of(kTermBytes * faces);
  const auto front_end = [&](const Row& triangle, const Row& polygon, const Row& miss) {
    return shape.triangles_per_face * cost(is_polygon ? polygon : triangle, level) +
           kFullMiss * misses * cost(miss, level_of_positions);
  };
  const auto sum_of = [&](double face, const Row& term, const Row& miss) {
    return faces / elements * face +
           shape.faces_per_element * (cost(term, level) + misses * cost(miss, level_of_terms));
  };
  if (is_sum) {
    costs.recompute =
        sum_of(front_end(kRecomputeKept, kRecomputePolygon, kRecomputeMiss), kRecomputeTerm, kRecomputeTermMiss);
    costs.prepare = sum_of(front_end(kPrepareKept, kPreparePolygon, kPrepareMiss), kPrepareTerm, kPrepareTermMiss);
  } else {
    costs.recompute = front_end(kRecomputeTriangle, kRecomputePolygon, kRecomputeMiss);
    costs.prepare = front_end(kPrepareTriangle, kPreparePolygon, kPrepareMiss);
  }

  const double kept = curve_bytes_of_element(shape.degree, tolerance);
  costs.curve_bytes = kept * elements;
  const double scratch = shape.lines_per_face > kScatteredLines ? kScatteredBytes * vertices / elements : 0;
  costs.prepare += kNewByte * (kept + scratch);
  const Level level_of_curves = level_of((kept + kResultBytes) * elements);
  costs.evaluate = cost(kEvaluate, level_of_curves) + cost(kEvaluateByte, level_of_curves) * (kept + kResultBytes);
  return costs;
}

StrategyChoice choose_strategy(const MeshShape& shape, const StrategyOptions& options) {
  // Written so that NaN counts as one.
  const double evaluations = options.evaluations > 1 ? options.evaluations : 1;
  StrategyChoice choice;
  choice.costs = model_costs(shape, options.tolerance);
  choice.polynomial_cost = choice.costs.prepare + evaluations * choice.costs.evaluate;
  const double anew = options.float_recompute != nullptr ? choice.costs.in_float32 : choice.costs.recompute;
  choice.recompute_cost = evaluations * anew;
  // Recompute where they are even: it keeps no curves. An infinite number asks for the cheaper evaluation.
  const bool is_cheaper =
      std::isfinite(evaluations) ? choice.polynomial_cost < choice.recompute_cost : choice.costs.evaluate < anew;
  choice.strategy = is_cheaper ? NormalStrategy::kPolynomial : NormalStrategy::kRecompute;
  if (options.forced) choice.strategy = *options.forced;
  choice.reason = reason_of(choice, shape, options, evaluations);
  return choice;
}

SegmentNormals::SegmentNormals(const Segment& segment, const StrategyOptions& options, Threads threads)
    : choice_(choose_strategy(shape_of(segment), options)) {
  if (choice_.strategy == NormalStrategy::kPolynomial)
    normals_ = NormalCurves::of_faces(segment, {.tolerance = options.tolerance}, threads);
  else if (options.float_recompute != nullptr)
    normals_ = InFloat32{options.float_recompute, segment};
  else
    normals_ = NormalRecompute(segment);
}

SegmentNormals::SegmentNormals(const Segment& segment, const NormalGroups& groups, const StrategyOptions& options,
                               Threads threads)
    : choice_(choose_strategy(shape_of(segment, groups), options)) {
  if (choice_.strategy == NormalStrategy::kPolynomial)
    normals_ = NormalCurves::of_groups(segment, groups, {.tolerance = options.tolerance}, threads);
  else if (options.float_recompute != nullptr)
    normals_ = InFloat32{options.float_recompute, segment};
  else
    normals_ = NormalRecompute(segment, groups);
}

std::size_t SegmentNormals::unit_normals(double t, VectorView<float> result, Threads threads) {
  return std::visit([&](auto& normals) { return normals.unit_normals(t, result, threads); }, normals_);
}

std::size_t SegmentNormals::size() const noexcept {
  if (const auto* const curves = std::get_if<NormalCurves>(&normals_)) return curves->size();
  if (const auto* const in_float32 = std::get_if<InFloat32>(&normals_)) return in_float32->size();
  return std::get_if<NormalRecompute>(&normals_)->size();
}

std::size_t SegmentNormals::bytes() const noexcept {
  if (const auto* const curves = std::get_if<NormalCurves>(&normals_)) return curves->bytes();
  if (const auto* const in_float32 = std::get_if<InFloat32>(&normals_)) return in_float32->bytes();
  return std::get_if<NormalRecompute>(&normals_)->bytes();
}

}  // namespace chronormal
