/// A sheet as an artist models it: quads, some hexagons, and some flat-shaded faces. The normal of a smooth point is
/// the sum of the normals of all polygons around the point, weighted by the angles at their corners. Some normals are
/// edited as if by hand, differently in each target, and some edited normals point to the back.
#ifndef CHRONORMAL_TESTS_SUPPORT_AUTHORED_MESH_H_
#define CHRONORMAL_TESTS_SUPPORT_AUTHORED_MESH_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "tests/support/fixtures.h"
#include "tests/support/long_vectors.h"
#include "tests/support/shaded_mesh.h"

namespace chronormal::test {

class AuthoredMesh {
 public:
  /// Makes a sheet of n x n points with three targets. The last target pulls the middle point up so far that all edges
  /// at this point are nearly parallel to its normal. `flat` is the share of polygons that are flat-shaded.
  AuthoredMesh(std::uint64_t seed, std::size_t n, double flat = 0.15) : random_(seed), n_(n), flat_(flat) {
    make_polygons();
    make_keys();
    for (const std::vector<Vector>& key : keys_) normals_.push_back(point_normals(key));
    bend();
    write();
  }

  [[nodiscard]] const ShadedMesh& mesh() const { return mesh_; }

 private:
  struct Polygon {
    std::vector<std::size_t> corners;  // in counterclockwise order
    std::vector<std::size_t> cut;      // triangles into which an exporter cuts the polygon
    bool is_flat = false;
  };

  [[nodiscard]] double around(double size) { return random_.uniform(-size, size); }
  [[nodiscard]] std::size_t middle() const { return n_ / 2 * n_ + n_ / 2; }
  // Tells whether a point is the middle point of the sheet or one of its neighbours.
  [[nodiscard]] bool is_near(std::size_t i, std::size_t j) const {
    const std::size_t m = n_ / 2;
    return i + 1 >= m && i <= m + 1 && j + 1 >= m && j <= m + 1;
  }

  void make_polygons() {
    for (std::size_t j = 0; j + 1 < n_; ++j) {
      for (std::size_t i = 0; i + 1 < n_; ++i) {
        const std::size_t a = j * n_ + i, b = a + n_;
        const double kind = random_.uniform(0, 1);
        const bool is_free = !is_near(i, j), is_flat = is_free && kind > 1 - flat_;
        if (is_free && !is_near(i + 1, j) && i + 2 < n_ && kind < 0.1) {
          polygons_.push_back({{a, a + 1, a + 2, b + 2, b + 1, b}, {5, 0, 1, 2, 3, 4, 5, 1, 2, 5, 2, 4}, is_flat});
          ++i;
        } else {
          polygons_.push_back({{a, a + 1, b + 1, b}, {0, 1, 2, 0, 2, 3}, is_flat});
        }
      }
    }
  }

  static Vector single(Real x, Real y, Real z) {
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  }

  void make_keys() {
    std::vector<Vector> base;
    for (std::size_t v = 0; v < n_ * n_; ++v) {
      const std::size_t i = v % n_, j = v / n_;
      base.push_back(single(static_cast<Real>(i), static_cast<Real>(j), is_near(i, j) ? 0 : around(0.4)));
    }
    keys_ = {base, base, base, base};
    for (const std::size_t k : {1U, 2U}) {
      for (Vector& p : keys_[k]) {
        const double x = around(0.25), y = around(0.25), z = around(0.7);
        p = single(p[0] + x, p[1] + y, p[2] + z);
      }
    }
    keys_[3][middle()][2] = 90;
  }

  [[nodiscard]] static Vector face_normal(const Polygon& polygon, const std::vector<Vector>& p) {
    Vector sum = {0, 0, 0};
    for (std::size_t i = 0; i < polygon.corners.size(); ++i)
      sum = plus(sum, crossed(p[polygon.corners[i]], p[polygon.corners[(i + 1) % polygon.corners.size()]]));
    return unit_of(sum);
  }

  // Returns the unit normals of all points. The normal of a point is the sum of the normals of the polygons around the
  // point, weighted by the angles of the polygons at the point.
  [[nodiscard]] std::vector<Vector> point_normals(const std::vector<Vector>& p) const {
    std::vector<Vector> sums(p.size(), Vector{0, 0, 0});
    for (const Polygon& polygon : polygons_) {
      const std::size_t count = polygon.corners.size();
      const Vector normal = face_normal(polygon, p);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t v = polygon.corners[i];
        const Vector e = plus(p[polygon.corners[(i + 1) % count]], p[v], -1),
                     f = plus(p[polygon.corners[(i + count - 1) % count]], p[v], -1);
        sums[v] = plus(sums[v], normal, std::atan2(length_of(crossed(e, f)), dotted(e, f)));
      }
    }
    for (Vector& sum : sums) sum = unit_of(sum);
    return sums;
  }

  void bend() {
    for (std::size_t v = 0; v < n_ * n_; ++v) {
      const bool is_bent = random_.uniform(0, 1) < 0.12 || v == middle(), is_turned = random_.uniform(0, 1) < 0.3;
      for (std::size_t k = 0; is_bent && k < normals_.size(); ++k) {
        const double x = around(0.25), y = around(0.25), z = around(0.25);
        const Vector bent = unit_of(plus(normals_[k][v], {x, y, z}));
        normals_[k][v] = is_turned ? Vector{-bent[0], -bent[1], -bent[2]} : bent;
      }
    }
  }

  // Adds a vertex at a point of the sheet, with its normals in the base and in each target. Returns the index of the
  // vertex.
  std::uint32_t add(std::size_t point, const std::vector<Vector>& normals) {
    const auto push = [](std::vector<float>& values, const Vector& v) {
      for (const Real c : v) values.push_back(static_cast<float>(c));
    };
    push(mesh_.positions, keys_[0][point]);
    push(mesh_.normals, normals[0]);
    mesh_.targets.resize(keys_.size() - 1);
    for (std::size_t k = 1; k < keys_.size(); ++k) {
      push(mesh_.targets[k - 1].positions, plus(keys_[k][point], keys_[0][point], -1));
      push(mesh_.targets[k - 1].normals, plus(normals[k], normals[0], -1));
    }
    return static_cast<std::uint32_t>(mesh_.vertices() - 1);
  }

  // Writes one vertex for each smooth point, and one vertex for each corner of a flat-shaded polygon.
  void write() {
    std::map<std::size_t, std::uint32_t> vertex_of;
    for (const Polygon& polygon : polygons_) {
      std::vector<std::uint32_t> own;
      for (const std::size_t point : polygon.corners) {
        const auto known = vertex_of.find(point);
        if (!polygon.is_flat && known != vertex_of.end()) {
          own.push_back(known->second);
          continue;
        }
        std::vector<Vector> normals;
        for (std::size_t k = 0; k < keys_.size(); ++k)
          normals.push_back(polygon.is_flat ? face_normal(polygon, keys_[k]) : normals_[k][point]);
        own.push_back(add(point, normals));
        if (!polygon.is_flat) vertex_of[point] = own.back();
      }
      for (const std::size_t i : polygon.cut) mesh_.corners.push_back(own[i]);
    }
  }

  fixtures::Random random_;
  std::size_t n_;
  double flat_;
  std::vector<Polygon> polygons_;
  // The positions and the normals, indexed by key and point. Key 0 is the base, and the other keys are the targets at
  // weight 1.
  std::vector<std::vector<Vector>> keys_, normals_;
  ShadedMesh mesh_;
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_AUTHORED_MESH_H_
