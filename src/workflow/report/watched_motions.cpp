#include "workflow/report/watched_motions.h"

#include <algorithm>
#include <utility>

#include "workflow/audit/measure.h"

namespace chronormal::inline internal {

void WatchedMotions::Weights::add(std::span<const double> of_sample) {
  for (std::size_t k = 0; k < of_sample.size(); ++k) {
    const auto value = static_cast<float>(of_sample[k]);
    if (value != 0) weights_.push_back({samples_, static_cast<std::uint32_t>(k), value});
  }
  ++samples_;
}

ModelWeights WatchedMotions::Weights::take() {
  ModelWeights result;
  std::vector<std::uint32_t>& targets = result.targets;
  for (const Weight& weight : weights_) targets.push_back(weight.target);
  std::sort(targets.begin(), targets.end());
  targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
  result.values.resize(samples_ * targets.size());
  for (const auto& [sample, target, value] : weights_) {
    const auto column = std::lower_bound(targets.begin(), targets.end(), target) - targets.begin();
    result.values[sample * targets.size() + static_cast<std::size_t>(column)] = value;
  }
  *this = {};
  return result;
}

WatchedMotions::WatchedMotions(std::span<const Viewer> audited, std::span<const Viewer> kept,
                               std::span<const std::uint32_t> vertex_of_corner)
    : vertex_of_corner_(vertex_of_corner) {
  for (const Viewer& viewer : audited) {
    const bool is_kept = std::find(kept.begin(), kept.end(), viewer) != kept.end();
    played_.push_back({&viewer, is_kept, true, {}});
  }
}

void WatchedMotions::add(const AuditSample& sample) {
  if (now_ == nullptr || now_->motions.back().subject_index != sample.subject_index) {
    end();
    begin(sample);
  }
  ModelMotion& motion = now_->motions.back();
  const auto number = static_cast<std::uint32_t>(motion.at.size());
  const auto motion_number = static_cast<std::uint32_t>(now_->motions.size() - 1);
  motion.at.push_back(sample.at);
  motion.worst.push_back(static_cast<float>(sample.error.worst));
  motion.mean.push_back(static_cast<float>(sample.error.mean()));
  if (motion.weights.empty()) {
    motion.segments.push_back(static_cast<std::uint32_t>(sample.segment));
    motion.t.push_back(sample.t);
  } else {
    specified_.add(sample.weights);
    for (std::size_t h = 0; h < played_.size(); ++h) {
      const std::vector<double>& played = sample.played[h];
      played_[h].is_specified &= std::equal(played.begin(), played.end(), sample.weights.begin());
      if (played_[h].is_kept) played_[h].weights.add(played);
    }
  }
  const std::span<const JudgedOutput> outputs = sample.part.outputs();
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::uint32_t v = vertex_of_corner_.empty() ? outputs[i].vertex : vertex_of_corner_[outputs[i].corner];
    if (v >= now_->peaks.size()) now_->peaks.resize(std::size_t{v} + 1);
    if (sample.degrees[i] > now_->peaks[v].degrees) now_->peaks[v] = {sample.degrees[i], motion_number, number};
  }
}

void WatchedMotions::begin(const AuditSample& sample) {
  now_ = &parts_[sample.subject.mesh];
  ModelMotion& motion = now_->motions.emplace_back();
  motion.subject = sample.subject;
  motion.subject_index = sample.subject_index;
  if (!sample.weights.empty()) motion.weights.push_back({{"specification"}, {}, {}});
  const std::span<const std::uint32_t> elements = sample.part.elements();
  motion.least.assign(elements.empty() ? 0 : std::size_t{elements.back()} + 1, 0.0);
  for (std::size_t e = 0; e < elements.size(); ++e) motion.least[elements[e]] = kVanished * sample.largest[e];
}

// Ends the motion that was added last. Viewers that play the same weights get one common list of weights.
void WatchedMotions::end() {
  if (now_ == nullptr || now_->motions.back().weights.empty()) return;
  std::vector<ModelWeights>& weights = now_->motions.back().weights;
  const auto play_alike = [](const ModelWeights& a, const ModelWeights& b) {
    return a.targets == b.targets && a.values == b.values;
  };
  ModelWeights specified = specified_.take();
  weights[0].targets = std::move(specified.targets);
  weights[0].values = std::move(specified.values);
  for (Played& played : played_) {
    ModelWeights own = played.weights.take();
    const auto same = played.is_specified ? weights.begin()
                                          : std::find_if(weights.begin() + 1, weights.end(),
                                                         [&](const ModelWeights& w) { return play_alike(w, own); });
    if (same != weights.end())
      same->viewers.emplace_back(played.viewer->name);
    else if (played.is_kept)
      weights.push_back({{std::string(played.viewer->name)}, std::move(own.targets), std::move(own.values)});
    played.is_specified = true;
  }
}

std::map<std::optional<std::size_t>, WatchedPart> WatchedMotions::take() {
  end();
  now_ = nullptr;
  return std::move(parts_);
}

}  // namespace chronormal::inline internal
