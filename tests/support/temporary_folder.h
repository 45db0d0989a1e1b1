/// A temporary folder for a test. The destructor deletes the folder with all its contents.
#ifndef CHRONORMAL_TESTS_SUPPORT_TEMPORARY_FOLDER_H_
#define CHRONORMAL_TESTS_SUPPORT_TEMPORARY_FOLDER_H_

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace chronormal::test {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "chronormal_test_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder: " + name);
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] std::string operator/(std::string_view name) const { return (path_ / name).string(); }

  /// Writes a file into the folder, and returns its path.
  std::string write(std::string_view name, std::string_view bytes) const {  // NOLINT(modernize-use-nodiscard)
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return *this / name;
  }
  /// Returns the number of files and folders in the folder.
  [[nodiscard]] std::size_t entry_count() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

/// Returns all bytes of a file, or "" if it cannot be read.
[[nodiscard]] inline std::string read_whole(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_TEMPORARY_FOLDER_H_
