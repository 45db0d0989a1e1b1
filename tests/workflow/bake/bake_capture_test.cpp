// Checks the errors of a bake of the captured face with the encoding `smallest`. The test uses instants between keys
// that the bake used neither for fitting nor for judging. The test is skipped unless the environment variable
// CHRONORMAL_DATA names the folder of the face. If CHRONORMAL_FULL is set, all keys of the face are tested instead of
// the first few.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/bake_fixture.h"
#include "tests/support/child_process.h"

namespace chronormal::bake_capture_test {
namespace {

using test::Baked;
using test::GltfPlayer;
using test::Real;
using test::Vector;

constexpr std::size_t kTargets = 57, kMostTargets = 112, kMostTargetsAlone = 80, kBetweenKeys = 8, kKeysOfPart = 7,
                      kGapsApart = 4;
constexpr unsigned kSeed = 20;
constexpr Real kLeastLength = 1e-3L;

// Returns the GLB file with only its first `keys` keys. In the result, target i has the weights that target from[i]
// had.
std::string with_track(const GltfPlayer& player, const std::string& glb, const std::vector<std::size_t>& from,
                       std::size_t keys) {
  auto json = player.json;
  auto& sampler = json["animations"][0]["samplers"][0];
  const std::vector<float> weights = player.accessor(sampler["output"]);
  std::string bin(player.bin());
  const auto& view =
      json["bufferViews"][json["accessors"][sampler["output"].get<std::size_t>()]["bufferView"].get<std::size_t>()];
  const std::size_t at = view.value("byteOffset", std::size_t{0});
  for (std::size_t k = 0; k < weights.size() / kTargets; ++k)
    for (std::size_t i = 0; i < kTargets; ++i)
      std::memcpy(bin.data() + at + 4 * (k * kTargets + i), &weights[k * kTargets + from[i]], 4);
  auto& times = json["accessors"][sampler["input"].get<std::size_t>()];
  times["max"] = {player.accessor(sampler["input"])[keys - 1]};
  times["count"] = keys;
  json["accessors"][sampler["output"].get<std::size_t>()]["count"] = keys * kTargets;
  std::string text = json.dump();
  while (text.size() % 4 != 0) text += ' ';
  std::string result = glb.substr(0, 8);
  const auto add_word = [&](std::size_t word) {
    const auto value = static_cast<std::uint32_t>(word);
    result.append(reinterpret_cast<const char*>(&value), 4);
  };
  add_word(12 + 8 + text.size() + 8 + bin.size());
  add_word(text.size());
  result += "JSON" + text;
  add_word(bin.size());
  result += std::string("BIN\0", 4) + bin;
  return result;
}

struct Errors {
  std::vector<float> degrees;
  std::size_t excused = 0;

  [[nodiscard]] double mean() const {
    double sum = 0;
    for (const float error : degrees) sum += static_cast<double>(error);
    return sum / static_cast<double>(degrees.size());
  }
  // Returns the quantile `part` of the errors, in degrees.
  [[nodiscard]] float at(double part) {
    const auto place = degrees.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(degrees.size() - 1));
    std::nth_element(degrees.begin(), place, degrees.end());
    return *place;
  }
};

// Returns the errors of all vertices in some poses. A pose has the weights before and after the bake. Skips samples
// whose normal is shorter than a thousandth of the normal in the base.
Errors errors_in(const Baked& baked, const std::vector<std::pair<std::vector<double>, std::vector<float>>>& poses) {
  const test::GltfTruth truth(*baked.before, 0);
  const std::vector<Vector> base = truth.normals_at(std::vector<double>(kTargets, 0.0));
  const auto& primitive = baked.after->json["meshes"][0]["primitives"][0];
  Errors errors;
  for (const auto& [own, all] : poses) {
    const std::vector<Vector> right = truth.normals_at(own);
    for (std::size_t v = 0; v < right.size(); ++v) {
      if (!(test::length_of(right[v]) > kLeastLength * test::length_of(base[v]))) {
        ++errors.excused;
        continue;
      }
      const Vector shown = baked.after->shown(primitive, truth.vertices[v].index, all);
      const Vector turned = test::GltfTruth::turn(base[v], truth.vertices[v].stored, right[v]);
      errors.degrees.push_back(static_cast<float>(test::degrees_between(shown, turned)));
    }
  }
  return errors;
}

// Returns the errors at random instants in intervals between neighbouring keys. The test takes every interval whose
// number is a multiple of gaps_apart.
Errors errors_between_keys(const Baked& baked, std::size_t gaps_apart) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> part(0, 1);
  const auto& sampler = baked.before->json["animations"][0]["samplers"][0];
  const std::vector<float> times = baked.before->accessor(sampler["input"]);
  std::vector<std::pair<std::vector<double>, std::vector<float>>> poses;
  for (std::size_t k = 0; k + 1 < times.size(); k += gaps_apart) {
    for (std::size_t n = 0; n < kBetweenKeys; ++n) {
      const auto from = static_cast<double>(times[k]), to = static_cast<double>(times[k + 1]);
      const double time = from + part(random) * (to - from);
      const std::vector<float> own = baked.before->weights_at(0, 0, time);
      poses.emplace_back(std::vector<double>(own.begin(), own.end()), baked.after->weights_at(0, 0, time));
    }
  }
  return errors_in(baked, poses);
}

class BakeCapture : public testing::Test {
 protected:
  void SetUp() override {
    if (test::is_sanitized()) GTEST_SKIP() << "sanitizers make minutes of it";
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    std::ifstream file(std::filesystem::path(folder) / "rigs" / "ict_capture.glb", std::ios::binary);
    std::stringstream bytes;
    bytes << file.rdbuf();
    glb_ = bytes.str();
    ASSERT_GT(glb_.size(), 1000U);
    is_full_ = std::getenv("CHRONORMAL_FULL") != nullptr;
  }

  // Bakes the face with tracks exchanged: target i has the weights of target from[i].
  [[nodiscard]] Baked baked(const std::vector<std::size_t>& from, const BakeOptions& options) const {
    const GltfPlayer player(glb_);
    const std::size_t keys = player.accessor(player.json["animations"][0]["samplers"][0]["input"]).size();
    return test::bake_bytes(with_track(player, glb_, from, is_full_ ? keys : kKeysOfPart), options);
  }
  [[nodiscard]] static BakeOptions options() {
    BakeOptions options;
    options.encoding = BakeEncoding::kSmallest;
    options.most_targets = kMostTargets;
    options.viewers = {kViewers[0]};
    return options;
  }
  [[nodiscard]] static std::vector<std::size_t> own_tracks() {
    std::vector<std::size_t> from(kTargets);
    for (std::size_t i = 0; i < kTargets; ++i) from[i] = i;
    return from;
  }
  void expect_near(const Baked& baked, std::size_t most_targets = kMostTargets) const {
    ASSERT_TRUE(baked.ok()) << baked.error;
    EXPECT_LE(kTargets + baked.report.added_targets, most_targets);
    Errors errors = errors_between_keys(baked, is_full_ ? 1 : kGapsApart);
    EXPECT_GT(errors.degrees.size(), 100 * errors.excused);
    EXPECT_LE(errors.mean(), 0.01);
    EXPECT_LE(errors.at(0.999), 0.15F);
    EXPECT_LE(errors.at(1), 1.0F);
  }

  std::string glb_;
  bool is_full_ = false;
};

TEST_F(BakeCapture, a_captured_face_is_right_between_all_keys_within_112_targets_whichever_target_has_which_track) {
  std::vector<std::size_t> from = own_tracks();
  expect_near(baked(from, options()));
  if (!is_full_) return;
  std::mt19937 random(kSeed);
  for (std::size_t i = kTargets; i-- > 1;) std::swap(from[i], from[random() % (i + 1)]);
  expect_near(baked(from, options()));
}

TEST_F(BakeCapture, all_keys_only_deltas_that_serve_the_animation_alone_need_80_targets) {
  if (!is_full_) GTEST_SKIP() << "all keys only: set CHRONORMAL_FULL=1";
  BakeOptions alone = options();
  alone.most_targets = kMostTargetsAlone;
  alone.animations_only = true;
  expect_near(baked(own_tracks(), alone), kMostTargetsAlone);
}

}  // namespace
}  // namespace chronormal::bake_capture_test
