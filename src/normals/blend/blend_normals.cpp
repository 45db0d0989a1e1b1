#include "chronormal/normals/blend_normals.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <utility>

#include "core/blocks.h"
#include "normals/blend/blend_call.h"
#include "normals/blend/blend_scratch.h"
#include "normals/blend/blend_storage.h"

namespace chronormal {
namespace {

// Number of elements that a thread computes at a time; a multiple of kBitsOfWord.
constexpr std::size_t kBlockOfElements = 16384;

}  // namespace

std::string_view name_of(BlendPath path) noexcept {
  switch (path) {
    case BlendPath::kTerms:
      return "terms";
    case BlendPath::kTouched:
      return "touched";
    case BlendPath::kWhole:
      return "whole";
  }
  return "";
}

BlendCost predict_blend_cost(const BlendSet& set, const BlendNormalsOptions& options) {
  return BlendStorage(set, nullptr, options.max_bytes).cost();
}

BlendCost predict_blend_cost(const BlendSet& set, const NormalGroups& groups, const BlendNormalsOptions& options) {
  return BlendStorage(set, &groups, options.max_bytes).cost();
}

struct BlendNormals::Parts {
  Parts(BlendSet the_set, std::optional<NormalGroups> the_groups, const BlendNormalsOptions& the_options)
      : set(std::move(the_set)),
        groups(std::move(the_groups)),
        options(the_options),
        storage(set, groups ? &*groups : nullptr, options.max_bytes),
        base(make_blend_base(set, storage.terms())),
        pose(set, shape()) {
    storage.fill();
  }

  [[nodiscard]] BlendShape shape() const {
    return {storage.terms().size(), set.topology.vertex_count(), set.targets.size(), storage.large_faces().size(),
            in_float32()};
  }
  [[nodiscard]] bool in_float32() const { return options.in_float32 && storage.rings().left_out().empty(); }
  [[nodiscard]] BlendInput source() const {
    return {set, groups ? &*groups : nullptr, storage, base, options.forced, in_float32()};
  }

  BlendSet set;
  std::optional<NormalGroups> groups;  // no value if the elements are faces
  BlendNormalsOptions options;
  BlendStorage storage;
  BlendBase base;
  BlendPose pose;
};

BlendNormals::BlendNormals(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
BlendNormals::BlendNormals(BlendNormals&&) noexcept = default;
BlendNormals& BlendNormals::operator=(BlendNormals&&) noexcept = default;
BlendNormals::~BlendNormals() = default;

BlendNormals BlendNormals::of_faces(BlendSet set, const BlendNormalsOptions& options) {
  return BlendNormals(std::make_unique<Parts>(std::move(set), std::nullopt, options));
}

BlendNormals BlendNormals::of_groups(BlendSet set, NormalGroups groups, const BlendNormalsOptions& options) {
  return BlendNormals(std::make_unique<Parts>(std::move(set), std::move(groups), options));
}

BlendChoice BlendNormals::set_weights(std::span<const double> weights, Threads threads) {
  assert(weights.size() == set().targets.size());
  return internal::set_weights(parts_->source(), weights, parts_->pose, threads);
}

BlendEvaluation BlendNormals::unit_normals(IndexRange elements, VectorView<float> result) const noexcept {
  assert(elements.first % kBitsOfWord == 0 && elements.end() <= size() && result.count == elements.count);
  return evaluate(parts_->source(), parts_->pose, elements, result);
}

BlendEvaluation BlendNormals::unit_normals(std::span<const double> weights, VectorView<float> result, Threads threads) {
  assert(result.count == size());
  BlendEvaluation done{set_weights(weights, threads)};
  std::atomic<std::size_t> recomputed = 0, zeros = 0, uncertain = 0;
  blocks_on(threads, size(), kBlockOfElements, [&](IndexRange elements) {
    const BlendEvaluation part = unit_normals(elements, result.part(elements));
    recomputed += part.recomputed_elements;
    zeros += part.zeros;
    uncertain += part.uncertain_elements;
  });
  done.recomputed_elements = recomputed;
  done.zeros = zeros;
  done.uncertain_elements = uncertain;
  return done;
}

std::vector<BlendEvaluation> BlendNormals::unit_normals(std::span<const double> weights,
                                                        std::span<const VectorView<float>> results, Threads threads) {
  const std::size_t targets = set().targets.size();
  assert(weights.size() == results.size() * targets);
  std::vector<BlendEvaluation> done(results.size());
  const BlendInput source = parts_->source();
  // Thread `hand` computes the rows hand, hand + hands, hand + 2 hands and so on, with a pose of its own.
  const std::size_t hands = threads == Threads::kOne ? 1 : std::min(thread_count(), results.size());
  std::vector<BlendPose> poses;
  for (std::size_t hand = 1; hand < hands; ++hand) poses.emplace_back(set(), parts_->shape());
  const auto work = [&](std::size_t hand) {
    BlendPose& own = hand == 0 ? parts_->pose : poses[hand - 1];
    for (std::size_t row = hand; row < results.size(); row += hands) {
      internal::set_weights(source, weights.subspan(row * targets, targets), own, Threads::kOne);
      done[row] = evaluate(source, own, {0, size()}, results[row]);
    }
  };
  if (hands <= 1)
    work(0);
  else
    parallel_for(hands, work);
  return done;
}

BlendChoice BlendNormals::choose(std::span<const double> weights) const {
  assert(weights.size() == set().targets.size());
  const BlendShape shape = parts_->shape();
  BlendPose pose({}, {shape.elements, 0, shape.targets, 0, false});
  return choose_path(parts_->source(), weights, pose);
}

Status BlendNormals::add_target(BlendTarget target) {
  if (Status status = validate(target, set().topology, set().targets.size()); !status) return status;
  parts_->set.targets.push_back(std::move(target));
  parts_->storage.target_added();
  parts_->pose.is_active.resize(set().targets.size());
  parts_->pose.active.reserve(set().targets.size());
  parts_->pose.weights.resize(set().targets.size());
  return Success{};
}

std::size_t BlendNormals::size() const noexcept { return parts_->storage.terms().size(); }
const BlendSet& BlendNormals::set() const noexcept { return parts_->set; }
const BlendCost& BlendNormals::cost() const noexcept { return parts_->storage.cost(); }

std::size_t BlendNormals::bytes() const noexcept {
  return parts_->storage.bytes() + base_bytes(parts_->shape()) + pose_bytes(parts_->shape());
}

}  // namespace chronormal
