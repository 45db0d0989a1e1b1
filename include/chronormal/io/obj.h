/// Wavefront OBJ, the polygons of it.
///
///     v 0 0 0                a vertex: x y z, then any numbers (w, or a colour), which are checked and left out
///     v 1 0 0 \              a line that ends in a backslash goes on in the next one
///       0.5 0.5 0.5
///     v 0 1 0 # comment      a comment ends the line (and is not continued by a backslash)
///     f 1/1/1 2//2 -1        a face of three or more corners: v, v/vt, v//vn or v/vt/vn
///
/// Vertices are counted from 1; -1 is the vertex before the face. A positive index may name a vertex that follows
/// later. Texture and normal indices must be integers and are left out; so is every other statement (vt, vn, vp, g,
/// o, s, usemtl, mtllib, l, p, and words unknown). Lines end in LF, CRLF or CR; a byte order mark is passed over.
///
/// Shapes     V = vertices; positions are (V, 3).
/// Threads    pure.
#ifndef CHRONORMAL_IO_OBJ_H_
#define CHRONORMAL_IO_OBJ_H_

#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/io/mesh_frame.h"

namespace chronormal {

/// Reads the mesh of an OBJ file, of which name is the name for messages.
///
/// Errors: kInvalidInput with the place "NAME, line N": coordinates that are missing, no number, glued to something
/// else, not finite or too large for float32 (too small becomes 0); faces of fewer than 3 corners; the index 0 and
/// indices of no vertex; a file without vertices or without faces. Messages count vertices, faces and corners from 0,
/// and quote indices as the file has them. A file that was cut off inside its last number, or between two faces, is
/// still an OBJ file: it is read as the mesh that it describes.
/// Cost: one pass; memory in proportion to the numbers that are there, whatever the indices say.
[[nodiscard]] Result<MeshFrame> read_obj(std::string_view bytes, const std::string& name);

/// Writes vertices and faces as the text of an OBJ file. Coordinates have the fewest digits that read back as the
/// same float32. positions must have as many elements as the topology has vertices.
[[nodiscard]] std::string write_obj(const Topology& topology, VectorView<const float> positions);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_OBJ_H_
