// Decides in lanes of double which faces are not certainly usual (face_glance.h). The operations are the same as in
// is_far_from_collapse() and in plain comparisons.
#include "analysis/signs/kernels/face_glance.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/signs/kernels/face_glance.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "analysis/signs/near_collapse.h"
#include "simd/intrinsics-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

HWY_INLINE Doubles LargestOf(const Doubles3& v) { return LargerAbs(LargerAbs(v.x, v.y), v.z); }

std::uint32_t UnusualFaces(const EdgedTile& tile, const GlanceLimits& limits) {
  std::uint32_t usual = 0;
  for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) {
    const auto load = [&tile, lane](std::size_t k) HWY_ATTR {
      return Doubles3{hn::Load(kDoubles, tile.normals[k] + lane), hn::Load(kDoubles, tile.normals[k + 1] + lane),
                      hn::Load(kDoubles, tile.normals[k + 2] + lane)};
    };
    const Doubles3 n0 = load(0), m = load(3), n1 = load(6);
    const Doubles longest = hn::PromoteTo(kDoubles, hn::Load(HalfFloatTag(), tile.longest + lane));
    const Doubles size0 = LargestOf(n0), size1 = LargestOf(n1);
    const auto are_long = hn::And(hn::Gt(size0, hn::Mul(hn::Set(kDoubles, limits.length_from), longest)),
                                  hn::Gt(size1, hn::Mul(hn::Set(kDoubles, limits.length_to), longest)));

    const Doubles along = Dot(n0, n1), squares = hn::Mul(Dot(n0, n0), Dot(n1, n1));
    const auto turn_less =
        hn::And(hn::Gt(along, hn::Zero(kDoubles)),
                hn::Gt(hn::Mul(along, along), hn::Mul(hn::Set(kDoubles, limits.square_of_cosine), squares)));

    const Doubles3 w = n0 + n1;
    const Doubles least = hn::Min(hn::Min(Dot(n0, w), Dot(m, w)), Dot(n1, w));
    const Doubles most = hn::Max(hn::Max(size0, LargestOf(m)), size1);
    const Doubles length = hn::Add(hn::Add(hn::Abs(w.x), hn::Abs(w.y)), hn::Abs(w.z));
    const auto are_far = hn::Gt(least, hn::Mul(hn::Mul(hn::Set(kDoubles, 2 * kCollapseShare), most), length));

    usual |= BitsOf(kDoubles, hn::And(hn::And(are_long, turn_less), are_far)) << lane;
  }
  return ~usual & ((std::uint32_t{1} << kTile) - 1);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(UnusualFaces);

std::uint32_t unusual_faces(const EdgedTile& tile, const GlanceLimits& limits) noexcept {
  return HWY_DYNAMIC_DISPATCH(UnusualFaces)(tile, limits);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
