// Measures how long normal cones, bounds of clusters of faces, and mean normals take for a whole segment. For
// comparison, also measures common practice: cones of the two ends, meshoptimizer's bounds at some instants, and means
// of many samples.

#include <fmt/core.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "chronormal/analysis/cones.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "groups/groups.h"

namespace chronormal::bench {
namespace {

constexpr double kFrom = 0.2, kTo = 0.7;  // times at which the shutter opens and closes
constexpr int kSamples = 64, kInstants = 8;
constexpr std::size_t kClusterFaces = 64;

struct Subject {
  Segment segment;
  std::vector<ControlNormals> normals;
  std::vector<NormalCone> cones;
  std::vector<ShutterNormal> means;
  std::vector<std::vector<std::uint32_t>> clusters;
  std::vector<ClusterBounds> bounds;

  explicit Subject(const Segment& of)
      : segment(of), normals(all_face_control_normals(of)), cones(normals.size()), means(normals.size()) {
    // Consecutive faces of the grid lie side by side, so that they form a cluster.
    for (std::size_t first = 0; first < normals.size(); first += kClusterFaces) {
      clusters.emplace_back();
      for (std::size_t f = first; f < std::min(first + kClusterFaces, normals.size()); ++f)
        clusters.back().push_back(static_cast<std::uint32_t>(f));
    }
    bounds.resize(clusters.size());
  }
};

// Returns the smallest cone around the unit normals at both ends. The normals in between may leave this cone.
NormalCone cone_of_ends(const ControlNormals& c) {
  const Vec3d u0 = unit(c.n0), axis = unit(u0 + unit(c.n1));
  return {to_float(axis), static_cast<float>(length(cross(u0, axis)))};
}

// Returns the share of the faces whose normal leaves the cone of the face in at least one of many samples.
double share_outside(const Subject& s) {
  std::size_t outside = 0;
  for (std::size_t f = 0; f < s.normals.size(); ++f) {
    bool is_outside = false;
    for (int i = 0; i <= kSamples && !is_outside; ++i) {
      const double angle = angle_between(normal_at(s.normals[f], i / double{kSamples}), to_double(s.cones[f].axis));
      is_outside = angle > half_angle(s.cones[f]) + 1e-6;
    }
    outside += is_outside ? 1U : 0U;
  }
  return static_cast<double>(outside) / static_cast<double>(s.normals.size());
}

double mean_half_angle(const Subject& s) {
  double sum = 0;
  for (const NormalCone& cone : s.cones) sum += half_angle(cone) * kDegreesPerRadian;
  return sum / static_cast<double>(s.cones.size());
}

Vec3d sampled_mean(const ControlNormals& c) {
  Vec3d sum;
  for (int i = 0; i < kSamples; ++i) sum = sum + unit_normal_at(c, kFrom + (kTo - kFrom) * (i + 0.5) / kSamples).vector;
  return (1.0 / kSamples) * sum;
}

// Computes the positions at some instants, and meshoptimizer's bounds of each instant, as a renderer does for every
// frame.
void bounds_at_instants(const Subject& s, std::vector<float>& positions, std::vector<meshopt_Bounds>& result) {
  const auto corners = s.segment.topology->corners();
  for (int i = 0; i < kInstants; ++i) {
    const auto t = static_cast<float>(kFrom + (kTo - kFrom) * i / (kInstants - 1));
    for (std::size_t v = 0; v < s.segment.from.count; ++v) {
      const Vec3f p = lerp(s.segment.from[v], s.segment.to[v], t);
      positions[3 * v] = p.x, positions[3 * v + 1] = p.y, positions[3 * v + 2] = p.z;
    }
    for (std::size_t c = 0; c < s.clusters.size(); ++c)
      result[c] = meshopt_computeClusterBounds(corners.data() + 3 * s.clusters[c].front(), 3 * s.clusters[c].size(),
                                               positions.data(), positions.size() / 3, 3 * sizeof(float));
  }
}

}  // namespace

void run_cones(Suite& suite, const Size& size) {
  const std::string group = "cones";
  CaseList list(suite, group, size);
  suite.say(fmt::format("{}, {}, {}: mesh", group, size.name, size.order()));
  const Mesh mesh(Elements::kFaces, size.elements, size.shuffled);
  const Oracle oracle(mesh.segment(), Elements::kFaces);
  const auto s = std::make_shared<Subject>(mesh.segment());
  const std::size_t count = s->normals.size();
  const auto made = [&](const std::string& name, const std::string& note, const std::string& library,
                        std::function<void()> run) {
    list.add(name, [&] {
      Case one;
      one.note = note;
      one.library = library;
      one.run = std::move(run);
      return one;
    });
  };

  const auto curves = std::make_shared<NormalCurves>(s->normals);
  const auto units = std::make_shared<std::vector<float>>(3 * count);
  made("unit normals at one t, curves", "float32, for scale", "",
       [=] { (void)curves->unit_normals(double{kTime}, VectorView<float>::packed(units->data(), count)); });
  made("unit normals at one t, double", "unit_normal_at() of the same control normals", "", [=] {
    for (std::size_t f = 0; f < count; ++f) {
      const Vec3f u = to_float(unit_normal_at(s->normals[f], double{kTime}).vector);
      (*units)[3 * f] = u.x, (*units)[3 * f + 1] = u.y, (*units)[3 * f + 2] = u.z;
    }
  });

  normal_cones(s->normals, 0, 1, s->cones);
  if (share_outside(*s) > 0) throw std::runtime_error("cones: a normal lies outside of its cone");
  made("cones", fmt::format("{:.2f} degrees wide, no normal outside", mean_half_angle(*s)), "",
       [=] { normal_cones(s->normals, 0, 1, s->cones); });
  made("cones, part of the segment", "", "", [=] { normal_cones(s->normals, kFrom, kTo, s->cones); });
  const auto all_ends = [=] {
    for (std::size_t f = 0; f < count; ++f) s->cones[f] = cone_of_ends(s->normals[f]);
  };
  all_ends();
  made("cones of the two ends",
       fmt::format("{:.2f} degrees wide, left by {:.1f} % of the faces", mean_half_angle(*s), 100 * share_outside(*s)),
       "a plain loop", all_ends);

  made("bounds of clusters", fmt::format("of {} faces each, right at every instant", kClusterFaces), "", [=] {
    for (std::size_t c = 0; c < s->clusters.size(); ++c)
      s->bounds[c] = cluster_bounds(s->segment, s->clusters[c], kFrom, kTo);
  });
  const auto positions = std::make_shared<std::vector<float>>(3 * s->segment.from.count);
  const auto sampled = std::make_shared<std::vector<meshopt_Bounds>>(s->clusters.size());
  made("bounds of clusters, 8 instants", "right at these instants", "meshoptimizer",
       [=] { bounds_at_instants(*s, *positions, *sampled); });

  double largest = 0;
  for (std::size_t f = 0; f < count; f += 1 + count / 1000) {
    const ShutterNormal mean = shutter_normal(s->normals[f], kFrom, kTo);
    const double off = length(mean.mean_unit - sampled_mean(s->normals[f]));
    largest = std::max(largest, off);
    if (off > mean.error + 1e-3) throw std::runtime_error("cones: a mean is not what samples say");
  }
  made("mean over a shutter", "to a bound of 1e-7", "", [=] {
    for (std::size_t f = 0; f < count; ++f) s->means[f] = shutter_normal(s->normals[f], kFrom, kTo);
  });
  made("mean over a shutter, 64 samples", fmt::format("off by up to {:.1e}", largest), "a plain loop", [=] {
    for (std::size_t f = 0; f < count; ++f) s->means[f].mean_unit = sampled_mean(s->normals[f]);
  });
  suite.run(group, size, count, oracle, list.take());
}

}  // namespace chronormal::bench
