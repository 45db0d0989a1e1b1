// Compares the normals of glTF files with rational numbers, which are computed from the base, the deltas, the weights
// and the times in the file.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/analysis/quality.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/mesh_normals.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/workflow/compare.h"
#include "chronormal/workflow/sample.h"
#include "io/gltf/gltf_motion.h"
#include "normals/recompute/recompute.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_weights.h"

namespace chronormal::gltf_sample_test {
namespace {

using exact::Rational;
using fixtures::Random;
using test::GltfBuilder, test::GltfFixture;

constexpr double kMillionth = 1e-6;

double decade(Random& random, double low, double high) { return std::pow(10, random.uniform(low, high)); }

// The numbers in a file with animated meshes on several nodes.
struct File {
  struct Track {
    std::vector<float> times, values;  // the LINEAR keys; each time has a row of weights
  };
  std::vector<float> base;
  std::vector<std::uint32_t> corners;
  std::vector<std::vector<float>> targets;
  std::vector<Track> tracks;                     // one for each node
  std::vector<std::array<double, 16>> matrices;  // one for each node, column by column

  [[nodiscard]] std::size_t vertices() const { return base.size() / 3; }

  [[nodiscard]] GltfBuilder builder() const {
    GltfBuilder builder;
    std::vector<GltfBuilder::Json> moved;
    const std::size_t position = builder.add_positions(base);
    for (const auto& target : targets) moved.push_back({{"POSITION", builder.add_positions(target)}});
    builder.add_mesh(GltfBuilder::primitive(position, builder.add_indices(corners), moved));
    const std::size_t animation = builder.add_animation("move");
    for (std::size_t n = 0; n < tracks.size(); ++n)
      builder.add_track(animation, builder.add_node(0, {{"matrix", matrices[n]}}), tracks[n].times, tracks[n].values);
    return builder;
  }

  // Returns the weights of the mesh on a node at a time, linear between keys.
  [[nodiscard]] std::vector<Rational> weights_at(std::size_t node, const Rational& time) const {
    const auto& [times, values] = tracks[node];
    std::vector<Rational> weights(targets.size());
    std::size_t key = 0;
    while (key + 2 < times.size() && Rational(double{times[key + 1]}) <= time) ++key;
    const Rational from(double{times[key]}), to(double{times[key + 1]});
    Rational t = (time - from) / (to - from);
    if (t < 0) t = 0;
    if (t > 1) t = 1;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const Rational a(double{values[key * targets.size() + k]}), b(double{values[(key + 1) * targets.size() + k]});
      weights[k] = a + t * (b - a);
    }
    return weights;
  }

  // Returns the normals of all faces, followed by the area-weighted normals of all vertices. If `matrix` is not
  // nullptr, the matrix transforms the mesh first.
  [[nodiscard]] std::vector<exact::Vector> normals(const std::vector<Rational>& weights,
                                                   const std::array<double, 16>* matrix) const {
    std::vector<exact::Vector> places(vertices()), normals(corners.size() / 3 + vertices());
    for (std::size_t v = 0; v < vertices(); ++v) {
      exact::Vector p;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        p[axis] = Rational(double{base[3 * v + axis]});
        for (std::size_t k = 0; k < targets.size(); ++k)
          p[axis] += weights[k] * Rational(double{targets[k][3 * v + axis]});
      }
      places[v] = p;
      for (std::size_t axis = 0; axis < 3 && matrix != nullptr; ++axis) {
        places[v][axis] = Rational((*matrix)[12 + axis]);
        for (std::size_t k = 0; k < 3; ++k) places[v][axis] += Rational((*matrix)[4 * k + axis]) * p[k];
      }
    }
    const std::size_t faces = corners.size() / 3;
    for (std::size_t f = 0; f < faces; ++f) {
      const auto corner = [&](std::size_t c) -> const exact::Vector& { return places[corners[3 * f + c]]; };
      normals[f] = exact::cross(exact::subtract(corner(1), corner(0)), exact::subtract(corner(2), corner(0)));
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t axis = 0; axis < 3; ++axis) normals[faces + corners[3 * f + c]][axis] += normals[f][axis];
    }
    return normals;
  }
};

// Makes fans of triangles with edges of a thousandth or more, and slivers, all over the unit cube. Targets move each
// fan as a whole, and its vertices slightly against each other. The vertices of a sliver move along the line on which
// they are.
File random_file(Random& random, std::size_t nodes) {
  File file;
  std::vector<std::size_t> fan_of_vertex;
  std::vector<double> sizes;
  std::vector<fixtures::Point> lines;  // directions of the slivers
  const auto number = [](double x) { return static_cast<float>(x); };
  for (std::size_t fan = 0; fan < 8; ++fan) {
    const auto first = static_cast<std::uint32_t>(file.vertices());
    const fixtures::Point centre = random.in_cube(1);
    sizes.push_back(decade(random, -3, -0.5));
    const bool is_sliver = fan % 2 == 1;
    const std::size_t ring = is_sliver ? 2 : 5;
    const fixtures::Point along = random.in_cube(sizes.back());
    lines.push_back(along);
    for (std::size_t i = 0; i <= ring; ++i) {
      const double angle = 6.283 * static_cast<double>(i) / 5;
      const fixtures::Point off = random.in_cube(0.2 * sizes.back());
      const fixtures::Point flat = {sizes.back() * std::cos(angle), sizes.back() * std::sin(angle), 0};
      // Except for rounding, the corners of a sliver are on a line.
      const double way = random.uniform(0.2, 1) * static_cast<double>(i);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double from_centre = is_sliver ? way * along[axis] : i == 0 ? off[axis] : flat[axis] + off[axis];
        file.base.push_back(number(centre[axis] + from_centre));
      }
      fan_of_vertex.push_back(fan);
    }
    for (std::size_t i = 1; i <= (is_sliver ? 1 : ring); ++i)
      file.corners.insert(file.corners.end(), {first, first + static_cast<std::uint32_t>(i),
                                               first + static_cast<std::uint32_t>(i % ring) + 1});
  }
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<fixtures::Point> moves;
    for (std::size_t fan = 0; fan < sizes.size(); ++fan) moves.push_back(random.in_cube(decade(random, -3, 0)));
    std::vector<float>& target = file.targets.emplace_back();
    for (std::size_t v = 0; v < file.vertices(); ++v) {
      const std::size_t fan = fan_of_vertex[v];
      fixtures::Point own = random.in_cube(0.5 * sizes[fan]);
      if (const double way = random.uniform(-0.5, 0.5); fan % 2 == 1)
        own = {way * lines[fan][0], way * lines[fan][1], way * lines[fan][2]};
      for (std::size_t axis = 0; axis < 3; ++axis) target.push_back(number(moves[fan][axis] + own[axis]));
    }
  }
  for (std::size_t n = 0; n < nodes; ++n) {
    File::Track& track = file.tracks.emplace_back();
    double time = random.uniform(0, 1);
    for (std::size_t key = 0; key < 3; ++key) {
      track.times.push_back(number(time));
      time += random.uniform(0.01, 3);
      for (std::size_t k = 0; k < file.targets.size(); ++k) track.values.push_back(number(random.uniform(-0.5, 1.5)));
    }
    std::array<double, 16>& matrix = file.matrices.emplace_back();
    for (std::size_t k = 0; k < 16; ++k)
      matrix[k] = k % 4 == 3 ? (k == 15 ? 1 : 0) : double{number(random.uniform(-2, 2))};
  }
  return file;
}

GltfMotion motion_of(const File& file, const std::string& animation, bool world) {
  const GltfFixture document(file.builder());
  EXPECT_TRUE(document.ok()) << document.error();
  GltfMotionOptions options;
  options.animation = animation;
  options.world = world;
  Result<GltfMotion> motion = read_gltf_motion(*document, options);
  EXPECT_TRUE(motion.ok()) << motion.error().text();
  return std::move(motion).value();
}

// Compares the unit normals of faces or vertices with exact normals, and keeps the largest error.
class Judge {
 public:
  void add(const std::string& way, std::span<const float> found, std::span<const exact::Vector> exact,
           bool may_be_zero = false) {
    ASSERT_EQ(found.size(), 3 * exact.size()) << way;
    double& worst = worst_[way];
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const bool is_zero = found[3 * i] == 0 && found[3 * i + 1] == 0 && found[3 * i + 2] == 0;
      if (exact::is_zero(exact[i]) || (is_zero && may_be_zero)) continue;
      const double error = exact::angle(found[3 * i], found[3 * i + 1], found[3 * i + 2], exact[i]);
      worst = std::isnan(error) ? 3 : std::max(worst, error);
    }
  }
  ~Judge() {
    for (const auto& [way, worst] : worst_) {
      std::cout << "  " << way << ": " << worst << " rad at most\n";
      EXPECT_LT(worst, kMillionth) << way;
    }
  }

 private:
  std::map<std::string, double> worst_;
};

std::vector<float> sampled(const Motion& motion, ElementKind kind, double time, std::span<const double> weights = {}) {
  SampleOptions options;
  options.elements.kind = kind;
  options.elements.weld = false;
  NormalSampler sampler = NormalSampler::make(motion, options).value();
  const Pose pose = weights.empty() ? sampler.at_time(time).value() : sampler.at_weights(weights).value();
  return sampler.normals_of_outputs(pose);
}

constexpr std::uint64_t kSeed = 4901;
constexpr int kFiles = 40;

std::span<const exact::Vector> faces_of(const File& file, const std::vector<exact::Vector>& normals) {
  return std::span(normals).first(file.corners.size() / 3);
}
std::span<const exact::Vector> vertices_of(const File& file, const std::vector<exact::Vector>& normals) {
  return std::span(normals).subspan(file.corners.size() / 3);
}

TEST(GltfSamples, of_an_animation_are_exact_at_keys_and_between_them_and_as_those_of_its_weights) {
  std::cout << "seed " << kSeed << '\n';
  Judge judge;
  for (int i = 0; i < kFiles; ++i) {
    Random random(kSeed + static_cast<std::uint64_t>(i));
    const File file = random_file(random, 1);
    const Motion motion = motion_of(file, "0", false).motion, targets = motion_of(file, "", false).motion;
    const std::vector<float>& times = file.tracks[0].times;
    std::vector<double> asked(times.begin(), times.end());
    for (int k = 0; k < 3; ++k) asked.push_back(random.uniform(double{times.front()}, double{times.back()}));
    for (std::size_t k = 0; k < asked.size(); ++k) {
      const std::vector<Rational> weights = file.weights_at(0, Rational(asked[k]));
      const auto exact = file.normals(weights, nullptr);
      judge.add("faces at times", sampled(motion, ElementKind::kFaces, asked[k]), faces_of(file, exact));
      judge.add("vertices at times", sampled(motion, ElementKind::kVertices, asked[k]), vertices_of(file, exact));
      if (k >= times.size()) continue;
      std::vector<double> row;
      for (const Rational& weight : weights) row.push_back(weight.get_d());
      judge.add("faces at weights", sampled(targets, ElementKind::kFaces, 0, row), faces_of(file, exact));
      judge.add("vertices at weights", sampled(targets, ElementKind::kVertices, 0, row), vertices_of(file, exact));
    }
  }
}

TEST(GltfSamples, in_the_world_are_exact_for_nodes_with_keys_of_their_own) {
  Judge judge;
  for (int i = 0; i < kFiles / 2; ++i) {
    Random random(kSeed + 1000 + static_cast<std::uint64_t>(i));
    const File file = random_file(random, 2);
    const Motion motion = motion_of(file, "0", true).motion;
    const double first = motion.keyframes.front().time, last = motion.keyframes.back().time;
    for (int k = 0; k < 4; ++k) {
      const double time = k == 0 ? first : random.uniform(first, last);
      const std::vector<float> vertices = sampled(motion, ElementKind::kVertices, time);
      for (std::size_t n = 0; n < 2; ++n) {
        auto exact = file.normals(file.weights_at(n, Rational(time)), &file.matrices[n]);
        const auto& m = file.matrices[n];
        const double determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) +
                                   m[8] * (m[1] * m[6] - m[2] * m[5]);
        if (determinant < 0)
          for (exact::Vector& normal : exact)
            for (Rational& component : normal) component = -component;
        judge.add("vertices in the world", std::span(vertices).subspan(3 * n * file.vertices(), 3 * file.vertices()),
                  vertices_of(file, exact));
      }
    }
  }
}

TEST(GltfSamples, are_the_same_on_every_way_that_the_library_has) {
  Judge judge;
  for (int i = 0; i < kFiles / 2; ++i) {
    Random random(kSeed + 2000 + static_cast<std::uint64_t>(i));
    const File file = random_file(random, 1);
    const Motion motion = motion_of(file, i % 2 == 0 ? "0" : "", false).motion;
    const NormalGroups groups =
        NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
    for (std::size_t s = 0; s < motion.segments.size(); ++s) {
      const Segment segment = motion.segment(s);
      const double t = random.uniform(0, 1);
      std::vector<Rational> weights(file.targets.size());
      if (motion.kind == MotionKind::kTargets) {
        weights[s] = Rational(t);
      } else {
        const Rational from(segment.start_time), to(segment.end_time);
        weights = file.weights_at(0, from + Rational(t) * (to - from));
      }
      const auto exact = file.normals(weights, nullptr);
      const auto faces = faces_of(file, exact), vertices = vertices_of(file, exact);
      std::vector<float> result(3 * faces.size()), of_groups(3 * vertices.size());
      const auto view = VectorView<float>::packed(std::span(result));
      const auto group_view = VectorView<float>::packed(std::span(of_groups));
      NormalCurves::of_faces(segment, {}, Threads::kAll).unit_normals(t, view);
      judge.add("curves of faces", result, faces);
      NormalCurves::of_groups(segment, groups, {}, Threads::kOne).unit_normals(t, group_view);
      judge.add("curves of groups", of_groups, vertices);
      NormalRecompute(segment).unit_normals(t, view);
      judge.add("recomputed faces", result, faces);
      NormalRecompute(segment, groups).unit_normals(t, group_view);
      judge.add("recomputed groups", of_groups, vertices);
      MeshNormals of_mesh =
          MeshNormals::make(*segment.topology, {{.kind = ElementKind::kVertices, .weld = false}}).value();
      ASSERT_TRUE(of_mesh.set_segment(segment));
      of_mesh.unit_normals(t, group_view);
      judge.add("normals of the mesh", of_groups, vertices);
      std::vector<ControlNormals> control(faces.size());
      face_control_normals(segment, {0, faces.size()}, control);
      std::vector<Vec3d> reference(faces.size());
      reference_normals(segment, {0, faces.size()}, t, reference);
      for (std::size_t f = 0; f < faces.size(); ++f) view.set(f, to_float(unit(reference[f])));
      judge.add("reference of faces", result, faces, true);
      for (std::size_t v = 0; v < vertices.size(); ++v)
        group_view.set(v, to_float(unit(reference_normal(segment, groups.faces(v), t))));
      judge.add("reference of groups", of_groups, vertices, true);
    }
    CompareOptions options;
    options.schemes = {"polynomial", "recompute"};
    const Comparison comparison = compare(motion, options).value();
    for (const SchemeComparison& row : comparison.schemes) EXPECT_LT(row.quality.max, kMillionth) << row.scheme;
  }
}

}  // namespace
}  // namespace chronormal::gltf_sample_test
