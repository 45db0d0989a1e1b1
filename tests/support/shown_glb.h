/// What a client shows of a GLB file with one morphing mesh: a reader that shares no code with src/.
///
/// Only what tests of baked sequences need: one BIN chunk, one mesh with one primitive, float32 arrays, dense, sparse
/// or of zeros. Weights are computed in double; normals are summed in float, as clients do. Anything else throws.
#ifndef CHRONORMAL_TESTS_SUPPORT_SHOWN_GLB_H_
#define CHRONORMAL_TESTS_SUPPORT_SHOWN_GLB_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace chronormal::test {

class ShownGlb {
 public:
  using Point = std::array<double, 3>;

  explicit ShownGlb(std::string_view file) : file_(file) {
    if (file.size() < 28 || file.substr(0, 4) != "glTF" || word(8) != file.size()) throw std::runtime_error("no GLB");
    json = nlohmann::json::parse(file.substr(20, word(12)));
    const std::size_t bin = 20 + word(12);
    if (file.substr(bin + 4, 4) != std::string_view("BIN\0", 4)) throw std::runtime_error("no BIN chunk");
    bin_ = file.substr(bin + 8, word(bin));
    const auto& primitive = json["meshes"][0]["primitives"][0];
    positions = floats(primitive["attributes"]["POSITION"], 3);
    normals = floats(primitive["attributes"]["NORMAL"], 3);
    for (const auto& target : primitive["targets"]) {
      position_deltas.push_back(floats(target["POSITION"], 3));
      normal_deltas.push_back(floats(target["NORMAL"], 3));
    }
    read_triangles(json["accessors"][primitive["indices"].get<std::size_t>()]);
    const auto& sampler = json["animations"][0]["samplers"][0];
    times = floats(sampler["input"], 1);
    track_ = floats(sampler["output"], 1);
    is_cubic_ = sampler["interpolation"] == "CUBICSPLINE";
  }

  [[nodiscard]] std::size_t vertices() const { return positions.size() / 3; }
  [[nodiscard]] std::size_t targets() const { return position_deltas.size(); }
  [[nodiscard]] double end() const { return times.back(); }

  /// Appendix C of the specification.
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
  std::vector<std::uint32_t> corners;  ///< of triangles

 private:
  [[nodiscard]] std::size_t word(std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, file_.data() + at, 4);
    return value;
  }

  [[nodiscard]] double track(std::size_t row, std::size_t target) const { return track_.at(row * targets() + target); }

  [[nodiscard]] std::string_view view(const nlohmann::json& place, std::size_t bytes) const {
    const auto& view = json["bufferViews"][place["bufferView"].get<std::size_t>()];
    const std::size_t in_view = place.value("byteOffset", std::size_t{0});
    if (in_view + bytes > view["byteLength"].get<std::size_t>()) throw std::runtime_error("outside its view");
    const std::size_t begin = view.value("byteOffset", std::size_t{0}) + in_view;
    if (begin + bytes > bin_.size()) throw std::runtime_error("outside the buffer");
    return bin_.substr(begin, bytes);
  }

  // An integer of 1, 2 or 4 bytes.
  [[nodiscard]] static std::uint32_t integer(std::string_view bytes, std::size_t i, std::size_t size) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + i * size, size);
    return value;
  }

  [[nodiscard]] static std::size_t size_of(int component_type) {
    return component_type == 5121 ? 1 : component_type == 5123 ? 2 : 4;
  }

  [[nodiscard]] std::vector<float> floats(const nlohmann::json& index, std::size_t components) const {
    const auto& accessor = json["accessors"][index.get<std::size_t>()];
    if (accessor["componentType"] != 5126 || accessor["type"] != (components == 3 ? "VEC3" : "SCALAR"))
      throw std::runtime_error("not such floats");
    std::vector<float> values(accessor["count"].get<std::size_t>() * components, 0.0F);
    if (accessor.contains("bufferView"))
      std::memcpy(values.data(), view(accessor, 4 * values.size()).data(), 4 * values.size());
    if (!accessor.contains("sparse")) return values;
    const auto& sparse = accessor["sparse"];
    const auto count = sparse["count"].get<std::size_t>();
    const std::size_t size = size_of(sparse["indices"]["componentType"]);
    const std::string_view indices = view(sparse["indices"], size * count);
    const std::string_view stored = view(sparse["values"], 4 * components * count);
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(&values.at(components * integer(indices, i, size)), stored.data() + 4 * components * i,
                  4 * components);
    return values;
  }

  void read_triangles(const nlohmann::json& accessor) {
    const std::size_t size = size_of(accessor["componentType"]), count = accessor["count"].get<std::size_t>();
    const std::string_view bytes = view(accessor, size * count);
    for (std::size_t i = 0; i < count; ++i) corners.push_back(integer(bytes, i, size));
  }

  std::string_view file_, bin_;
  std::vector<float> track_;
  bool is_cubic_ = false;
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_SHOWN_GLB_H_
