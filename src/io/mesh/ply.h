/// Reads and writes PLY, the Stanford polygon format: ascii, and binary in little endian and big endian.
///
///     ply
///     format ascii 1.0
///     comment lines of comment and obj_info may be anywhere
///     element vertex 3                         elements in any order
///     property float x                         x, y, z of any scalar type; other properties are skipped
///     property float y
///     property float z
///     element face 1
///     property list uchar int vertex_indices   or vertex_index; integer types, counted from 0
///     end_header
///     0 0 0                                    ascii: one line for each row of an element
///     1 0 0
///     0 1 0
///     3 0 1 2
///
/// Elements other than vertex and face are skipped, but must be complete. Data after the last element are ignored.
/// Header lines end in LF, CRLF or CR. The scalar types are char uchar short ushort int uint float double, and int8
/// uint8 int16 uint16 int32 uint32 float32 float64. Numbers of type double are rounded to float32, after the origin was
/// subtracted.
///
/// Shapes     V = vertices; positions are (V, 3).
/// Threads    pure.
#ifndef CHRONORMAL_IO_MESH_PLY_H_
#define CHRONORMAL_IO_MESH_PLY_H_

#include <span>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "io/mesh/mesh_frame.h"

namespace chronormal::inline internal {

enum class PlyEncoding { kAscii, kBinaryLittleEndian, kBinaryBigEndian };

/// Reads the mesh of a PLY file; `name` is for messages.
///
/// The place of an error is "NAME, line N" (header, ascii) or "NAME, byte N" (binary), followed by element and row if
/// they are known ("cube.ply, byte 310, face 17"). Errors: kInvalidInput for a header that breaks the grammar or
/// declares something twice; no vertices, no x, y, z, or no faces with vertex_indices; triangle strips; counts for
/// which there are too few bytes (refused before memory is allocated); data that end early; coordinates that are not
/// numbers, not finite or too large for float32; indices without a vertex; in ascii, a row that ends inside a line,
/// with numbers after it.
///
/// Faces of fewer than 3 corners are left out, with a note that counts them. In ascii, a row may continue over several
/// lines. A file that was cut off is an error, with one exception: the last number of an ascii file may lose digits and
/// still be a number. Cost: one pass; memory in proportion to the size of the file.
[[nodiscard]] Result<MeshFrame> read_ply(std::string_view bytes, const std::string& name, const Origin& origin = {});

/// Reads a mesh with the velocities of vertices, which are properties of any scalar type: vx, vy, vz or velocity_x,
/// velocity_y, velocity_z. If a file has both sets, vx, vy, vz are used. Errors: those of read_ply(); kInvalidInput if
/// only some of the three properties exist, if one is a list, and for velocities that are not numbers, not finite or
/// too large for float32.
[[nodiscard]] Result<MeshFrame> read_moving_ply(std::string_view bytes, const std::string& name,
                                                const Origin& origin = {});

/// Writes a PLY file with one list of indices for each face. Positions are float x, y, z. If there is an origin, it is
/// added to the positions, which are then double. In ascii, coordinates have the fewest digits that read back as the
/// same float32. `positions` must have as many elements as the topology has vertices.
[[nodiscard]] std::string write_ply(const Topology& topology, VectorView<const float> positions, PlyEncoding encoding,
                                    const Origin& origin = {});

/// Data to write besides positions and faces; empty members are left out. Normals become the properties float nx, ny,
/// nz. `quality` becomes the property float quality, which programs can show as colours.
struct PlyProperties {
  VectorView<const float> of_vertices;                           ///< one normal for each vertex, after x, y, z
  VectorView<const float> of_faces;                              ///< one normal for each face, after its indices
  std::span<const float> quality_of_vertices, quality_of_faces;  ///< one number for each vertex or face
};

/// Writes a PLY file with positions, faces, and the data in `properties`.
[[nodiscard]] std::string write_ply(const Topology& topology, VectorView<const float> positions,
                                    const PlyProperties& properties, PlyEncoding encoding, const Origin& origin = {});

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_PLY_H_
