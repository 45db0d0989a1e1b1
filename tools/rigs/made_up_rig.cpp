#include "made_up_rig.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace chronormal::rigs_page {
namespace {

using Json = nlohmann::ordered_json;
using Vector = std::array<double, 3>;

constexpr int kFloat = 5126, kUnsignedInt = 5125;  // componentType of glTF

Vector sum(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector difference(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::vector<std::uint32_t> triangles_of(std::size_t side) {
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i + 1 < side; ++i) {
    for (std::size_t j = 0; j + 1 < side; ++j) {
      const auto a = static_cast<std::uint32_t>(i * side + j), b = a + static_cast<std::uint32_t>(side);
      corners.insert(corners.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  }
  return corners;
}

std::vector<Vector> unit_normals(const std::vector<Vector>& points, const std::vector<std::uint32_t>& corners) {
  std::vector<Vector> normals(points.size(), Vector{});
  for (std::size_t c = 0; c < corners.size(); c += 3) {
    const Vector &p = points[corners[c]], &q = points[corners[c + 1]], &r = points[corners[c + 2]];
    const Vector area = cross(difference(q, p), difference(r, p));
    for (std::size_t k = 0; k < 3; ++k) normals[corners[c + k]] = sum(normals[corners[c + k]], area);
  }
  for (Vector& n : normals) {
    const double length = std::hypot(n[0], n[1], n[2]);
    for (double& component : n) component /= length;
  }
  return normals;
}

// A GLB that grows by one accessor after another, each over a view of its own.
class Glb {
 public:
  std::size_t add_vectors(const std::vector<Vector>& vectors, bool positions) {
    std::vector<float> values;
    values.reserve(3 * vectors.size());
    for (const Vector& vector : vectors)
      for (const double component : vector) values.push_back(static_cast<float>(component));
    const std::size_t index = add(values, kFloat, "VEC3", vectors.size());
    if (positions) {
      std::array<float, 3> least, most;
      for (std::size_t k = 0; k < 3; ++k) {
        least[k] = most[k] = values[k];
        for (std::size_t v = k; v < values.size(); v += 3) {
          least[k] = std::fmin(least[k], values[v]);
          most[k] = std::fmax(most[k], values[v]);
        }
      }
      json["accessors"][index]["min"] = least;
      json["accessors"][index]["max"] = most;
    }
    return index;
  }

  std::size_t add_indices(const std::vector<std::uint32_t>& indices) {
    return add(indices, kUnsignedInt, "SCALAR", indices.size());
  }

  std::string bytes() {
    json["buffers"] = {{{"byteLength", buffer_.size()}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return "glTF" + word(2) + word(28 + text.size() + buffer_.size()) + word(text.size()) + "JSON" + text +
           word(buffer_.size()) + std::string("BIN\0", 4) + buffer_;
  }

  Json json = {{"asset", {{"version", "2.0"}}}};

 private:
  static std::string word(std::size_t value) {
    std::string bytes;
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xFFU);
    return bytes;
  }

  template <class T>
  std::size_t add(const std::vector<T>& values, int component, const char* type, std::size_t count) {
    const std::size_t length = values.size() * sizeof(T), index = json["accessors"].size();
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", length}});
    json["accessors"].push_back(
        {{"bufferView", index}, {"componentType", component}, {"count", count}, {"type", type}});
    buffer_.append(reinterpret_cast<const char*>(values.data()), length);  // four bytes each, so that all are aligned
    return index;
  }

  std::string buffer_;
};

}  // namespace

std::string made_up_rig_glb(const MadeUpRig& rig) {
  const double last = static_cast<double>(rig.side - 1);
  std::vector<Vector> base;
  for (std::size_t i = 0; i < rig.side; ++i) {
    for (std::size_t j = 0; j < rig.side; ++j) {
      const double u = 2 * static_cast<double>(i) / last - 1, v = 2 * static_cast<double>(j) / last - 1;
      base.push_back({u, v, 0.8 - 0.4 * (u * u + v * v) + 0.04 * std::sin(9 * u) * std::cos(7 * v)});
    }
  }
  const std::vector<std::uint32_t> corners = triangles_of(rig.side);
  const std::vector<Vector> normals = unit_normals(base, corners);

  Glb glb;
  Json primitive = {
      {"attributes", {{"POSITION", glb.add_vectors(base, true)}, {"NORMAL", glb.add_vectors(normals, false)}}},
      {"indices", glb.add_indices(corners)}};
  Json names = Json::array();
  for (std::size_t k = 0; k < rig.targets; ++k) {
    // Centres lie evenly over the face (the additive sequence of the plastic number), and each target pushes another way.
    const auto number = static_cast<double>(k);
    const double u = 2 * std::fmod(0.5 + 0.7548776662466927 * number, 1) - 1;
    const double v = 2 * std::fmod(0.5 + 0.5698402909980532 * number, 1) - 1;
    const Vector push = {0.1 * std::cos(2.4 * number), 0.1 * std::sin(2.4 * number), 0.12 * std::cos(1.7 * number)};
    std::vector<Vector> moves, end = base;
    for (std::size_t p = 0; p < base.size(); ++p) {
      const double distance = std::hypot(base[p][0] - u, base[p][1] - v) / rig.reach;
      const double share = distance < 1 ? (1 - distance * distance) * (1 - distance * distance) : 0;
      moves.push_back({share * push[0], share * push[1], share * push[2]});
      end[p] = sum(base[p], moves[p]);
    }
    std::vector<Vector> turns = unit_normals(end, corners);
    for (std::size_t p = 0; p < base.size(); ++p) turns[p] = difference(turns[p], normals[p]);
    primitive["targets"].push_back(
        {{"POSITION", glb.add_vectors(moves, true)}, {"NORMAL", glb.add_vectors(turns, false)}});
    names.push_back("target" + std::to_string(k));
  }
  glb.json["meshes"] = {{{"primitives", {std::move(primitive)}}, {"extras", {{"targetNames", names}}}}};
  glb.json["nodes"] = {{{"mesh", 0}}};
  glb.json["scenes"] = {{{"nodes", {0}}}};
  glb.json["scene"] = 0;
  return glb.bytes();
}

}  // namespace chronormal::rigs_page
