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

// Returns the largest angle in radians between `normals` and the normals of positions that were blended and rounded to
// float32.
double largest_difference(const BlendSet& set, const NormalGroups& groups, const std::vector<double>& weights,
                          const std::vector<float>& normals) {
  std::vector<double> blended(set.base.size());
  blend_positions(set, weights, blended);
  const std::vector<float> positions(blended.begin(), blended.end());
  const auto view = VectorView<const float>::packed(positions.data(), kSide * kSide);
  std::vector<float> again(normals.size());
  NormalRecompute recompute({&set.topology, view, view}, groups);
  recompute.unit_normals(0, VectorView<float>::packed(again.data(), recompute.size()));
  double largest = 0;
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    const Vec3d a{normals[i], normals[i + 1], normals[i + 2]}, b{again[i], again[i + 1], again[i + 2]};
    largest = std::fmax(largest, angle_between(a, b));
  }
  return largest;
}

}  // namespace

int main() {
  // Make three targets like those of a face: two that overlap, and one far from both.
  BlendSet set = sheet();
  set.targets = {bump(set, "smile", -0.4F, 0, {0.1F, 0, 0.3F}), bump(set, "puff", -0.2F, 0, {-0.1F, 0.1F, 0.2F}),
                 bump(set, "brow", 0.5F, 0.5F, {0, 0.1F, 0.2F})};
  if (const Status status = validate(set); !status) {
    std::fprintf(stderr, "%s\n", status.error().text().c_str());
    return 1;
  }

  // Predict the cost before anything is computed.
  const NormalGroups groups = NormalGroups::of_vertices(set.topology, separate_points(kSide * kSide));
  const BlendCost cost = predict_blend_cost(set, groups);
  std::printf("%zu pairs overlap, %zu KiB of terms\n", cost.overlapping_pairs, (cost.bytes - cost.least_bytes) / 1024);

  BlendNormals normals = BlendNormals::of_groups(set, groups);
  const auto unit_normals = [&normals](const std::vector<double>& weights, BlendEvaluation& done) {
    std::vector<float> xyz(3 * normals.size());
    done = normals.unit_normals(weights, VectorView<float>::packed(xyz.data(), normals.size()));
    return xyz;
  };
  // Do what engines do, and add the normal deltas of all targets. The result is right only for one target with the
  // weight 1.
  BlendEvaluation done;
  const std::vector<float> base = unit_normals({0, 0, 0}, done), smile = unit_normals({1, 0, 0}, done),
                           puff = unit_normals({0, 1, 0}, done), brow = unit_normals({0, 0, 1}, done);
  std::printf("\nsmile  puff  brow   path   touched  error of engines\n");
  for (const std::vector<double>& w :
       {std::vector<double>{1, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}, {1, 1, 0}, {1, 1, 1}}) {
    const std::vector<float> exact = unit_normals(w, done);
    double worst = 0;
    for (std::size_t i = 0; i < exact.size(); i += 3) {
      double n[3];
      for (std::size_t c = 0; c < 3; ++c) {
        const double b = base[i + c];
        n[c] = b + w[0] * (smile[i + c] - b) + w[1] * (puff[i + c] - b) + w[2] * (brow[i + c] - b);
      }
      worst = std::fmax(worst, angle_between({n[0], n[1], n[2]}, {exact[i], exact[i + 1], exact[i + 2]}));
    }
    if (largest_difference(set, groups, w, exact) > 1e-5) return 1;
    std::printf("%5.1f %5.1f %5.1f   %s  %7zu  %.1f degrees\n", w[0], w[1], w[2], name_of(done.path).data(),
                done.touched_elements, worst * kDegreesPerRadian);
  }
}
