/// Computes the normals with which every benchmark is compared before it is timed. This oracle interpolates the
/// vertices and computes the normals by eq. 1 of docs/theory.md, all in double.
///
/// The oracle calls no code of the library, neither for vectors nor for control normals. Differences of float32
/// positions are exact in double up to the last bit. The direction of a normal therefore has an error of 1e-15 rad,
/// times the length of the edges divided by the height of the triangle.
#ifndef BENCH_MEASURE_ORACLE_H_
#define BENCH_MEASURE_ORACLE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "measure/meshes.h"

namespace chronormal::bench {

using Vector = std::array<double, 3>;

/// The rule by which the normals of the faces around a vertex are added up: weighted by the area of the face, or all
/// unit normals alike.
enum class Rule { kArea, kUniform };

/// Returns the angle between two vectors in radians, or pi if one of them is zero or NaN.
[[nodiscard]] double angle(const Vector& a, const Vector& b);

/// The angular errors of the approximate normals of many elements, in radians.
struct Errors {
  std::vector<double> sorted;

  [[nodiscard]] double mean() const;
  [[nodiscard]] double quantile(double share) const;
  [[nodiscard]] double max() const { return sorted.empty() ? 0 : sorted.back(); }
};

class Oracle {
 public:
  /// Takes a segment of triangles or polygons, which must outlive this object. Chooses all elements if there are at
  /// most 100,000 of them. Otherwise chooses 4,096 random elements, which are the same in every run.
  Oracle(const Segment& segment, Elements elements);

  [[nodiscard]] std::span<const std::uint32_t> elements() const { return elements_; }
  /// Returns n(t) of each chosen element, not normalised.
  [[nodiscard]] std::vector<Vector> normals(double t, Rule rule = Rule::kArea) const;
  /// Returns the angles in radians between n(t) and normal_of(element). Leaves out elements without a direction, for
  /// which |n(t)| is below 1e-7 of the areas of their faces.
  [[nodiscard]] Errors errors(double t, Rule rule, const std::function<Vector(std::size_t)>& normal_of) const;
  /// Returns the angles in radians between the given exact normals and normal_of(element). If the exact normals are
  /// sums weighted by area, leaves out elements whose sum almost vanishes and therefore has no direction.
  [[nodiscard]] Errors errors(std::span<const Vector> exact, const std::function<Vector(std::size_t)>& normal_of) const;

 private:
  [[nodiscard]] Vector face_normal(std::size_t face, double t) const;

  Segment segment_;
  Elements kind_;
  std::vector<std::uint32_t> elements_;
  // The faces whose normals are added up for each vertex, as pairs of an index into elements_ and a face.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> terms_;
  // For each element, the sum of |n| over the faces of the element and over both ends of the segment.
  std::vector<double> areas_;
};

}  // namespace chronormal::bench

#endif  // BENCH_MEASURE_ORACLE_H_
