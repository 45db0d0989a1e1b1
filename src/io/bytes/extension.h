/// Finds the extension of a file name. Private to io.
#ifndef CHRONORMAL_IO_BYTES_EXTENSION_H_
#define CHRONORMAL_IO_BYTES_EXTENSION_H_

#include <cstddef>
#include <string>
#include <string_view>

#include "io/system/names.h"

namespace chronormal::inline internal {

/// Returns the extension of a file name in lower case and with its dot (".obj"), or an empty text if the name has no
/// extension.
[[nodiscard]] inline std::string lower_extension(std::string_view path) {
  path.remove_prefix(begin_of_name(path));
  const std::size_t dot = path.rfind('.');
  std::string extension(dot == std::string_view::npos ? std::string_view() : path.substr(dot));
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_EXTENSION_H_
