/// Unit normals in four bytes, as vertex buffers of renderers hold them.
///
///     Octahedral    x: snorm16 in the low 16 bits, y: snorm16 in the high 16. The unit vector is divided by
///                   |x| + |y| + |z|, which puts it on an octahedron; the lower half is folded over the upper one
///                   (Meyer et al. 2010, "On floating-point normal vectors"). Within 7e-5 rad.
///     Rgb10A2       x, y, z: snorm10 from the lowest bits up, and 2 bits of 0: GL_INT_2_10_10_10_REV,
///                   DXGI R10G10B10A2, VK A2B10G10R10. Within 1.7e-3 rad.
///
/// A component c of snorm N bits is the integer nearest to c (2^(N-1) - 1), in two's complement. (0, 0, 0), the normal
/// of an element that has none, is 0 in Rgb10A2; Octahedral cannot say it, and 0 there is (0, 0, 1).
#ifndef CHRONORMAL_NORMALS_ENCODINGS_H_
#define CHRONORMAL_NORMALS_ENCODINGS_H_

#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"

namespace chronormal {

/// A type of its own for each encoding, so that one cannot be taken for the other; nothing but the four bytes.
struct Octahedral {
  std::uint32_t bits = 0;
  friend bool operator==(const Octahedral&, const Octahedral&) = default;
};
struct Rgb10A2 {
  std::uint32_t bits = 0;
  friend bool operator==(const Rgb10A2&, const Rgb10A2&) = default;
};

/// v must have length 1, or be zero. Pure.
[[nodiscard]] Octahedral encode_octahedral(const Vec3f& v) noexcept;
[[nodiscard]] Rgb10A2 encode_rgb10a2(const Vec3f& v) noexcept;

/// Of length 1, but for the zero of Rgb10A2.
[[nodiscard]] Vec3f decode(Octahedral encoded) noexcept;
[[nodiscard]] Vec3f decode(Rgb10A2 encoded) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_ENCODINGS_H_
