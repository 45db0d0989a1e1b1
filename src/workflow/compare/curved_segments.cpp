// Holds the cubics of some segments, and makes a scheme of PathCurves.
#include "workflow/compare/curved_segments.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "chronormal/core/parallel.h"
#include "chronormal/normals/path_curves.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 4096;

// A scheme that shows the exact normals of the curve; it ignores the control normals of straight motion of a block.
class CurveScheme final : public Scheme {
 public:
  explicit CurveScheme(const CurvedSegments& segments) : segments_(segments) {}

  void prepare(const ElementBlock& block) override {
    curves_ = PathCurves(segments_.control_normals(block.segment->index, block.elements));
  }
  std::size_t evaluate(double t, VectorView<float> result) const noexcept override {
    return curves_.unit_normals(t, result);
  }

  [[nodiscard]] bool uses_control_normals() const noexcept override { return false; }
  [[nodiscard]] std::size_t fallback_count() const noexcept override { return 0; }
  [[nodiscard]] std::size_t flagged_count() const noexcept override { return curves_.flagged_count(); }
  [[nodiscard]] std::size_t bytes() const noexcept override { return curves_.bytes(); }
  [[nodiscard]] OperationCounts operations() const override { return exact_curve_operations(); }

 private:
  const CurvedSegments& segments_;
  PathCurves curves_;
};

std::vector<PathErrors> all_errors(const PolynomialSegment<3>& curve) {
  std::vector<PathErrors> errors(curve.topology->face_count());
  parallel_blocks(errors.size(), kBlock, [&](IndexRange faces) {
    const PathTruth truth = path_truth(curve, faces);
    std::copy(truth.errors.begin(), truth.errors.end(), errors.begin() + static_cast<std::ptrdiff_t>(faces.first));
  });
  return errors;
}

}  // namespace

// There are seven products and six sums of vectors, and a division by the length.
OperationCounts exact_curve_operations() noexcept {
  return {.add = 6 * 3 + 2, .multiply = 7 * 3 + 3 + 3, .divide = 1, .sqrt = 1};
}

void CurvedSegments::enter(std::size_t first, std::size_t last) {
  segments_.erase(segments_.begin(), segments_.lower_bound(first));
  for (std::size_t s = first; s <= last; ++s) {
    if (segments_.contains(s)) continue;
    Entered entered{path_segment(*motion_, s, path_), {}};
    const auto start = std::chrono::steady_clock::now();
    if (groups_ != nullptr) {
      entered.of_faces.normals = all_path_normals(entered.curve);
      if (certified_) entered.of_faces.errors = all_errors(entered.curve);
    }
    shared_ns_ = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() *
                 static_cast<double>(thread_count());
    segments_.emplace(s, std::move(entered));
  }
}

void CurvedSegments::face_normals(std::size_t segment, IndexRange range, double t,
                                  std::span<Vec3d> result) const noexcept {
  polynomial_face_normals_at(segments_.find(segment)->second.curve, t, range, result);
}

std::vector<PolynomialNormals<3>> CurvedSegments::control_normals(std::size_t segment, IndexRange range) const {
  const Entered& entered = segments_.find(segment)->second;
  std::vector<PolynomialNormals<3>> result(range.count);
  if (groups_ == nullptr)
    polynomial_face_normals(entered.curve, range, std::span(result));
  else
    polynomial_group_normals<3>(*groups_, entered.of_faces.normals, range, result);
  return result;
}

PathTruth CurvedSegments::truth(std::size_t segment, IndexRange range) const {
  const Entered& entered = segments_.find(segment)->second;
  return groups_ == nullptr ? path_truth(entered.curve, range) : path_truth(*groups_, entered.of_faces, range);
}

std::unique_ptr<Scheme> CurvedSegments::scheme() const { return std::make_unique<CurveScheme>(*this); }

}  // namespace chronormal::inline internal
