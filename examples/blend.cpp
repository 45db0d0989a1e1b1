#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <vector>

#include "chronormal/chronormal.h"

namespace {

using namespace chronormal;

constexpr std::uint32_t kSide = 65;  // number of vertices along a side

// Returns a flat sheet whose sides have the length 2.
BlendSet sheet() {
  BlendSet set;
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (std::uint32_t v = 0; v < kSide * kSide; ++v) {
    const std::uint32_t x = v % kSide, y = v / kSide;
    for (const std::uint32_t place : {x, y}) set.base.push_back(static_cast<float>(place) / 32 - 1);
    set.base.push_back(0);
    if (x + 1 == kSide || y + 1 == kSide) continue;
    corners.insert(corners.end(), {v, v + 1, v + kSide + 1, v + kSide});
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  set.topology = Topology::polygons(kSide * kSide, offsets, corners).value();
  return set;
}

// Returns a target that smoothly moves the part of the sheet around (x, y), by up to `push`.
BlendTarget bump(const BlendSet& set, const char* name, float x, float y, const Vec3f& push) {
  std::vector<float> deltas;
  for (std::size_t v = 0; v < set.base.size(); v += 3) {
    const float square = std::pow(set.base[v] - x, 2.0F) + std::pow(set.base[v + 1] - y, 2.0F);
    const float size = square < 0.16F ? std::pow(1 - square / 0.16F, 2.0F) : 0;
    for (const float c : {push.x, push.y, push.z}) deltas.push_back(size * c);
  }
  return BlendTarget::from_dense(deltas, name);
}

// Returns the normals of a sheet whose positions are those of the blend, rounded to float32.
std::vector<float> normals_of_positions(const BlendSet& set, const std::vector<double>& weights) {
  std::vector<double> blended(set.base.size());
  blend_positions(set, weights, blended);
  const std::vector<float> positions(blended.begin(), blended.end());
  MeshNormals normals = MeshNormals::make(set.topology).value();
  std::vector<float> result(positions.size());
  const auto view = VectorView<const float>::packed(positions);
  if (normals.set_segment(view, view)) normals.unit_normals(0, VectorView<float>::packed(result));
  return result;
}

// Returns the largest angle between two lists of normals, in degrees.
double largest_angle(const std::vector<float>& a, const std::vector<float>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); i += 3) {
    const Vec3d of_a{a[i], a[i + 1], a[i + 2]}, of_b{b[i], b[i + 1], b[i + 2]};
    largest = std::fmax(largest, angle_between(of_a, of_b));
  }
  return largest * kDegreesPerRadian;
}

}  // namespace

int main() {
  // Make three targets like those of a face: two that overlap, and one far from both.
  BlendSet set = sheet();
  set.targets = {bump(set, "smile", -0.4F, 0, {0.1F, 0, 0.3F}), bump(set, "puff", -0.2F, 0, {-0.1F, 0.1F, 0.2F}),
                 bump(set, "brow", 0.5F, 0.5F, {0, 0.1F, 0.2F})};
  MeshNormals normals = MeshNormals::make(set.topology).value();
  if (const Status status = normals.set_targets(set); !status) {
    std::fprintf(stderr, "%s\n", status.error().text().c_str());
    return 1;
  }
  const auto unit_normals = [&normals](const std::vector<double>& weights) {
    std::vector<float> xyz(3 * normals.size());
    normals.unit_normals(weights, VectorView<float>::packed(xyz));
    return xyz;
  };
  // Do what engines do, and add the normal deltas of all targets. The result is right only for one target with the
  // weight 1.
  const std::vector<float> base = unit_normals({0, 0, 0}), smile = unit_normals({1, 0, 0}),
                           puff = unit_normals({0, 1, 0}), brow = unit_normals({0, 0, 1});
  std::printf("smile  puff  brow   error of engines\n");
  for (const std::vector<double>& w :
       {std::vector<double>{1, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}, {1, 1, 0}, {1, 1, 1}}) {
    const std::vector<float> exact = unit_normals(w);
    std::vector<float> added(exact.size());
    for (std::size_t i = 0; i < added.size(); ++i)
      added[i] = static_cast<float>(base[i] + w[0] * (smile[i] - base[i]) + w[1] * (puff[i] - base[i]) +
                                    w[2] * (brow[i] - base[i]));
    if (largest_angle(exact, normals_of_positions(set, w)) > 1e-3) return 1;
    std::printf("%5.1f %5.1f %5.1f   %.1f degrees\n", w[0], w[1], w[2], largest_angle(added, exact));
  }
}
