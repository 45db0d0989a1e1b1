/// Decodes the octahedral filter of EXT_meshopt_compression (its appendix B, filter 1), which keeps unit normals as two
/// numbers.
///
/// Layout     an element is x, y, one, w: signed integers of 8 or 16 bits, 4 or 8 bytes in all, little endian. x and y
///            are the place of the normal on an octahedron unfolded to a square, as fractions of `one`, which itself
///            says how many bits they have: (12, -3, 127, w) or (193, -51, 2047, w). The result is the normal, of
///            length 127 or 32767, in the place of the first three; w stays. An element without a direction (0, 0, 0,
///            w) stays as it is.
/// Precision  the extension leaves the last digit open. Here it is the digit of the decoder that browsers run: npm
///            meshoptimizer, compiled for SIMD, bit for bit. Its other decoders differ from that in one 16-bit number
///            of 2,000 and in no 8-bit number; Debian's library takes a reciprocal square root of 12 bits for 8-bit
///            numbers, which differs from one processor to another.
/// Threads    pure.
///
/// Private to io.
#ifndef CHRONORMAL_IO_GLTF_DECODE_GLTF_OCTAHEDRAL_H_
#define CHRONORMAL_IO_GLTF_DECODE_GLTF_OCTAHEDRAL_H_

#include <cstddef>
#include <string>

namespace chronormal::inline internal::gltf {

/// Decodes all elements of a view in place. stride is the bytes of an element, 4 or 8; the size of bytes must be a
/// multiple of it
void decode_octahedral(std::string& bytes, std::size_t stride) noexcept;

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_DECODE_GLTF_OCTAHEDRAL_H_
