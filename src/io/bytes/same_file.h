/// Which file a path is, whatever it is called: "s.npz" and "./s.npz" are one, links are followed, and the file may be
/// still to be made. Private to io and the program.
#ifndef CHRONORMAL_IO_BYTES_SAME_FILE_H_
#define CHRONORMAL_IO_BYTES_SAME_FILE_H_

#include <sys/types.h>

#include <optional>
#include <string>
#include <tuple>

namespace chronormal::inline internal {

/// The file that is written when a program writes to path: the end of a chain of symbolic links, which need not exist.
[[nodiscard]] std::string follow_links(const std::string& path);

/// A file that exists is known by its device and its inode, and one that does not by those of its folder and its name,
/// which is empty for a file that exists.
using FileKey = std::tuple<dev_t, ino_t, std::string>;

/// The file that writing to path would replace or make; "-" is the standard output. Nothing for pipes and devices,
/// which are not replaced, and for a path that the system tells nothing about.
[[nodiscard]] std::optional<FileKey> key_of_file(const std::string& path);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_SAME_FILE_H_
