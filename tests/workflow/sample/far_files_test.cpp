// Tests poses of files whose positions are far from each other. Compares their normals with rational numbers that
// follow from the numbers in the files.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/workflow/sample.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"
#include "tests/support/read_input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::far_files_test {
namespace {

using Corners = std::array<std::array<double, 3>, 3>;  // exactly the numbers in a file

enum class Kind { kObj, kPly, kBinaryPly };

std::string text_of(const Corners& corners, Kind kind) {
  std::string text = kind == Kind::kObj   ? ""
                     : kind == Kind::kPly ? "ply\nformat ascii 1.0\n"
                                          : "ply\nformat binary_little_endian 1.0\n";
  if (kind != Kind::kObj)
    text +=
        "element vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
        "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  for (const auto& corner : corners) {
    if (kind == Kind::kBinaryPly) {
      text.append(reinterpret_cast<const char*>(corner.data()), sizeof(corner));
      continue;
    }
    std::array<char, 400> line{};
    std::snprintf(line.data(), line.size(), "%s%.6f %.6f %.6f\n", kind == Kind::kObj ? "v " : "", corner[0], corner[1],
                  corner[2]);
    text += line.data();
  }
  if (kind == Kind::kBinaryPly) return text + std::string("\3\0\1\2", 4);
  return text + (kind == Kind::kObj ? "f 1 2 3\n" : "3 0 1 2\n");
}

// Returns the normal of the triangle that is the sum of the given triangles, each multiplied by its share.
exact::Vector normal_of(const std::vector<Corners>& triangles, const std::vector<exact::Rational>& shares) {
  std::array<exact::Vector, 3> sum;
  for (std::size_t k = 0; k < triangles.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t axis = 0; axis < 3; ++axis) sum[c][axis] += shares[k] * exact::Rational(triangles[k][c][axis]);
  return exact::cross(exact::subtract(sum[1], sum[0]), exact::subtract(sum[2], sum[0]));
}

// Draws a triangle whose coordinates are multiples of `step`. The triangle has a size of at most 2^19 steps, at a
// distance of at most 2^52 steps from the origin, so doubles represent its coordinates.
Corners triangle(fixtures::Random& random, double step) {
  const double far = random.below(3) == 0 ? 0 : std::ldexp(1.0, static_cast<int>(random.below(53)));
  const double size = std::ldexp(1.0, static_cast<int>(random.below(19)));
  for (;;) {
    Corners corners;
    std::array<double, 3> middle{};
    for (double& coordinate : middle) coordinate = std::trunc(random.uniform(-far, far));
    for (auto& corner : corners)
      for (std::size_t axis = 0; axis < 3; ++axis)
        corner[axis] = step * (middle[axis] + std::round(random.uniform(-size, size)));
    if (!exact::is_zero(normal_of({corners}, {1}))) return corners;
  }
}

double error_of(Result<Pose> pose, const exact::Vector& right) {
  if (!pose) {
    ADD_FAILURE() << pose.error().text();
    return 0;
  }
  const std::vector<float>& n = pose.value().normals;
  return exact::angle(n[0], n[1], n[2], right);
}

SampleOptions of_faces() {
  SampleOptions options;
  options.elements.kind = ElementKind::kFaces;
  return options;
}

// Returns the factors by which a pose of targets multiplies the positions of the keyframes: the base, then the targets.
std::vector<exact::Rational> shares_of(const std::vector<double>& weights) {
  std::vector<exact::Rational> shares = {1};
  for (const double weight : weights) {
    shares.emplace_back(weight);
    shares[0] -= shares.back();
  }
  return shares;
}

TEST(FarFiles, keep_their_numbers_at_every_distance_from_the_first) {
  constexpr std::uint64_t kSeed = 20261128;
  std::cout << "  from seed " << kSeed << '\n';
  fixtures::Random random(kSeed);
  const test::TemporaryFolder folder;
  double worst = 0;
  for (int i = 0; i < 400; ++i) {
    const double step = std::ldexp(1.0, static_cast<int>(random.below(7)) - 3);
    const auto kind = static_cast<Kind>(random.below(3));
    std::vector<Corners> triangles;
    std::vector<std::string> files;
    for (std::size_t k = 0; k < 3; ++k) {
      triangles.push_back(triangle(random, step));
      files.push_back(folder.write("k" + std::to_string(k) + (kind == Kind::kObj ? ".obj" : ".ply"),
                                   text_of(triangles.back(), kind)));
    }
    const auto check = [&](Result<Pose> pose, const std::vector<exact::Rational>& shares, const char* what) {
      const exact::Vector right = normal_of(triangles, shares);
      if (exact::is_zero(right)) return;
      const double error = error_of(std::move(pose), right);
      EXPECT_LT(error, 1e-6) << what << ", case " << i << ":\n"
                             << text_of(triangles[0], Kind::kObj) << text_of(triangles[1], Kind::kObj)
                             << text_of(triangles[2], Kind::kObj);
      worst = std::max(worst, error);
    };
    const Motion sequence = test::read_motion(test::files(files)).value();
    NormalSampler in_time = NormalSampler::make(sequence, of_faces()).value();
    const double t = random.uniform(0, 1);
    check(in_time.at_time(1), {0, 1, 0}, "the second keyframe");
    check(in_time.at_time(2), {0, 0, 1}, "the last keyframe");
    check(in_time.at_time(t), {exact::Rational(1) - exact::Rational(t), exact::Rational(t), 0}, "between keyframes");

    const Motion star = test::read_motion(test::targets_over(files[0], {files[1], files[2]})).value();
    NormalSampler sampler = NormalSampler::make(star, of_faces()).value();
    for (const std::vector<double>& weights :
         std::vector<std::vector<double>>{{1, 0}, {0, 1}, {0, 0}, {t, 0.25}, {t, 0}})
      check(sampler.at_weights(weights), shares_of(weights), "weights");
    for (const Motion& motion : {sequence, star}) {
      for (const Motion::Keyframe& keyframe : motion.keyframes)
        EXPECT_TRUE(keyframe.residuals.empty() || std::any_of(keyframe.residuals.begin(), keyframe.residuals.end(),
                                                              [](double residual) { return residual != 0; }));
    }
  }
  std::cout << "  at most " << worst << " rad\n";
}

TEST(FarFiles, targets_of_makehuman_keep_the_digits_of_base_and_delta) {
  constexpr std::uint64_t kSeed = 20261129;
  std::cout << "  from seed " << kSeed << '\n';
  fixtures::Random random(kSeed);
  const test::TemporaryFolder folder;
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    std::vector<Corners> triangles(2);
    std::string base, deltas;
    std::array<double, 3> middle{};
    for (double& coordinate : middle) coordinate = random.uniform(5, 10);
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<float, 6> numbers{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        numbers[axis] = static_cast<float>(middle[axis] + random.uniform(-1e-3, 1e-3));
        numbers[3 + axis] = static_cast<float>(random.uniform(-1e-3, 1e-3));
        triangles[0][c][axis] = double{numbers[axis]};
        triangles[1][c][axis] =
            double{numbers[axis]} + double{numbers[3 + axis]};  // numbers of these sizes have an exact sum
      }
      std::array<char, 400> line{};
      std::snprintf(line.data(), line.size(), "v %.9g %.9g %.9g\n", double{numbers[0]}, double{numbers[1]},
                    double{numbers[2]});
      base += line.data();
      std::snprintf(line.data(), line.size(), "%zu %.9g %.9g %.9g\n", c, double{numbers[3]}, double{numbers[4]},
                    double{numbers[5]});
      deltas += line.data();
    }
    const std::string base_file = folder.write("base.obj", base + "f 1 2 3\n");
    const Motion star =
        test::read_motion(test::targets_over(base_file, {folder.write("moved.target", deltas)})).value();
    NormalSampler sampler = NormalSampler::make(star, of_faces()).value();
    for (const double weight : {1.0, random.uniform(0, 1)}) {
      const exact::Vector right = normal_of(triangles, shares_of({weight}));
      if (exact::is_zero(right)) continue;
      const double error = error_of(sampler.at_weights(std::vector<double>{weight}), right);
      EXPECT_LT(error, 1e-6) << "case " << i << ", weight " << weight << ":\n" << base << deltas;
      worst = std::max(worst, error);
    }
  }
  std::cout << "  at most " << worst << " rad\n";
}

}  // namespace
}  // namespace chronormal::far_files_test
