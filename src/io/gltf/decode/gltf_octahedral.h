/// Decodes the octahedral filter of EXT_meshopt_compression (its appendix B, filter 1), which keeps unit normals as two
/// numbers.
///
/// Layout     an element is x, y, one, w: signed integers of 8 or 16 bits, 4 or 8 bytes in all, little endian. x and y
///            are the position of the normal on an octahedron that is unfolded to a square, as fractions of `one`,
///            which thereby tells the number of bits: (12, -3, 127, w) or (193, -51, 2047, w). The result is the
///            normal, with length 127 or 32767, in place of the first three numbers; w does not change. An element
///            without a direction (0, 0, 0, w) does not change either.
/// Precision  the extension leaves the last digit of a number open. Here this digit is always that of the decoder in
///            browsers: npm meshoptimizer, compiled for SIMD. Meshoptimizer's other decoders differ in one 16-bit
///            number of 2,000 and in no 8-bit number; Debian's library uses a reciprocal square root of 12 bits for
///            8-bit numbers, which differs between processors.
/// Threads    pure.
///
/// Private to io.
#ifndef CHRONORMAL_IO_GLTF_DECODE_GLTF_OCTAHEDRAL_H_
#define CHRONORMAL_IO_GLTF_DECODE_GLTF_OCTAHEDRAL_H_

#include <cstddef>
#include <string>

namespace chronormal::inline internal::gltf {

/// Decodes all elements of a view in place. `stride` is the number of bytes of an element, 4 or 8. The size of `bytes`
/// must be a multiple of `stride`.
void decode_octahedral(std::string& bytes, std::size_t stride) noexcept;

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_DECODE_GLTF_OCTAHEDRAL_H_
