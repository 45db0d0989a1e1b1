/// Computes the true normals of the vertices of a glTF mesh by cross products in long double, from positions alone.
#ifndef CHRONORMAL_TESTS_SUPPORT_GLTF_TRUTH_H_
#define CHRONORMAL_TESTS_SUPPORT_GLTF_TRUTH_H_

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "tests/support/gltf_player.h"

namespace chronormal::test {

/// A mesh of a file before the bake. Its vertices are the vertices of all primitives that have faces and normals.
class GltfTruth {
 public:
  using Json = nlohmann::json;

  GltfTruth(const GltfPlayer& player, std::size_t mesh) {
    const Json& primitives = player.json.at("meshes").at(mesh).at("primitives");
    std::map<std::vector<float>, std::vector<std::size_t>> at_place;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const Json& primitive = primitives[p];
      const int mode = primitive.value("mode", 4);
      if (mode < 4 || !primitive.at("attributes").contains("NORMAL")) continue;
      const std::vector<float> base = player.accessor(primitive["attributes"]["POSITION"]);
      const std::vector<float> normals = player.accessor(primitive["attributes"]["NORMAL"]);
      const std::size_t first = vertices.size();
      for (std::size_t v = 0; v < base.size() / 3; ++v) {
        vertices.push_back({p, v, vector(normals, v)});
        positions_.push_back({vector(base, v)});
      }
      for (const Json& target : primitive.value("targets", Json::array())) {
        std::vector<float> deltas(base.size());
        if (target.contains("POSITION")) deltas = player.accessor(target["POSITION"]);
        for (std::size_t v = 0; v < base.size() / 3; ++v) positions_[first + v].push_back(vector(deltas, v));
      }
      std::vector<std::size_t> indices;
      if (primitive.contains("indices")) {
        for (const float i : player.accessor(primitive["indices"])) indices.push_back(static_cast<std::size_t>(i));
      } else {
        for (std::size_t v = 0; v < base.size() / 3; ++v) indices.push_back(v);
      }
      add_faces(indices, mode, first);
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      std::vector<float> key;
      for (const Vector& x : positions_[v]) {
        for (const Real c : x) key.push_back(static_cast<float>(c) + 0.0F);
      }
      at_place[key].push_back(v);
    }
    group_.resize(vertices.size());
    for (const auto& [key, here] : at_place) group(here);
  }

  struct Vertex {
    std::size_t primitive = 0, index = 0;
    Vector stored;
  };
  std::vector<Vertex> vertices;
  bool uniform = false;  ///< true if all faces have equal weight, instead of their area

  /// Returns n(w), the sum of the face normals at the weights w, for each vertex. Ignores weights beyond the number of
  /// targets in the file.
  [[nodiscard]] std::vector<Vector> normals_at(const std::vector<double>& weights) const {
    std::vector<Vector> at(vertices.size());
    for (std::size_t v = 0; v < at.size(); ++v) {
      at[v] = positions_[v][0];
      for (std::size_t k = 1; k < positions_[v].size(); ++k) {
        for (std::size_t c = 0; c < 3; ++c) at[v][c] += static_cast<Real>(weights.at(k - 1)) * positions_[v][k][c];
      }
    }
    std::vector<Vector> sums(vertices.size(), Vector{});
    for (const auto& face : faces_) {
      Vector e{}, f{};
      for (std::size_t c = 0; c < 3; ++c) {
        e[c] = at[face[1]][c] - at[face[0]][c];
        f[c] = at[face[2]][c] - at[face[0]][c];
      }
      Vector n = crossed(e, f);
      const Real size = uniform ? length_of(n) : 1;
      for (Real& c : n) c /= size;
      for (const std::size_t v : face) {
        for (std::size_t c = 0; c < 3; ++c) sums[group_[v]][c] += n[c];
      }
    }
    for (std::size_t v = 0; v < sums.size(); ++v) at[v] = sums[group_[v]];
    return at;
  }

  /// Turns n by the smallest rotation from the direction of `from` to the direction of `to`.
  [[nodiscard]] static Vector turn(const Vector& from, const Vector& to, const Vector& n) {
    const Real scale = length_of(from) * length_of(to);
    if (scale == 0) return n;
    const Vector axis = crossed(from, to);
    const Real s = length_of(axis) / scale, c = dotted(from, to) / scale, norm = length_of(axis);
    if (norm == 0) return n;  // the tests have no opposite vectors, so `from` and `to` are parallel
    const Vector k = {axis[0] / norm, axis[1] / norm, axis[2] / norm};
    const Vector across = crossed(k, n);
    const Real along = dotted(k, n) * (1 - c);
    return {n[0] * c + across[0] * s + k[0] * along, n[1] * c + across[1] * s + k[1] * along,
            n[2] * c + across[2] * s + k[2] * along};
  }

 private:
  [[nodiscard]] static Vector vector(const std::vector<float>& values, std::size_t v) {
    return {static_cast<Real>(values.at(3 * v)), static_cast<Real>(values.at(3 * v + 1)),
            static_cast<Real>(values.at(3 * v + 2))};
  }

  void add_faces(const std::vector<std::size_t>& i, int mode, std::size_t first) {
    for (std::size_t n = 0; n + 2 < i.size(); n += mode == 4 ? 3 : 1) {
      std::array<std::size_t, 3> face = {i[n], i[n + 1], i[n + 2]};
      if (mode == 5 && n % 2 == 1) std::swap(face[1], face[2]);
      if (mode == 6) face = {i[n + 1], i[n + 2], i[0]};
      for (std::size_t& v : face) v += first;
      faces_.push_back(face);
    }
  }

  // Groups vertices at the same place, so that they share a normal if their stored normals differ by at most 0.1
  // degrees.
  void group(const std::vector<std::size_t>& here) {
    std::vector<std::size_t> root(here.size());
    for (std::size_t a = 0; a < here.size(); ++a) root[a] = a;
    for (std::size_t a = 0; a < here.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const Vector &m = vertices[here[a]].stored, &n = vertices[here[b]].stored;
        if (degrees_between(m, n) > 0.1) continue;
        const std::size_t from = std::max(root[a], root[b]), to = std::min(root[a], root[b]);
        std::replace(root.begin(), root.end(), from, to);
      }
    }
    for (std::size_t a = 0; a < here.size(); ++a) group_[here[a]] = here[root[a]];
  }

  std::vector<std::vector<Vector>> positions_;  // for each vertex: the base position, and the delta of each target
  std::vector<std::array<std::size_t, 3>> faces_;
  std::vector<std::size_t> group_;
};

/// The sum, the largest and the number of the angles between rendered and true normals, in degrees.
struct ShownError {
  double sum = 0, worst = 0;
  std::size_t judged = 0, left_out = 0;

  [[nodiscard]] double mean() const { return judged > 0 ? sum / static_cast<double>(judged) : 0; }
  void add(double degrees) {
    sum += degrees;
    worst = std::max(worst, degrees);
    ++judged;
  }
};

/// A pose of a mesh: the weights of the targets, in the file before the bake and in the file after the bake.
struct Pose {
  std::vector<double> before;
  std::vector<float> after;
};

/// Compares the normals that viewers render after the bake with the true normals before the bake, in the given poses.
/// Skips samples in which |n(w)| is below 1e-4 of the largest |n| of the same vertex in the base and the given poses.
[[nodiscard]] inline ShownError shown_error(const GltfTruth& truth, const GltfPlayer& after, std::size_t mesh,
                                            const std::vector<Pose>& poses) {
  ShownError error;
  if (poses.empty()) return error;
  const std::vector<Vector> base = truth.normals_at(std::vector<double>(poses[0].before.size(), 0.0));
  std::vector<std::vector<Vector>> exact;
  std::vector<Real> largest(base.size(), 0);
  for (const Pose& pose : poses) {
    exact.push_back(truth.normals_at(pose.before));
    for (std::size_t v = 0; v < base.size(); ++v)
      largest[v] = std::max({largest[v], length_of(exact.back()[v]), length_of(base[v])});
  }
  const auto& primitives = after.json.at("meshes").at(mesh).at("primitives");
  for (std::size_t n = 0; n < poses.size(); ++n) {
    for (std::size_t v = 0; v < base.size(); ++v) {
      const GltfTruth::Vertex& vertex = truth.vertices[v];
      if (largest[v] == 0 || length_of(exact[n][v]) < 1e-4L * largest[v]) {
        ++error.left_out;
        continue;
      }
      const Vector shown = after.shown(primitives[vertex.primitive], vertex.index, poses[n].after);
      error.add(degrees_between(shown, GltfTruth::turn(base[v], vertex.stored, exact[n][v])));
    }
  }
  return error;
}

/// Returns the poses of a weight track at 101 times, from its first key to its last.
[[nodiscard]] inline std::vector<Pose> poses_of(const GltfPlayer& before, const GltfPlayer& after,
                                                std::size_t animation, std::size_t channel) {
  const auto& a = before.json.at("animations").at(animation);
  const auto& sampler = a.at("samplers").at(a.at("channels").at(channel).at("sampler").get<std::size_t>());
  const std::vector<float>& times = before.cached(sampler.at("input"));
  std::vector<Pose> poses;
  for (int i = 0; i <= 100; ++i) {
    const double first = static_cast<double>(times.front()), last = static_cast<double>(times.back());
    const double time = first + (last - first) * i / 100;
    const std::vector<float> weights = before.weights_at(animation, channel, time);
    poses.push_back({{weights.begin(), weights.end()}, after.weights_at(animation, channel, time)});
  }
  return poses;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_GLTF_TRUTH_H_
