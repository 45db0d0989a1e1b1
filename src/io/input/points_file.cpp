#include "chronormal/io/input.h"

#include "io/bytes/binary.h"
#include "io/bytes/file.h"
#include "io/cache/npy.h"

namespace chronormal {

Result<PointPaths> parse_points(std::string_view bytes, const std::string& name) {
  Result<npy::Array> header = npy::read_header(bytes, bytes.size(), name + ", header");
  if (!header) return header.error();
  npy::Array& array = header.value();
  array.data = bytes.substr(array.data_begin);
  const auto& shape = array.shape;
  const bool moves = shape.size() == 3 && shape[1] == 2 && shape[2] == 3;
  if (array.kind != npy::Kind::kFloat || !(moves || (shape.size() == 2 && shape[1] == 3)))
    return invalid_input(
        name,
        "points must be an array of float32 or float64 with the shape (n, 3), or (n, 2, 3) if they move, but are " +
            array.text());
  const auto count = static_cast<std::size_t>(shape[0]);
  const std::size_t ends = moves ? 2 : 1;
  PointPaths paths;
  paths.from.resize(3 * count);
  paths.to.resize(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t end = 0; end < 2; ++end) {
      const std::size_t at = end < ends ? end : 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double value = array.real(array.is_fortran ? i + count * (at + ends * k) : (i * ends + at) * 3 + k);
        if (const char* const fault = binary::coordinate_fault(value); fault != nullptr) {
          std::string place = name + ", [" + std::to_string(i) + ", ";
          if (moves) place += std::to_string(at) + ", ";
          return invalid_input(place + std::to_string(k) + "]", fault);
        }
        (end == 0 ? paths.from : paths.to)[3 * i + k] = value;
      }
    }
  }
  return paths;
}

Result<PointPaths> read_points_file(const std::string& path) {
  const Result<FileBytes> file = FileBytes::open(path);
  if (!file) return file.error();
  return parse_points(file.value().bytes(), path);
}

}  // namespace chronormal
