/// A viewer for tests of baked sequences. The viewer accepts only a GLB file with one animation and one morphing mesh,
/// whose only primitive has targets with positions and normals. For any other file, the viewer throws. Weights are
/// computed in double, and normals are added up in float32, as in viewers.
#ifndef CHRONORMAL_TESTS_SUPPORT_SHOWN_GLB_H_
#define CHRONORMAL_TESTS_SUPPORT_SHOWN_GLB_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/gltf_player.h"

namespace chronormal::test {

class ShownGlb {
 public:
  using Point = std::array<double, 3>;

  explicit ShownGlb(const std::string& file) {
    const GltfPlayer player(file);
    json = player.json;
    const auto& primitive = json.at("meshes").at(0).at("primitives").at(0);
    positions = player.accessor(primitive.at("attributes").at("POSITION"));
    normals = player.accessor(primitive.at("attributes").at("NORMAL"));
    for (const auto& target : primitive.at("targets")) {
      position_deltas.push_back(player.accessor(target.at("POSITION")));
      normal_deltas.push_back(player.accessor(target.at("NORMAL")));
    }
    for (const float corner : player.accessor(primitive.at("indices")))
      corners.push_back(static_cast<std::uint32_t>(corner));
    const auto& sampler = json.at("animations").at(0).at("samplers").at(0);
    times = player.accessor(sampler.at("input"));
    track_ = player.accessor(sampler.at("output"));
    is_cubic_ = sampler.at("interpolation") == "CUBICSPLINE";
  }

  [[nodiscard]] std::size_t vertices() const { return positions.size() / 3; }
  [[nodiscard]] std::size_t targets() const { return position_deltas.size(); }
  [[nodiscard]] double end() const { return times.back(); }

  /// Returns the weights of the targets at a time in seconds, by appendix C of the glTF specification.
  [[nodiscard]] std::vector<double> weights(double time) const {
    std::size_t k = 0;
    while (k + 2 < times.size() && time >= times[k + 1]) ++k;
    const double td = double{times[k + 1]} - double{times[k]}, t = (time - times[k]) / td, t2 = t * t, t3 = t2 * t;
    std::vector<double> result(targets());
    for (std::size_t i = 0; i < result.size(); ++i) {
      if (!is_cubic_) {
        result[i] = (1 - t) * track(k, i) + t * track(k + 1, i);
        continue;
      }
      const double b = track(3 * k + 2, i), a = track(3 * (k + 1), i);
      result[i] = (2 * t3 - 3 * t2 + 1) * track(3 * k + 1, i) + td * (t3 - 2 * t2 + t) * b +
                  (-2 * t3 + 3 * t2) * track(3 * (k + 1) + 1, i) + td * (t3 - t2) * a;
    }
    return result;
  }

  [[nodiscard]] Point position(std::size_t v, const std::vector<double>& weights) const {
    Point p{};
    for (std::size_t c = 0; c < 3; ++c) {
      p[c] = positions[3 * v + c];
      for (std::size_t i = 0; i < weights.size(); ++i) {
        if (weights[i] != 0) p[c] += weights[i] * double{position_deltas[i][3 * v + c]};
      }
    }
    return p;
  }

  [[nodiscard]] Point normal(std::size_t v, const std::vector<double>& weights) const {
    Point n{};
    for (std::size_t c = 0; c < 3; ++c) {
      float sum = normals[3 * v + c];
      for (std::size_t i = 0; i < weights.size(); ++i) {
        if (weights[i] != 0) sum += static_cast<float>(weights[i]) * normal_deltas[i][3 * v + c];
      }
      n[c] = sum;
    }
    return n;
  }

  nlohmann::json json;
  std::vector<float> positions, normals, times;
  std::vector<std::vector<float>> position_deltas, normal_deltas;
  std::vector<std::uint32_t> corners;  ///< three corners for each triangle

 private:
  [[nodiscard]] double track(std::size_t row, std::size_t target) const { return track_.at(row * targets() + target); }

  std::vector<float> track_;
  bool is_cubic_ = false;
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_SHOWN_GLB_H_
