/// Vectors at the corners of faces, and sums of their products. The terms of blend shapes are such sums
/// (blend_terms.h).
#ifndef CHRONORMAL_NORMALS_BLEND_BLEND_SUMS_H_
#define CHRONORMAL_NORMALS_BLEND_BLEND_SUMS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "core/rounding.h"
#include "core/vector_area.h"

namespace chronormal::inline internal {

/// The largest number of corners of a face whose vectors are stored in the object itself, not on the heap.
inline constexpr std::size_t kSmallFace = 4;

/// A vector for each corner of a face.
class CornerVectors {
 public:
  explicit CornerVectors(std::size_t count) : count_(count) {
    if (count > kSmallFace) many_.resize(count);
  }

  [[nodiscard]] Vec3d& operator[](std::size_t c) noexcept { return count_ > kSmallFace ? many_[c] : few_[c]; }
  [[nodiscard]] const Vec3d& operator[](std::size_t c) const noexcept {
    return count_ > kSmallFace ? many_[c] : few_[c];
  }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

 private:
  std::size_t count_;
  std::array<Vec3d, kSmallFace> few_;
  std::vector<Vec3d> many_;
};

[[nodiscard]] inline Vec3d vector_at(const float* v) { return {v[0], v[1], v[2]}; }

[[nodiscard]] inline CornerVectors positions_of(const BlendSet& set, std::span<const std::uint32_t> face) {
  CornerVectors positions(face.size());
  for (std::size_t c = 0; c < face.size(); ++c) positions[c] = vector_at(set.base.data() + 3 * std::size_t{face[c]});
  return positions;
}

/// A sum of cross products of edges, and a bound of its error.
class ProductSum {
 public:
  /// Adds B(p, q) of a face (blend_terms.h), for vectors p and q at its corners: over its fan, the edges of p from the
  /// first corner times the edges of q. The errors of the edges and of both products in a component come to at most 10
  /// u times the absolute products, where u = 2^-53. Each triangle adds a rounding. Four more roundings for each
  /// triangle are counted, because value() sets components to zero that may be only rounding error.
  void add(const CornerVectors& p, const CornerVectors& q) {
    struct Edge {
      Vec3d p, q;
    };
    const auto edge_to = [&](std::size_t c) { return Edge{p[c] - p[0], q[c] - q[0]}; };
    for_fan(p.size(), edge_to, [this](const Edge& e, const Edge& f) {
      sum_.add(cross(e.p, f.q));
      products_ += sum_abs(e.p) * sum_abs(f.q);
    });
    roundings_ += static_cast<double>(10 + 5 * p.size());
  }

  [[nodiscard]] Vec3d value() const { return sum_.without_rounding(); }
  [[nodiscard]] double noise() const { return kUnitRoundoff * roundings_ * products_; }

 private:
  VectorSum sum_;
  double products_ = 0, roundings_ = 0;
};

/// A sum over the faces around an element, and a bound of its error. Each face adds one rounding to the error. Four
/// more roundings for each face are counted, because value() sets components to zero that may be only rounding error.
class ElementSum {
 public:
  void add(const Vec3d& face, double noise) {
    sum_.add(face);
    noise_ += noise;
    size_ += sum_abs(face);
    ++count_;
  }

  [[nodiscard]] Vec3d value() const { return sum_.without_rounding(); }
  [[nodiscard]] double noise() const { return noise_ + 5 * kUnitRoundoff * count_ * size_; }

 private:
  VectorSum sum_;
  double noise_ = 0, size_ = 0, count_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_SUMS_H_
