/// Tells which file a path means, whatever it is called: "s.npz" and "./s.npz" are one, links are followed, and the
/// file need not exist yet. Private to io and the program.
#ifndef CHRONORMAL_IO_BYTES_SAME_FILE_H_
#define CHRONORMAL_IO_BYTES_SAME_FILE_H_

#include <sys/types.h>

#include <optional>
#include <string>
#include <tuple>

namespace chronormal::inline internal {

/// Returns the file that a program writes when it writes to path: the end of a chain of symbolic links, which need not
/// exist.
[[nodiscard]] std::string follow_links(const std::string& path);

/// Identifies a file: one that exists by its device and its inode, with an empty name; one that does not exist yet by
/// the device and the inode of its folder, and its name.
using FileKey = std::tuple<dev_t, ino_t, std::string>;

/// Finds the file that writing to path would replace or make; "-" is the standard output. Returns nothing for pipes and
/// devices, which are not replaced, and for a path that the system tells nothing about.
[[nodiscard]] std::optional<FileKey> key_of_file(const std::string& path);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_SAME_FILE_H_
