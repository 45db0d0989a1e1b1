/// A small viewer of glTF files that shares no code with the library. The viewer reads a GLB file, plays weight tracks
/// by appendix C of the glTF specification, adds up targets in float32, and computes the true normals from the
/// positions.
#ifndef CHRONORMAL_TESTS_SUPPORT_GLTF_PLAYER_H_
#define CHRONORMAL_TESTS_SUPPORT_GLTF_PLAYER_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/long_vectors.h"

namespace chronormal::test {

class GltfPlayer {
 public:
  using Json = nlohmann::json;

  explicit GltfPlayer(std::string glb) : glb_(std::move(glb)) {
    const std::size_t size = word(12);
    json = Json::parse(glb_.substr(20, size));
    if (glb_.size() > 28 + size) bin_ = 28 + size;
  }

  Json json;

  [[nodiscard]] std::string_view bin() const {
    return bin_ == 0 ? std::string_view() : std::string_view(glb_).substr(bin_, word(bin_ - 8));
  }

  /// Returns all numbers of an accessor.
  [[nodiscard]] std::vector<float> accessor(std::size_t index) const {
    const Json& a = json.at("accessors").at(index);
    const std::size_t width = width_of(a.at("type")), count = a.at("count");
    std::vector<float> values(width * count);
    if (a.contains("bufferView")) {
      const std::size_t size = size_of(a.at("componentType"));
      const Json& view = json.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
      const std::size_t stride = view.value("byteStride", width * size);
      const std::size_t end = a.value("byteOffset", std::size_t{0}) + (count - 1) * stride + width * size;
      if (count > 0 && end > view.at("byteLength").get<std::size_t>()) throw std::runtime_error("beyond its view");
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < width; ++c)
          values[i * width + c] = component(a, start_of(a.at("bufferView"), a) + i * stride + c * size);
      }
    }
    if (!a.contains("sparse")) return values;
    const Json &indices = a["sparse"]["indices"], &replaced = a["sparse"]["values"];
    for (std::size_t n = 0; n < a["sparse"]["count"].get<std::size_t>(); ++n) {
      const std::size_t at = start_of(indices.at("bufferView"), indices) + n * size_of(indices.at("componentType"));
      const auto i = static_cast<std::size_t>(component(indices, at));
      for (std::size_t c = 0; c < width; ++c) {
        const std::size_t offset = (n * width + c) * size_of(a.at("componentType"));
        values.at(i * width + c) = component(a, start_of(replaced.at("bufferView"), replaced) + offset);
      }
    }
    return values;
  }

  /// Returns the weights of a channel at a time, computed in float32, as in viewers.
  [[nodiscard]] std::vector<float> weights_at(std::size_t animation, std::size_t channel, double time) const {
    const Json& a = json.at("animations").at(animation);
    const Json& sampler = a.at("samplers").at(a.at("channels").at(channel).at("sampler").get<std::size_t>());
    const std::vector<float>&times = cached(sampler.at("input")), &values = cached(sampler.at("output"));
    const std::string interpolation = sampler.value("interpolation", "LINEAR");
    const bool spline = interpolation == "CUBICSPLINE";
    const std::size_t width = values.size() / times.size() / (spline ? 3 : 1), row = spline ? 3 * width : width;
    const std::size_t value = spline ? width : 0;
    std::size_t key = 0;
    while (key + 1 < times.size() && static_cast<double>(times[key + 1]) <= time) ++key;
    std::vector<float> result(width);
    const bool outside = time <= static_cast<double>(times[0]) || key + 1 == times.size();
    const double td = outside ? 1 : static_cast<double>(times[key + 1]) - static_cast<double>(times[key]);
    const auto t = static_cast<float>((time - static_cast<double>(times[key])) / td), t2 = t * t, t3 = t2 * t;
    for (std::size_t i = 0; i < width; ++i) {
      const float* from = values.data() + key * row + i;
      result[i] = from[value];
      if (outside || interpolation == "STEP") continue;
      const float* to = from + row;
      if (!spline) {
        result[i] = from[0] + t * (to[0] - from[0]);
        continue;
      }
      const auto d = static_cast<float>(td);
      result[i] = (2 * t3 - 3 * t2 + 1) * from[width] + d * (t3 - 2 * t2 + t) * from[2 * width] +
                  (-2 * t3 + 3 * t2) * to[width] + d * (t3 - t2) * to[0];
    }
    return result;
  }

  /// Returns the stored normal of a vertex plus its weighted deltas, computed in float32.
  [[nodiscard]] Vector shown(const Json& primitive, std::size_t vertex, const std::vector<float>& weights) const {
    const std::vector<float>& normals = cached(primitive.at("attributes").at("NORMAL"));
    std::array<float, 3> sum = {normals[3 * vertex], normals[3 * vertex + 1], normals[3 * vertex + 2]};
    const Json& targets = primitive.at("targets");
    for (std::size_t k = 0; k < targets.size(); ++k) {
      if (weights.at(k) == 0 || !targets[k].contains("NORMAL")) continue;
      const std::vector<float>& deltas = cached(targets[k]["NORMAL"]);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weights[k] * deltas[3 * vertex + c];
    }
    return {static_cast<Real>(sum[0]), static_cast<Real>(sum[1]), static_cast<Real>(sum[2])};
  }

  [[nodiscard]] const std::vector<float>& cached(std::size_t index) const {
    const auto [found, is_new] = cache_.try_emplace(index);
    if (is_new) found->second = accessor(index);
    return found->second;
  }

 private:
  [[nodiscard]] std::uint32_t word(std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, glb_.data() + at, 4);
    return value;
  }
  [[nodiscard]] static std::size_t width_of(const std::string& type) {
    return type == "SCALAR" ? 1 : static_cast<std::size_t>(type.at(3) - '0');
  }
  [[nodiscard]] static std::size_t size_of(int type) { return type <= 5121 ? 1 : type <= 5123 ? 2 : 4; }
  [[nodiscard]] std::size_t start_of(std::size_t view, const Json& holder) const {
    const Json& v = json.at("bufferViews").at(view);
    if (v.at("buffer") != 0) throw std::runtime_error("a GLB has one buffer");
    return bin_ + v.value("byteOffset", std::size_t{0}) + holder.value("byteOffset", std::size_t{0});
  }
  template <class T>
  [[nodiscard]] T read(std::size_t at) const {
    if (at + sizeof(T) > glb_.size()) throw std::runtime_error("an accessor beyond the file");
    T value;
    std::memcpy(&value, glb_.data() + at, sizeof(T));
    return value;
  }
  [[nodiscard]] float component(const Json& holder, std::size_t at) const {
    const bool normalized = holder.value("normalized", false);
    const auto scaled = [normalized](double v, double most) {
      return static_cast<float>(normalized ? std::fmax(v / most, -1) : v);
    };
    switch (holder.at("componentType").get<int>()) {
      case 5120:
        return scaled(read<std::int8_t>(at), 127);
      case 5121:
        return scaled(read<std::uint8_t>(at), 255);
      case 5122:
        return scaled(read<std::int16_t>(at), 32767);
      case 5123:
        return scaled(read<std::uint16_t>(at), 65535);
      case 5125:
        return scaled(read<std::uint32_t>(at), 1);
      default:
        return read<float>(at);
    }
  }

  std::string glb_;
  std::size_t bin_ = 0;
  mutable std::map<std::size_t, std::vector<float>> cache_;
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_GLTF_PLAYER_H_
