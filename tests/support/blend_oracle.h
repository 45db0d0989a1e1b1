/// Makes blend shapes for tests, and computes their normals from blended positions, in rational numbers or in long
/// double. The normal of a polygon is the sum of p_i x p_{i+1}. Unlike the library, this file uses neither fans of
/// triangles nor products of targets.
#ifndef CHRONORMAL_TESTS_SUPPORT_BLEND_ORACLE_H_
#define CHRONORMAL_TESTS_SUPPORT_BLEND_ORACLE_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "normals/blend/blend_normals.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference.h"

namespace chronormal::test {

/// Returns the name of a path, for messages.
[[nodiscard]] inline std::string_view name_of(BlendPath path) {
  switch (path) {
    case BlendPath::kTerms:
      return "terms";
    case BlendPath::kTouched:
      return "touched";
    case BlendPath::kWhole:
      return "whole";
  }
  return "";
}

struct BlendShapeOptions {
  std::size_t cells = 6;  ///< a bumpy sheet of cells x cells quads, some of which are cut into triangles
  std::size_t targets = 5;
  double reach = 0.35;  ///< each target moves the vertices within this distance of a random point; the sheet is 2 wide
  double size = 0.3;    ///< largest absolute value of a component of a delta
  double scale = 1;     ///< factor of all coordinates and deltas
  double offset = 0;    ///< added to the coordinates of the base, before they are scaled
};

/// Makes a sheet with targets. Each target moves the vertices around a point, and some targets move no vertex.
[[nodiscard]] inline BlendSet random_blend_set(std::uint64_t seed, const BlendShapeOptions& options = {}) {
  fixtures::Random random(seed);
  const std::size_t cells = options.cells;
  BlendSet set;
  const auto put = [&](std::vector<float>& to, const fixtures::Point& p) {
    for (const double c : p) to.push_back(static_cast<float>(options.scale * c));
  };
  std::vector<fixtures::Point> points;
  for (std::size_t j = 0; j <= cells; ++j) {
    for (std::size_t i = 0; i <= cells; ++i) {
      const auto at = [cells](std::size_t k) { return 2 * static_cast<double>(k) / static_cast<double>(cells) - 1; };
      const fixtures::Point bump = random.in_cube(0.1);
      points.push_back({options.offset + at(i) + bump[0], options.offset + at(j) + bump[1], options.offset + bump[2]});
      put(set.base, points.back());
    }
  }
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (std::size_t j = 0; j < cells; ++j) {
    for (std::size_t i = 0; i < cells; ++i) {
      const auto v = [&](std::size_t a, std::size_t b) {
        return static_cast<std::uint32_t>((j + b) * (cells + 1) + i + a);
      };
      if (random.below(3) > 0) {
        corners.insert(corners.end(), {v(0, 0), v(1, 0), v(1, 1), v(0, 1)});
      } else {
        corners.insert(corners.end(), {v(0, 0), v(1, 0), v(1, 1)});
        offsets.push_back(static_cast<std::uint32_t>(corners.size()));
        corners.insert(corners.end(), {v(0, 0), v(1, 1), v(0, 1)});
      }
      offsets.push_back(static_cast<std::uint32_t>(corners.size()));
    }
  }
  // The last vertex belongs to no face.
  put(set.base, {0, 0, 5});
  set.topology = fixtures::make_polygons(points.size() + 1, std::move(offsets), std::move(corners));
  for (std::size_t k = 0; k < options.targets; ++k) {
    BlendTarget target;
    const fixtures::Point& centre = points[random.below(points.size())];
    for (std::size_t v = 0; v < points.size(); ++v) {
      const double distance = std::hypot(points[v][0] - centre[0], points[v][1] - centre[1]);
      if (distance > options.reach || random.below(8) == 0) continue;
      target.vertices.push_back(static_cast<std::uint32_t>(v));
      put(target.deltas, random.in_cube(options.size));
    }
    set.targets.push_back(std::move(target));
  }
  return set;
}

/// Draws weights between -1 and 2 for `active` targets. The weights of all other targets are 0.
[[nodiscard]] inline std::vector<double> random_weights(std::uint64_t seed, std::size_t targets, std::size_t active) {
  fixtures::Random random(seed);
  std::vector<double> weights(targets);
  for (std::size_t done = 0; done < std::min(active, targets);) {
    double& weight = weights[random.below(targets)];
    if (weight != 0) continue;
    weight = random.uniform(-1, 2);
    ++done;
  }
  return weights;
}

/// Returns the list of faces of each element. If `groups` is nullptr, each face is an element.
[[nodiscard]] inline std::vector<std::vector<std::uint32_t>> faces_of_elements(const BlendSet& set,
                                                                               const NormalGroups* groups) {
  std::vector<std::vector<std::uint32_t>> result;
  if (groups == nullptr) {
    for (std::size_t f = 0; f < set.topology.face_count(); ++f) result.push_back({static_cast<std::uint32_t>(f)});
    return result;
  }
  for (std::size_t e = 0; e < groups->size(); ++e)
    result.emplace_back(groups->faces(e).begin(), groups->faces(e).end());
  return result;
}

[[nodiscard]] inline NormalGroups vertices_of(const BlendSet& set) {
  return NormalGroups::of_vertices(set.topology, separate_points(set.topology.vertex_count()));
}

/// Returns the value of the bilinear form B(p, q) of a face, where p and q have a vector for each vertex. At positions
/// p, the normal of the face is B(p, p).
template <class P, class Q>
[[nodiscard]] exact::Vector exact_form(std::span<const std::uint32_t> face, const P& p, const Q& q) {
  exact::Vector sum{0, 0, 0};
  for (std::size_t i = 0; i < face.size(); ++i) {
    const exact::Vector area = exact::cross(p[face[i]], q[face[(i + 1) % face.size()]]);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += area[k];
  }
  return sum;
}

using ExactPositions = std::vector<exact::Vector>;

[[nodiscard]] inline ExactPositions exact_base(const BlendSet& set) {
  ExactPositions result;
  for (std::size_t v = 0; v < set.topology.vertex_count(); ++v)
    result.push_back(exact::vector(set.base[3 * v], set.base[3 * v + 1], set.base[3 * v + 2]));
  return result;
}

[[nodiscard]] inline ExactPositions exact_deltas(const BlendSet& set, std::size_t k) {
  ExactPositions result(set.topology.vertex_count(), exact::Vector{0, 0, 0});
  const BlendTarget& target = set.targets[k];
  for (std::size_t n = 0; n < target.vertices.size(); ++n) {
    const float* const d = target.deltas.data() + 3 * n;
    result[target.vertices[n]] = exact::vector(d[0], d[1], d[2]);
  }
  return result;
}

/// Returns n(w), the normals of all elements at the given weights, without rounding.
[[nodiscard]] inline std::vector<exact::Vector> exact_normals(const BlendSet& set, const NormalGroups* groups,
                                                              std::span<const double> weights) {
  ExactPositions positions = exact_base(set);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const ExactPositions deltas = exact_deltas(set, k);
    for (std::size_t v = 0; v < positions.size(); ++v)
      for (std::size_t c = 0; c < 3; ++c) positions[v][c] += exact::Rational(weights[k]) * deltas[v][c];
  }
  std::vector<exact::Vector> result;
  for (const auto& faces : faces_of_elements(set, groups)) {
    exact::Vector sum{0, 0, 0};
    for (const std::uint32_t f : faces) {
      const exact::Vector n = exact_form(set.topology.face(f), positions, positions);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += n[c];
    }
    result.push_back(sum);
  }
  return result;
}

/// Returns the same normals as exact_normals(), in long double, for sets that are too large for rational numbers.
/// Computes the normal of each face from positions relative to one of its corners.
[[nodiscard]] inline std::vector<reference::Vector> real_normals(const BlendSet& set, const NormalGroups* groups,
                                                                 std::span<const double> weights) {
  std::vector<reference::Vector> positions;
  for (std::size_t v = 0; v < set.topology.vertex_count(); ++v)
    positions.push_back({set.base[3 * v], set.base[3 * v + 1], set.base[3 * v + 2]});
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const BlendTarget& target = set.targets[k];
    for (std::size_t n = 0; n < target.vertices.size(); ++n)
      for (std::size_t c = 0; c < 3; ++c)
        positions[target.vertices[n]][c] += reference::Real(weights[k]) * reference::Real(target.deltas[3 * n + c]);
  }
  std::vector<reference::Vector> of_faces;
  for (std::size_t f = 0; f < set.topology.face_count(); ++f) {
    const auto face = set.topology.face(f);
    reference::Vector sum{};
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto p = reference::subtract(positions[face[i]], positions[face[0]]);
      const auto q = reference::subtract(positions[face[(i + 1) % face.size()]], positions[face[0]]);
      sum = reference::add(sum, reference::cross(p, q));
    }
    of_faces.push_back(sum);
  }
  std::vector<reference::Vector> result;
  for (const auto& faces : faces_of_elements(set, groups)) {
    reference::Vector sum{};
    for (const std::uint32_t f : faces) sum = reference::add(sum, of_faces[f]);
    result.push_back(sum);
  }
  return result;
}

/// Tells for each element whether a target with a nonzero weight moves a corner of one of its faces.
[[nodiscard]] inline std::vector<bool> touched_elements(const BlendSet& set, const NormalGroups* groups,
                                                        std::span<const double> weights) {
  std::set<std::uint32_t> moved;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] != 0) moved.insert(set.targets[k].vertices.begin(), set.targets[k].vertices.end());
  }
  std::vector<bool> result;
  for (const auto& faces : faces_of_elements(set, groups)) {
    result.push_back(std::any_of(faces.begin(), faces.end(), [&](std::uint32_t f) {
      const auto face = set.topology.face(f);
      return std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return moved.count(v) > 0; });
    }));
  }
  return result;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_BLEND_ORACLE_H_
