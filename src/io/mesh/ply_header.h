/// Reads the header of a PLY file, which declares the elements of the file and their encoding. Private to io.
#ifndef CHRONORMAL_IO_MESH_PLY_HEADER_H_
#define CHRONORMAL_IO_MESH_PLY_HEADER_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "io/mesh/ply.h"

namespace chronormal::inline internal::ply {

enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

[[nodiscard]] constexpr std::size_t byte_size(Scalar type) noexcept {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}
[[nodiscard]] constexpr bool is_integer(Scalar type) noexcept {
  return type != Scalar::kFloat32 && type != Scalar::kFloat64;
}

/// The meaning of a property of an element: a coordinate of a position or of a velocity, the vertices of a face, or
/// other data, which are skipped.
enum class Role { kX, kY, kZ, kVelocityX, kVelocityY, kVelocityZ, kIndices, kOther };

struct Property {
  std::string_view name;
  Scalar type{};  ///< type of the value, or of the items of the list
  bool is_list = false;
  Scalar count_type{};  ///< type of the length of the list; only for lists, and always an integer type
  Role role = Role::kOther;
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  PlyEncoding encoding{};
  std::vector<Element> elements;  ///< in the order of the file
  std::size_t vertex_element = 0;
  std::size_t face_element = 0;
  char separator = '\n';       ///< the character that ends a line
  std::size_t body_begin = 0;  ///< offset of the first byte behind the header
  std::size_t line_count = 0;  ///< number of lines in the header
};

/// Reads and checks the header. If there is no error, the file has one element vertex with the scalars x, y, z, and one
/// element face with the list vertex_indices of an integer type, both with a count above 0. The names in the result are
/// views of `bytes`. Errors: those of read_ply(), with the place "NAME, line N".
[[nodiscard]] Result<Header> read_header(std::string_view bytes, const std::string& name);

/// Finds the properties that are velocities, and sets their roles. Returns true if there are velocities. Errors: those
/// of read_moving_ply(), with the place "NAME, header".
[[nodiscard]] Result<bool> assign_velocities(Header& header, const std::string& name);

}  // namespace chronormal::inline internal::ply

#endif  // CHRONORMAL_IO_MESH_PLY_HEADER_H_
