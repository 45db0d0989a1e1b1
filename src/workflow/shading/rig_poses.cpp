// Draws random poses of morph targets. The names of targets are split into words. A word ends before a capital that
// follows a small letter, and at each character that is not a letter. Words for a side (left, right) show which two
// targets are the halves of a symmetric pair.
#include "workflow/shading/rig_poses.h"

#include <algorithm>
#include <array>
#include <random>
#include <string_view>
#include <utility>

#include "core/nearest.h"
#include "core/random_numbers.h"
#include "core/text.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostActive = 7;
constexpr double kSides = 8, kRelated = 3;

constexpr std::array<std::string_view, 11> kMouth = {"jaw",   "mouth", "lip",   "lips", "tongue", "chin",
                                                     "teeth", "cheek", "smile", "pout", "viseme"};
constexpr std::array<std::string_view, 10> kEyes = {"eye",  "eyes", "brow",  "brows",  "lid",
                                                    "lids", "look", "blink", "squint", "pupil"};

enum class Side { kNone, kLeft, kRight };

struct Name {
  std::vector<std::string> words;  // the words of the name, sorted, without those for a side
  Side side = Side::kNone;
};

bool is_small(char c) { return c >= 'a' && c <= 'z'; }
bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

Name name_of(const std::string& text) {
  Name name;
  std::string word;
  const auto end_word = [&] {
    if (word == "l" || word == "left")
      name.side = Side::kLeft;
    else if (word == "r" || word == "right")
      name.side = Side::kRight;
    else if (!word.empty())
      name.words.push_back(word);
    word.clear();
  };
  for (std::size_t n = 0; n < text.size(); ++n) {
    const char c = text[n];
    if (is_capital(c) && n > 0 && !is_capital(text[n - 1])) end_word();
    if (is_capital(c))
      word += static_cast<char>(c - 'A' + 'a');
    else if (is_small(c))
      word += c;
    else
      end_word();
  }
  end_word();
  std::sort(name.words.begin(), name.words.end());
  return name;
}

template <std::size_t N>
bool has_one_of(const Name& name, const std::array<std::string_view, N>& words) {
  return std::any_of(name.words.begin(), name.words.end(), [&](const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  });
}

double togetherness_of(const Name& a, const Name& b) {
  const bool are_sides = a.side != Side::kNone && b.side != Side::kNone && a.side != b.side;
  if (are_sides && a.words == b.words) return kSides;
  const bool share_a_word = std::any_of(a.words.begin(), a.words.end(), [&](const std::string& word) {
    return std::binary_search(b.words.begin(), b.words.end(), word);
  });
  const bool are_near =
      (has_one_of(a, kMouth) && has_one_of(b, kMouth)) || (has_one_of(a, kEyes) && has_one_of(b, kEyes));
  return share_a_word || are_near ? kRelated : 1;
}

}  // namespace

double togetherness(const std::string& a, const std::string& b) { return togetherness_of(name_of(a), name_of(b)); }

RigPoses::RigPoses(std::span<const std::string> names, std::vector<std::size_t> targets, std::size_t target_count,
                   PoseList given)
    : targets_(std::move(targets)),
      target_count_(target_count),
      given_(std::move(given)),
      together_(targets_.size() * targets_.size(), 1.0) {
  if (names.size() != target_count_) return;
  std::vector<Name> taken_apart;
  for (const std::size_t i : targets_) taken_apart.push_back(name_of(names[i]));
  for (std::size_t a = 0; a < targets_.size(); ++a)
    for (std::size_t b = 0; b < targets_.size(); ++b)
      together_[a * targets_.size() + b] = togetherness_of(taken_apart[a], taken_apart[b]);
}

PoseList RigPoses::sample(std::size_t count, unsigned seed) const {
  PoseList poses;
  std::mt19937 random(seed);
  const std::size_t n = targets_.size();
  for (std::size_t p = 0; p < count && (n > 0 || !given_.empty()); ++p) {
    std::vector<double>& pose = poses.emplace_back(target_count_, 0.0);
    if (!given_.empty()) {
      // Draws the two poses between which the result lies. The index given_.size() stands for the rest pose.
      const std::size_t from = random_below(random, given_.size()), to = random_below(random, given_.size() + 1);
      const double part = random_part(random);
      for (std::size_t i = 0; i < target_count_; ++i)
        pose[i] = (1 - part) * given_[from][i] + (to < given_.size() ? part * given_[to][i] : 0);
      continue;
    }
    std::vector<double> chances(n, 1.0);
    const std::size_t active = 1 + random_below(random, std::min(kMostActive, n));
    for (std::size_t k = 0; k < active; ++k) {
      double sum = 0;
      for (const double chance : chances) sum += chance;
      double left = random_part(random) * sum;
      std::size_t drawn = 0;
      for (std::size_t a = 0; a < n; ++a) {
        if (chances[a] == 0) continue;
        drawn = a;
        left -= chances[a];
        if (left < 0) break;
      }
      pose[targets_[drawn]] = 1 - random_part(random);
      // Computes the chance of each target to be drawn next: the sum of togetherness() over the pairs of this target
      // with all targets that are active already.
      for (std::size_t a = 0; a < n; ++a) {
        if (pose[targets_[a]] != 0)
          chances[a] = 0;
        else
          chances[a] = (k == 0 ? 0 : chances[a]) + together_[drawn * n + a];
      }
    }
  }
  return poses;
}

PoseList poses_of_mesh(std::span<const RigPose> poses, const GltfMesh& mesh) {
  PoseList result;
  for (const RigPose& pose : poses) {
    if (pose.in_order.size() == mesh.target_count && mesh.target_count > 0) result.push_back(pose.in_order);
    std::vector<double> weights(mesh.target_count, 0.0);
    bool any = false;
    for (const RigPose::Named& named : pose.named) {
      for (std::size_t i = 0; i < mesh.target_names.size(); ++i) {
        if (mesh.target_names[i] != named.target) continue;
        weights[i] = named.weight;
        any = true;
      }
    }
    if (any) result.push_back(std::move(weights));
  }
  return result;
}

Status check_poses(std::span<const RigPose> poses, const GltfDocument& document) {
  std::vector<std::string> names;
  std::vector<std::size_t> counts;
  for (const GltfMesh& mesh : document.meshes()) {
    names.insert(names.end(), mesh.target_names.begin(), mesh.target_names.end());
    if (mesh.target_count > 0) counts.push_back(mesh.target_count);
  }
  for (const RigPose& pose : poses) {
    for (const RigPose::Named& named : pose.named) {
      if (std::find(names.begin(), names.end(), named.target) != names.end()) continue;
      const std::string nearest = nearest_name(named.target, names);
      return invalid_input(named.place, "no mesh has a target '" + named.target + "'" +
                                            (nearest.empty() ? std::string("; give the name of a target of the file")
                                                             : "; did you mean '" + nearest + "'?"));
    }
    if (!pose.named.empty() || std::find(counts.begin(), counts.end(), pose.in_order.size()) != counts.end()) continue;
    return invalid_input(pose.place, "the pose has " + counted(pose.in_order.size(), "weight", "weights") +
                                         ", but no mesh has as many targets; give weights by the names of targets");
  }
  return Success{};
}

}  // namespace chronormal::inline internal
