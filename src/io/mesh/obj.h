/// Reads and writes the polygons of Wavefront OBJ.
///
///     v 0 0 0                a vertex: x y z, then any numbers (w, or a colour), which are checked and left out
///     v 1 0 0 \              a line that ends in a backslash goes on in the next one
///       0.5 0.5 0.5
///     v 0 1 0 # comment      a comment ends the line (and is not continued by a backslash)
///     f 1/1/1 2//2 -1        a face of three or more corners: v, v/vt, v//vn or v/vt/vn
///
/// Vertices are counted from 1; -1 is the last vertex before the face. A positive index may name a vertex that follows
/// later. Texture indices must be integers and are left out. All other statements (vt, vp, g, o, usemtl, mtllib, l, p,
/// and unknown words) are left out, too. Lines end in LF, CRLF or CR; a byte order mark is skipped.
///
/// Only read_obj_shading() reads the shading of the mesh:
///
///     vn 0 0 1               a normal, counted as vertices are; f refers to it after the last slash
///     s 1                    a smoothing group, for the faces that follow: a number or a name; off and 0 mean no group
///
/// Shapes     V = vertices; positions are (V, 3).
/// Threads    pure.
#ifndef CHRONORMAL_IO_MESH_OBJ_H_
#define CHRONORMAL_IO_MESH_OBJ_H_

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "io/mesh/mesh_frame.h"

namespace chronormal::inline internal {

/// Reads the mesh of an OBJ file; `name` is for messages.
///
/// The place of an error is "NAME, line N". Errors: kInvalidInput for coordinates that are missing, not numbers, joined
/// to other characters, not finite or too large for float32 (coordinates that are too small become 0); for the index 0
/// and indices without a vertex; and for a file without vertices or without faces. Messages count vertices, faces and
/// corners from 0, and quote indices as in the file.
///
/// A file that was cut off inside its last number, or between two faces, cannot be told from a complete file and is
/// read without an error. Faces of fewer than 3 corners are left out, with a note that counts them. The origin is
/// subtracted from positions. Cost: one pass; memory in proportion to the numbers in the file, independent of the
/// values of indices.
[[nodiscard]] Result<MeshFrame> read_obj(std::string_view bytes, const std::string& name, const Origin& origin = {});

/// Reads the mesh of an OBJ file and its shading. Faces before the first "s" are in no smoothing group.
///
/// A corner with the normal index 0, or with an index for which there is no "vn", gets no normal. Faces after an "s"
/// without a word are in no group. A note counts each of these cases.
///
/// Errors: those of read_obj(); the same errors for a normal (vn) that is not three finite numbers.
[[nodiscard]] Result<MeshFrame> read_obj_shading(std::string_view bytes, const std::string& name,
                                                 const Origin& origin = {});

/// Writes vertices and faces as the text of an OBJ file. Coordinates have the fewest digits that read back as the same
/// float32. If there is an origin, it is added to the coordinates, which then read back as the same double. `positions`
/// must have as many elements as the topology has vertices.
[[nodiscard]] std::string write_obj(const Topology& topology, VectorView<const float> positions,
                                    const Origin& origin = {});

/// Writes an OBJ file with normals: statements vn, and corners of the form v//vn. normal_of_corner must have the index
/// of a normal for each corner of the topology.
[[nodiscard]] std::string write_obj(const Topology& topology, VectorView<const float> positions,
                                    VectorView<const float> normals, std::span<const std::uint32_t> normal_of_corner,
                                    const Origin& origin = {});

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_OBJ_H_
