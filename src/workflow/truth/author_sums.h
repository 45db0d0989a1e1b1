/// The sums of face normals that an author's normals follow. Private to workflow.
///
/// An authoring tool adds up the normals of *polygons* around a vertex, and weights them in its own way. A glTF file
/// has triangles, in the order in which the polygons were cut:
///
///     quad         (a, b, c), (a, c, d)     consecutive; corners 0 and 2 of the first triangle are corners
///                                           0 and 1 of the second
///     larger       any number of consecutive triangles, in whatever order, that fill an outline with no vertex inside
///
/// Only pairs in this order become quads, because two triangles that share any other edge are often halves of two
/// neighbouring quads. An element adds up either the faces whose corners show its normal, or all faces around its
/// point: some tools give the corners of flat faces their own normal, but still count these faces for the other
/// corners.
///
/// author_rule.h compares these sums with the normals that the file stores, and takes the sum that fits them best.
///
/// Shapes     elements are those of GltfShading; positions are those of all its vertices
/// Threads    const functions may run at once
#ifndef CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_SUMS_H_
#define CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_SUMS_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/weighting.h"
#include "core/blocks.h"
#include "core/rounding.h"
#include "workflow/shading/corner_terms.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// A weighted sum of face normals, with the lengths of its terms and of the face normals.
struct AuthorSum {
  Vec3d normal;
  double terms = 0;  ///< the sum of the lengths of its terms
  double areas = 0;  ///< the sum of the lengths of its face normals, each twice the area of the face

  /// Returns a vector with the direction of the sum. Its length is the sum of the lengths of the face normals, as in a
  /// sum by area whose faces all have one direction. If the terms cancel so far that the sum is shorter than a
  /// twentieth of `terms`, the length becomes smaller, and reaches zero with the sum.
  [[nodiscard]] Vec3d with_area_length() const noexcept {
    constexpr double kLost = 0.05;
    const double size = length(normal);
    return size > 0 ? (areas / std::fmax(size, kLost * terms)) * normal : Vec3d{};
  }
};

/// The author's polygons, rebuilt from the triangles of the file.
class Polygons {
 public:
  explicit Polygons(const Topology& triangles);

  /// Joins `count` triangles from `first` on to one polygon. Each other polygon that contains one of these triangles is
  /// taken apart, and its other triangles become single. Returns false, and changes nothing, if the outline of the
  /// triangles is not a polygon around all of their vertices.
  bool join(std::size_t first, std::size_t count);
  /// Joins each pair of consecutive triangles that looks like a cut quad (see above) to a quad. Both triangles must be
  /// in the same part of the mesh. Returns the number of quads.
  std::size_t join_quads(std::span<const GltfPart> parts);

  /// Returns the polygon to which a triangle belongs. A polygon has the index of its first triangle.
  [[nodiscard]] std::uint32_t of_triangle(std::size_t triangle) const noexcept {
    return first_.empty() ? static_cast<std::uint32_t>(triangle) : first_[triangle];
  }
  /// Returns the number of triangles of a polygon, given the index of its first triangle.
  [[nodiscard]] std::size_t triangle_count(std::size_t polygon) const noexcept {
    return count_.empty() ? 1 : count_[polygon];
  }
  /// Returns the vertices of a polygon, in order around it.
  [[nodiscard]] std::span<const std::uint32_t> corners(std::size_t polygon) const noexcept;
  /// Returns true if any polygon is larger than a triangle.
  [[nodiscard]] bool any_joined() const noexcept { return joined_ > 0; }

 private:
  void take_apart(std::size_t polygon);

  const Topology* triangles_;
  // The lists below are empty until triangles are joined. first_ has for each triangle the first triangle of its
  // polygon. count_ has, at the index of this first triangle, the number of triangles in the polygon.
  std::vector<std::uint32_t> first_, count_;
  // loop_of_ has, at the index of the first triangle of each larger polygon, the place in loops_ at which the corners
  // of this polygon begin.
  std::vector<std::uint32_t> loop_of_;
  std::vector<std::uint32_t> loops_;  // corners of larger polygons; each has two more corners than triangles
  std::size_t joined_ = 0;
};

/// The sums of face normals of all elements. Lists, for each element, the corners of polygons whose normals the element
/// adds up.
class AuthorSums {
 public:
  AuthorSums() = default;
  /// Prepares sums over the corners that show an element's normal. For elements that are true in `whole_point`,
  /// prepares sums over all corners at their points instead. If `wanted` is not empty, elements that are false in
  /// `wanted` get no corners.
  AuthorSums(const GltfShading& shading, const Polygons& polygons, Weighting weighting,
             const std::vector<bool>& whole_point, const std::vector<bool>& wanted = {});

  [[nodiscard]] Weighting weighting() const noexcept { return weighting_; }

  /// Returns the sum of face normals of an element. position(vertex) must return the position of a vertex. If the sum
  /// is not larger than its rounding error, returns zero.
  template <class PositionOf>
  [[nodiscard]] AuthorSum at(std::uint32_t element, const PositionOf& position) const {
    return at(element, position, weighting_);
  }
  template <class PositionOf>
  [[nodiscard]] AuthorSum at(std::uint32_t element, const PositionOf& position, Weighting weighting) const {
    AuthorSum result;
    for_each(
        std::span(&element, 1), position, [&](std::size_t, const AuthorSum& sum) { result = sum; }, weighting);
    return result;
  }

  /// Calls visit(i, sum) for the i-th of the given elements, in order. visit() must not compute sums itself. One call
  /// for about kElementsOfBlock elements takes a fraction of the time of a call of at() for each of these elements.
  template <class PositionOf, class Visit>
  void for_each(std::span<const std::uint32_t> elements, const PositionOf& position, const Visit& visit) const {
    for_each(elements, position, visit, weighting_);
  }
  template <class PositionOf, class Visit>
  void for_each(std::span<const std::uint32_t> elements, const PositionOf& position, const Visit& visit,
                Weighting weighting) const {
    constexpr double kRounding = 1e-13;
    CornerTerms& corners = CornerTerms::emptied(weighting);
    for (const std::uint32_t e : elements)
      for_corners(e, [&](std::uint32_t p, std::uint32_t corner) { corners.add(p, polygon(p), corner, position); });
    corners.finish();
    std::size_t next = 0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      AuthorSum sum;
      for (const std::size_t end = next + offsets_[elements[i] + 1] - offsets_[elements[i]]; next < end; ++next) {
        sum.normal = sum.normal + corners.terms()[next];
        sum.terms += corners.lengths()[next];
        sum.areas += corners.area(next);
      }
      sum.normal = without_rounding(sum.normal, kRounding * sum.terms);
      visit(i, sum);
    }
  }

  /// Calls visit(element, sum) for all elements, on all cores.
  template <class PositionOf, class Visit>
  void for_all(const PositionOf& position, const Visit& visit) const {
    parallel_blocks(offsets_.size() - 1, kElementsOfBlock, [&](IndexRange range) {
      std::array<std::uint32_t, kElementsOfBlock> elements;
      const std::span<std::uint32_t> block = std::span(elements).first(range.count);
      std::iota(block.begin(), block.end(), static_cast<std::uint32_t>(range.first));
      for_each(block, position, [&](std::size_t i, const AuthorSum& sum) { visit(block[i], sum); });
    });
  }

  /// Returns the number of polygons that have a corner in some sum. polygon(p) returns the vertices around one of these
  /// polygons. Polygons are in the order of their triangles.
  [[nodiscard]] std::size_t polygon_count() const noexcept { return loop_offsets_.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> polygon(std::size_t p) const noexcept {
    return {loops_.data() + loop_offsets_[p], loops_.data() + loop_offsets_[p + 1]};
  }

  /// Calls visit(polygon, corner) for the corners that an element adds up.
  template <class Visit>
  void for_corners(std::uint32_t element, const Visit& visit) const {
    for (std::uint32_t i = offsets_[element]; i < offsets_[element + 1]; ++i) visit(sums_[i].polygon, sums_[i].corner);
  }

  /// Calls visit(from, to) for the two edges at each corner that an element adds up. Edges are pairs of vertices.
  template <class Visit>
  void for_edges(std::uint32_t element, const Visit& visit) const {
    for (std::uint32_t i = offsets_[element]; i < offsets_[element + 1]; ++i) {
      const std::span<const std::uint32_t> loop = polygon(sums_[i].polygon);
      const std::size_t c = sums_[i].corner, last = loop.size() - 1;
      visit(loop[c], loop[c == last ? 0 : c + 1]);
      visit(loop[c], loop[c == 0 ? last : c - 1]);
    }
  }

  /// Calls visit(vertex) for the vertices whose positions an element needs. Some vertices are visited more than once.
  template <class Visit>
  void for_vertices(std::uint32_t element, const Visit& visit) const {
    for (std::uint32_t i = offsets_[element]; i < offsets_[element + 1]; ++i)
      for (const std::uint32_t v : polygon(sums_[i].polygon)) visit(v);
  }

  /// Marks the elements whose sums need the position of any of the marked vertices.
  [[nodiscard]] std::vector<bool> elements_around(const std::vector<bool>& vertices) const;

 private:
  struct Corner {
    std::uint32_t polygon = 0, corner = 0;
  };

  Weighting weighting_ = Weighting::kArea;
  std::vector<std::uint32_t> loop_offsets_ = {0}, loops_;  // the vertices of all polygons
  std::vector<std::uint32_t> offsets_ = {0};               // for each element, its range in sums_
  std::vector<Corner> sums_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_SUMS_H_
