// The scheme recompute: the cross product, computed again at every t. The formula takes the vertices at t by eq. 1, and
// then the normal by eq. 2. The scheme runs normals/recompute/recompute_faces.h, and counts the operations of its
// formula. The code interpolates two edges instead of three vertices, which gives the same normal, costs less, and
// stays precise far from the origin.

#include "normals/curves/curve_elements.h"
#include "normals/recompute/recompute_faces.h"
#include "schemes/counting.h"
#include "schemes/makers.h"

namespace chronormal::inline internal {
namespace {

template <class S>
struct Edge {
  Vec3<S> at_start, at_end;

  [[nodiscard]] Vec3<S> at(const S& s, const S& t) const { return s * at_start + t * at_end; }
};

class Recompute final : public Scheme {
 public:
  [[nodiscard]] bool needs_faces() const noexcept override { return true; }

  void prepare(const ElementBlock& block) override {
    segment_ = *block.segment;
    elements_ = block.elements;
    corner_count_ = 0;
    for (std::size_t i = 0; i < elements_.count; ++i)
      corner_count_ += segment_.topology->face(elements_.first + i).size();
  }

  std::size_t evaluate(double t, VectorView<float> result) const noexcept override {
    return unit_normals_at(segment_, elements_, t, result);
  }

  [[nodiscard]] bool uses_control_normals() const noexcept override { return false; }
  [[nodiscard]] bool is_exact() const noexcept override { return true; }
  [[nodiscard]] std::size_t fallback_count() const noexcept override { return 0; }

  // Returns the bytes of the indices of all corners, and of six floats for each vertex, three at each end. If the
  // scheme has only a part of the faces, the same part of the vertices counts.
  [[nodiscard]] std::size_t bytes() const noexcept override {
    const std::size_t faces = segment_.topology == nullptr ? 0 : segment_.topology->face_count();
    if (faces == 0) return 0;
    const double share = static_cast<double>(elements_.count) / static_cast<double>(faces);
    const double vertices = share * static_cast<double>(segment_.topology->vertex_count());
    return corner_count_ * sizeof(std::uint32_t) + static_cast<std::size_t>(vertices * 6 * sizeof(float));
  }

  [[nodiscard]] OperationCounts operations() const override {
    using C = Counting;
    const Vec3<C> a0{C(0), C(0), C(0)}, b0{C(0), C(1), C(0)}, c0{C(0), C(0), C(1)};
    const Vec3<C> a1{C(0), C(0), C(0)}, b1{C(0), C(0), C(1)}, c1{C(1), C(0), C(0)};
    C::reset();
    const Edge<C> e{b0 - a0, b1 - a1}, f{c0 - a0, c1 - a1};
    (void)normalized(cross(e.at(C(0.625f), C(0.375f)), f.at(C(0.625f), C(0.375f))));
    return C::counts();
  }

 private:
  Segment segment_;
  IndexRange elements_;
  std::size_t corner_count_ = 0;
};

}  // namespace

std::unique_ptr<Scheme> make_recompute() { return std::make_unique<Recompute>(); }

}  // namespace chronormal::inline internal
