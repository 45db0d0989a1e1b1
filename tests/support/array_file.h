/// Reads .npy and .npz files by a parser that shares no code with chronormal. The parser accepts only files in the form
/// that chronormal writes.
#ifndef CHRONORMAL_TESTS_SUPPORT_ARRAY_FILE_H_
#define CHRONORMAL_TESTS_SUPPORT_ARRAY_FILE_H_

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace chronormal::test {

struct ArrayFile {
  std::string type;                ///< such as "<f4"
  std::vector<std::size_t> shape;  ///< the length of each dimension; the elements are in C order
  std::string elements;            ///< the bytes of all elements

  template <class T>
  [[nodiscard]] std::vector<T> as() const {
    std::vector<T> values(elements.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), elements.data(), values.size() * sizeof(T));
    return values;
  }
};

[[nodiscard]] inline std::size_t little_endian(const std::string& bytes, std::size_t at, std::size_t count) {
  std::size_t value = 0;
  for (std::size_t i = count; i > 0; --i) value = value << 8 | static_cast<unsigned char>(bytes.at(at + i - 1));
  return value;
}

/// Parses an array in the .npy format. Throws if the file has a form that chronormal does not write, or if the number
/// of elements does not match the shape.
[[nodiscard]] inline ArrayFile parse_npy(const std::string& bytes) {
  if (bytes.compare(0, 8, std::string("\x93NUMPY\1\0", 8)) != 0) throw std::runtime_error("no .npy file");
  const std::size_t begin = 10 + little_endian(bytes, 8, 2);
  if (begin % 64 != 0) throw std::runtime_error("the elements are not aligned");
  const std::string header = bytes.substr(10, begin - 10);
  ArrayFile file;
  const auto after = [&header](const std::string& key) {
    const std::size_t at = header.find(key);
    if (at == std::string::npos) throw std::runtime_error("no " + key);
    return header.substr(at + key.size());
  };
  const std::string type = after("'descr': '");
  file.type = type.substr(0, type.find('\''));
  (void)after("'fortran_order': False");
  std::string shape = after("'shape': (");
  shape = shape.substr(0, shape.find(')'));
  std::size_t size = static_cast<std::size_t>(file.type.back() - '0');
  std::istringstream lengths(shape);
  for (std::string length; std::getline(lengths, length, ',');) {
    if (length.find_first_of("0123456789") == std::string::npos) continue;  // the end of "(5,)" has no length
    file.shape.push_back(std::stoul(length));
    size *= file.shape.back();
  }
  file.elements = bytes.substr(begin);
  if (file.elements.size() != size) throw std::runtime_error("the shape is not that of the elements");
  return file;
}

/// Returns the arrays of an .npz file by name. Reads the members one after the other, without the zip directory.
[[nodiscard]] inline std::map<std::string, ArrayFile> parse_npz(const std::string& bytes) {
  std::map<std::string, ArrayFile> arrays;
  std::size_t at = 0;
  while (bytes.compare(at, 4, "PK\3\4") == 0) {
    if (little_endian(bytes, at + 8, 2) != 0) throw std::runtime_error("the member is not stored");
    const std::size_t size = little_endian(bytes, at + 18, 4), name_size = little_endian(bytes, at + 26, 2);
    const std::size_t data = at + 30 + name_size + little_endian(bytes, at + 28, 2);
    const std::string name = bytes.substr(at + 30, name_size);
    arrays[name.substr(0, name.rfind(".npy"))] = parse_npy(bytes.substr(data, size));
    at = data + size;
  }
  return arrays;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_ARRAY_FILE_H_
