// Prepares a scheme for each block of elements, and evaluates it at any t or plays it in steps, for all blocks.
#include "workflow/sample/scheme_normals.h"

#include <algorithm>
#include <cassert>

#include "chronormal/core/parallel.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kSchemeBlock = 1024;

}  // namespace

Result<std::unique_ptr<Scheme>> scheme_for(const std::string& name, ElementKind kind) {
  auto scheme = make_scheme(name);
  if (scheme && kind != ElementKind::kFaces && scheme.value()->needs_faces())
    return Error{ErrorCode::kUsage, "",
                 name + " needs the edges of faces, so it cannot be used for " + std::string(element_kind_name(kind)) +
                     "; use --elements faces"};
  return scheme;
}

SchemeNormals::SchemeNormals(const Segment& segment, const NormalGroups* groups, const std::string& name)
    : segment_(segment),
      control_normals_(groups ? all_group_control_normals(segment, *groups) : all_face_control_normals(segment)) {
  blocks_.resize(block_count(control_normals_.size(), kSchemeBlock));
  parallel_blocks(control_normals_.size(), kSchemeBlock, [&](IndexRange range) {
    Block& block = blocks_[range.first / kSchemeBlock];
    block.elements = range;
    block.scheme = make_scheme(name).value();
    block.scheme->prepare(
        {&segment_, range, std::span(control_normals_).subspan(range.first, range.count), groups == nullptr});
  });
}

void SchemeNormals::unit_normals(double t, VectorView<float> result) const {
  parallel_for(blocks_.size(),
               [&](std::size_t b) { blocks_[b].scheme->evaluate(t, result.part(blocks_[b].elements)); });
}

void SchemeNormals::played_normals(std::size_t index, std::size_t steps, std::size_t anchor_interval,
                                   VectorView<float> result) {
  assert(index <= steps);
  if (index < played_) played_ = 0;
  parallel_for(blocks_.size(), [&](std::size_t b) {
    Block& block = blocks_[b];
    if (played_ == 0) block.playback = block.scheme->play(0, 1 / static_cast<double>(steps), anchor_interval);
    for (std::size_t i = played_; i <= index; ++i) block.playback->next(result.part(block.elements));
  });
  played_ = index + 1;
}

}  // namespace chronormal::inline internal
