// The control normals of elements on curved paths, with a bound of what rounding did to them.
//
// An edge is a difference of two control positions, rounded once. A component of a cross product of two edges e and f
// is two products of three roundings each and their difference: within 8 u M, M = max |e| max |f|. Its share of a
// control normal is rounded once and multiplied, 4 u M, and at most four of them are added up, 8 u of the sum of the
// shares of M. So a triangle is within 20 u of that sum, and a fan of polygons adds 2 u for each corner;
// polynomial_face_normals() takes a control normal for zero that is not above 32 u for each corner of it. The bound is
// twice that.
#include <algorithm>
#include <cassert>
#include <cstdint>

#include "chronormal/analysis/certify.h"
#include "core/rounding.h"
#include "core/vector_area.h"

namespace chronormal {

PathTruth path_truth(const PolynomialSegment<3>& path, IndexRange faces) {
  PathTruth truth{std::vector<PolynomialNormals<3>>(faces.count), std::vector<PathErrors>(faces.count)};
  polynomial_face_normals(path, faces, std::span(truth.normals));
  for (std::size_t i = 0; i < faces.count; ++i) {
    const auto face = path.topology->face(faces.first + i);
    const auto is_at = [&path](std::uint32_t a, std::uint32_t b) {
      return std::all_of(path.control.begin(), path.control.end(), [=](const auto& p) { return p[a] == p[b]; });
    };
    struct Edge {
      std::uint32_t to;
      Bernstein<double, 3> sizes;
    };
    const auto edge_to = [&](std::size_t c) {
      Edge edge{face[c], {}};
      for (std::size_t k = 0; k < edge.sizes.size(); ++k)
        edge.sizes[k] = max_abs(path.control[k][face[c]] - path.control[k][face[0]]);
      return edge;
    };
    PathErrors& error = truth.errors[i];
    error = {};
    for_fan(face.size(), edge_to, [&](const Edge& e, const Edge& f) {
      if (is_at(e.to, f.to)) return;  // there is no area, and nothing is rounded
      const auto products = multiply(e.sizes, f.sizes);
      for (std::size_t k = 0; k < error.size(); ++k) error[k] += products[k];
    });
    for (double& e : error) e *= 2 * 32 * kUnitRoundoff * static_cast<double>(face.size()) * (1 + 0x1p-40);
  }
  return truth;
}

PathTruth path_truth(const NormalGroups& groups, const PathTruth& of_faces, IndexRange elements) {
  PathTruth truth{std::vector<PolynomialNormals<3>>(elements.count), std::vector<PathErrors>(elements.count)};
  polynomial_group_normals<3>(groups, of_faces.normals, elements, truth.normals);
  for (std::size_t i = 0; i < elements.count; ++i) {
    for (std::size_t k = 0; k < truth.errors[i].size(); ++k) {
      VectorSum sum;
      double errors = 0;
      for (const std::uint32_t f : groups.faces(elements.first + i)) {
        sum.add(of_faces.normals[f][k]);
        errors += of_faces.errors[f][k];
      }
      truth.errors[i][k] = (1 + 0x1p-40) * (errors + sum.error());
    }
  }
  return truth;
}

}  // namespace chronormal
