/// Makes PLY files byte by byte, without chronormal's writer.
#ifndef CHRONORMAL_TESTS_SUPPORT_PLY_BYTES_H_
#define CHRONORMAL_TESTS_SUPPORT_PLY_BYTES_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

namespace chronormal::test {

/// Appends values in a chosen byte order.
class ByteWriter {
 public:
  ByteWriter(std::string bytes, bool big_endian) : bytes_(std::move(bytes)), big_endian_(big_endian) {}

  template <class T>
  ByteWriter& add(T value) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (big_endian_ != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
    bytes_.append(raw.data(), raw.size());
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  bool big_endian_;
};

/// Returns a PLY header with the most common properties. `vertices` and `faces` are the numbers of vertices and faces,
/// as text.
[[nodiscard]] inline std::string ply_header(const std::string& encoding, const std::string& vertices,
                                            const std::string& faces) {
  return "ply\nformat " + encoding + " 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

/// Makes a PLY file with three vertices and one triangle.
[[nodiscard]] inline std::string small_binary_ply(bool big_endian) {
  ByteWriter writer(ply_header(big_endian ? "binary_big_endian" : "binary_little_endian", "3", "1"), big_endian);
  for (const float value : {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.5F}) writer.add(value);
  writer.add(std::uint8_t{3});
  for (const std::int32_t vertex : {0, 1, 2}) writer.add(vertex);
  return writer.bytes();
}

/// Makes a PLY file with everything that the format allows: unknown elements before, between and after the faces and
/// the vertices, lists, and every scalar type. The faces, a quad and a triangle, precede the vertices.
[[nodiscard]] inline std::string mixed_binary_ply(bool big_endian) {
  ByteWriter writer(std::string("ply\r\nformat ") + (big_endian ? "binary_big_endian" : "binary_little_endian") +
                        " 1.0\r\ncomment a b c\r\nobj_info d\r\n"
                        "element face 2\r\nproperty uchar material\r\nproperty list ushort uint8 vertex_index\r\n"
                        "property list char float64 weights\r\n"
                        "element extra 2\r\nproperty list int32 int16 ids\r\nproperty double w\r\n"
                        "element nothing 9000000000\r\n"
                        "element vertex 4\r\nproperty float64 x\r\nproperty uint8 red\r\nproperty short y\r\n"
                        "property list uint float rest\r\nproperty uint32 z\r\n"
                        "element tail 1\r\nproperty int8 t\r\nproperty ushort u\r\nend_header\r\n",
                    big_endian);
  writer.add(std::uint8_t{9}).add(std::uint16_t{4});
  for (std::uint8_t vertex = 0; vertex < 4; ++vertex) writer.add(vertex);
  writer.add(std::int8_t{1}).add(0.25);
  writer.add(std::uint8_t{8}).add(std::uint16_t{3});
  for (std::uint8_t vertex = 1; vertex < 4; ++vertex) writer.add(vertex);
  writer.add(std::int8_t{0});
  writer.add(std::int32_t{2}).add(std::int16_t{-1}).add(std::int16_t{5}).add(1.5);
  writer.add(std::int32_t{0}).add(2.5);
  for (std::uint8_t v = 0; v < 4; ++v) {
    writer.add(0.5 * (v + 1)).add(v).add(static_cast<std::int16_t>(-v)).add(std::uint32_t{v});
    for (std::uint8_t i = 0; i < v; ++i) writer.add(static_cast<float>(i));
    writer.add(std::uint32_t{v} + 10);
  }
  writer.add(std::int8_t{-7}).add(std::uint16_t{7});
  return writer.bytes();
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_PLY_BYTES_H_
