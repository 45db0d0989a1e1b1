/// MD2, the animated models of Quake II. The format is little endian, with a header of 17 int32, of which these are
/// read:
///
///     byte  0   "IDP2"            16   bytes of a frame     56   byte of the first frame
///           4   version: 8        24   vertices, V
///          32   triangles, F      40   frames, T            52   byte of the first triangle
///
///     triangle   3 x uint16 vertices, 3 x uint16 texture coordinates
///     frame      3 x float32 scale, 3 x float32 translate, 16 characters of name, V x {3 bytes x y z, 1 byte normal}
///
/// A position is scale * byte + translate, in double, rounded to float32. Frames whose names tell of several clips
/// (stand01, stand02, run1) are an animation that jumps from one clip to the next. Quake lists the corners of a
/// triangle clockwise; the reader reverses this order, so that normals point outwards.
///
/// Threads    pure.
#ifndef CHRONORMAL_IO_CACHE_MD2_H_
#define CHRONORMAL_IO_CACHE_MD2_H_

#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Reads a motion; `name` is for messages. Keyframe k is at k / frames_per_second, minus one frame for each earlier
/// clip, and has the name of the frame ("stand01"). The result is valid (validate() in motion/motion.h).
///
/// The place of an error is "NAME, byte N", followed by the triangle or the frame if it is known. Errors: kInvalidInput
/// for another first word or version, no vertices or triangles, fewer than two frames, tables that do not lie inside
/// the file (all of these before memory is taken), indices without a vertex, and coordinates that are not finite or too
/// large for float32.
[[nodiscard]] Result<Motion> read_md2(std::string_view bytes, const std::string& name, double frames_per_second = 1);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_MD2_H_
