#include "normals/blend/blend_normals.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <utility>

#include "core/blocks.h"
#include "normals/blend/blend_call.h"
#include "normals/blend/blend_scratch.h"
#include "normals/blend/blend_storage.h"

namespace chronormal::inline internal {
namespace {

// Number of elements that a thread computes at a time; a multiple of kBitsOfWord.
constexpr std::size_t kBlockOfElements = 16384;

}  // namespace

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

std::size_t BlendNormals::size() const noexcept { return parts_->storage.terms().size(); }
const BlendSet& BlendNormals::set() const noexcept { return parts_->set; }
const BlendCost& BlendNormals::cost() const noexcept { return parts_->storage.cost(); }

std::size_t BlendNormals::bytes() const noexcept {
  return parts_->storage.bytes() + base_bytes(parts_->shape()) + pose_bytes(parts_->shape());
}

}  // namespace chronormal::inline internal
