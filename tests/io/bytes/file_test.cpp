#include "io/bytes/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "chronormal/io/output.h"
#include "io/bytes/output_file.h"
#include "io/system/temporary_file.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::file_test {
namespace {

using test::read_whole;
using test::TemporaryFolder;

std::string error_of(const Status& status) {
  if (status) return "no error";
  EXPECT_EQ(status.error().code, ErrorCode::kFailed);
  return status.error().text();
}

mode_t permissions_of(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0);
  return status.st_mode & 07777;
}

// Returns more bytes than the buffer of a pipe can hold.
std::string many_bytes() {
  std::string bytes(3000001, ' ');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 + i / 251);
  return bytes;
}

// A file descriptor that refers to another file as long as this object lives.
class Redirect {
 public:
  Redirect(int from, int to) : from_(from), saved_(::dup(from)) {
    std::fflush(stdout);  // flushes the earlier output of the test program
    ::dup2(to, from);
  }
  Redirect(const Redirect&) = delete;
  Redirect& operator=(const Redirect&) = delete;
  ~Redirect() {
    ::dup2(saved_, from_);
    ::close(saved_);
  }

 private:
  int from_, saved_;
};

TEST(FileBytes, are_all_bytes_of_a_file_and_survive_a_move) {
  const TemporaryFolder folder;
  const std::string bytes = many_bytes();
  Result<FileBytes> file = FileBytes::open(folder.write("a", bytes));
  ASSERT_TRUE(file.ok()) << file.error().text();
  FileBytes moved = std::move(file).value();
  EXPECT_TRUE(moved.bytes() == bytes);
  moved = FileBytes::open(folder.write("b", "two")).value();
  EXPECT_EQ(moved.bytes(), "two");
  EXPECT_EQ(FileBytes::open(folder.write("empty", "")).value().bytes(), "");
}

TEST(FileBytes, pipe_and_standard_input_are_read_to_the_end) {
  const TemporaryFolder folder;
  const std::string bytes = many_bytes();
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const bool as_stdin : {false, true}) {
    // write_output() must write into the pipe, and must not replace the pipe by a file.
    std::thread writer([&] { EXPECT_TRUE(write_output(pipe, bytes, false).ok()); });
    if (as_stdin) {
      const int opened = ::open(pipe.c_str(), O_RDONLY);
      const Redirect redirect(STDIN_FILENO, opened);
      EXPECT_TRUE(FileBytes::open("-").value().bytes() == bytes);
      ::close(opened);
    } else {
      EXPECT_TRUE(FileBytes::open(pipe).value().bytes() == bytes);
    }
    writer.join();
  }
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_EQ(folder.entry_count(), 1U);
}

TEST(FileBytes, file_of_unknown_size_is_read_to_the_end) {
  EXPECT_NE(FileBytes::open("/proc/self/status").value().bytes().find("Pid:"), std::string_view::npos);
}

TEST(FileBytes, bytes_in_memory_are_found_by_their_names_and_not_copied) {
  const std::string bytes = "some";
  const auto resolve = [&](const std::string& name) -> Result<std::string_view> {
    if (name == "a") return std::string_view(bytes);
    return Error{ErrorCode::kFailed, name, "there is none of this name"};
  };
  const Result<FileBytes> file = FileBytes::open("a", resolve);
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file.value().bytes().data(), bytes.data());
  EXPECT_EQ(FileBytes::open("b", resolve).error().text(), "b: there is none of this name");
}

TEST(FileBytes, devices_are_refused_but_for_terminals) {
  for (const char* const device : {"/dev/zero", "/dev/urandom", "/dev/full"}) {
    const Result<FileBytes> file = FileBytes::open(device);
    ASSERT_FALSE(file.ok()) << device;
    EXPECT_EQ(file.error().code, ErrorCode::kFailed);
    EXPECT_EQ(file.error().text(),
              device + std::string(": this is a device, whose data may never end; name a regular file"));
  }
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::grantpt(terminal) | ::unlockpt(terminal), 0);
  const std::string name = ::ptsname(terminal);
  ASSERT_EQ(::write(terminal, "typed\n\4", 7), 7) << "and the key that ends it";
  EXPECT_EQ(FileBytes::open(name).value().bytes(), "typed\n");
  ::close(terminal);
}

TEST(FileBytes, streams_are_read_up_to_a_limit) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::size_t most : {std::size_t{99999}, std::size_t{100000}}) {
    std::thread writer([&] {
      const auto old_handler = std::signal(SIGPIPE, SIG_IGN);
      const bool is_read = write_output(pipe, std::string(100000, 'x'), false).ok();
      EXPECT_TRUE(is_read || most < 100000);
      std::signal(SIGPIPE, old_handler);
    });
    const Result<FileBytes> file = FileBytes::open(pipe, most);
    writer.join();
    EXPECT_EQ(file.ok(), most == 100000);
    if (!file) {
      EXPECT_EQ(file.error().text(),
                pipe + ": the stream is longer than 99,999 bytes; save its data to a file, and name that file");
    }
  }
  const std::string mapped = folder.write("file", std::string(100000, 'x'));
  EXPECT_TRUE(FileBytes::open(mapped, 10).ok()) << "a file has an end";
}

TEST(FileBytes, missing_file_and_folder_are_errors_with_the_path) {
  const TemporaryFolder folder;
  const Result<FileBytes> missing = FileBytes::open(folder / "no");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::kFailed);
  EXPECT_EQ(missing.error().text(), folder / "no" + ": No such file or directory");
  const Result<FileBytes> directory = FileBytes::open(folder.path());
  ASSERT_FALSE(directory.ok());
  EXPECT_EQ(directory.error().text(), folder.path() + ": this is a folder; name a file");
}

TEST(WriteOutput, new_file_has_the_permissions_of_the_umask) {
  const TemporaryFolder folder;
  const mode_t before = ::umask(027);
  EXPECT_TRUE(write_output(folder / "a", "bytes", false).ok());
  ::umask(before);
  EXPECT_EQ(read_whole(folder / "a"), "bytes");
  EXPECT_EQ(permissions_of(folder / "a"), 0640U);
  EXPECT_EQ(folder.entry_count(), 1U);
}

TEST(WriteOutput, pieces_of_any_size_become_one_file) {
  const TemporaryFolder folder;
  const std::string large = many_bytes(), block(std::size_t{1} << 16, 'b'), almost(block.size() - 1, 'a');
  const std::vector<std::string_view> pieces = {"",     "a", large, "b",    "c", "",   block,
                                                almost, "d", "e",   almost, "",  block};
  std::string whole;
  for (const std::string_view piece : pieces) whole += piece;
  EXPECT_TRUE(write_output(folder / "a", pieces, false).ok());
  EXPECT_TRUE(read_whole(folder / "a") == whole);
  EXPECT_TRUE(write_output(folder / "none", std::vector<std::string_view>(), false).ok());
  EXPECT_EQ(std::filesystem::file_size(folder / "none"), 0U);
}

TEST(WriteOutput, stream_is_what_is_no_file_to_replace) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const std::string& path : {std::string("-"), std::string("/dev/stdout"), std::string("/dev/fd/7"),
                                  std::string("/dev/null"), folder / "pipe"})
    EXPECT_TRUE(is_stream(path)) << path;
  for (const std::string& path : {folder.write("a", ""), folder / "none", folder.path(), std::string()})
    EXPECT_FALSE(is_stream(path)) << path;
}

TEST(WriteOutput, existing_file_is_kept_without_force_and_replaced_with_it) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a", "old");
  ASSERT_EQ(::chmod(path.c_str(), 0604), 0);
  const std::string refusal = path + ": the file exists already; add --force to overwrite it";
  EXPECT_EQ(error_of(write_output(path, "new", false)), refusal);
  EXPECT_EQ(error_of(check_output(path, false)), refusal);
  EXPECT_EQ(read_whole(path), "old");
  EXPECT_TRUE(check_output(path, true).ok());
  EXPECT_TRUE(write_output(path, "new", true).ok());
  EXPECT_EQ(read_whole(path), "new");
  EXPECT_EQ(permissions_of(path), 0604U);
  EXPECT_EQ(folder.entry_count(), 1U);
}

TEST(WriteOutput, replaced_file_stays_whole_for_who_has_it_open) {
  const TemporaryFolder folder;
  const std::string old = many_bytes();
  const std::string path = folder.write("a", old);
  const FileBytes before = FileBytes::open(path).value();
  EXPECT_TRUE(write_output(path, "new", true).ok());
  EXPECT_TRUE(before.bytes() == old);
}

TEST(WriteOutput, symbolic_link_stays_and_its_target_is_written) {
  const TemporaryFolder folder;
  const TemporaryFolder elsewhere;
  const std::string target = elsewhere.write("target", "old");
  std::filesystem::create_symlink(target, folder / "middle");
  std::filesystem::create_symlink("middle", folder / "link");
  EXPECT_NE(error_of(write_output(folder / "link", "new", false)).find("--force"), std::string::npos);
  EXPECT_TRUE(write_output(folder / "link", "new", true).ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "middle"));
  EXPECT_EQ(read_whole(target), "new");

  std::filesystem::create_symlink(elsewhere / "not_yet", folder / "dangling");
  EXPECT_TRUE(write_output(folder / "dangling", "made", false).ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "dangling"));
  EXPECT_EQ(read_whole(elsewhere / "not_yet"), "made");

  std::filesystem::create_symlink("loop", folder / "loop");
  EXPECT_NE(error_of(write_output(folder / "loop", "x", true)), "no error");
}

TEST(WriteOutput, full_device_is_an_error_and_null_device_is_written_directly) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  EXPECT_EQ(error_of(write_output("/dev/full", "bytes", false)), "/dev/full: No space left on device");
  EXPECT_TRUE(write_output("/dev/null", "bytes", false).ok());
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  const int full = ::open("/dev/full", O_WRONLY);
  std::string error;
  {
    const Redirect redirect(STDOUT_FILENO, full);
    error = error_of(write_output("-", "bytes", false));
  }
  ::close(full);
  EXPECT_EQ(error, "<stdout>: No space left on device");
}

// A socket on which nobody listens cannot be opened as a file, and an output must not replace the socket.
TEST(WriteOutput, a_socket_is_no_place_for_a_file) {
  const TemporaryFolder folder;
  const std::string path = folder / "socket";
  // The path of a socket has at most 107 bytes, and the path of the folder may be longer. The test therefore names the
  // folder by a descriptor.
  const int descriptor = ::open(folder.path().c_str(), O_PATH | O_DIRECTORY);
  const std::string name = "/proc/self/fd/" + std::to_string(descriptor) + "/socket";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  name.copy(address.sun_path, name.size());
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  EXPECT_EQ(error_of(write_output(path, "bytes", true)), path + ": No such device or address");
  ::close(socket);
  ::close(descriptor);
  EXPECT_TRUE(std::filesystem::is_socket(path));
  EXPECT_EQ(folder.entry_count(), 1U);
}

TEST(OutputFile, a_link_to_itself_is_not_gone_on_with) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("loop", folder / "loop");
  const Result<OutputFile> file = OutputFile::go_on(folder / "loop", true, 0);
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().text(), folder / "loop" + ": Too many levels of symbolic links");
}

TEST(OutputFile, a_folder_that_is_gone_at_the_end_is_an_error) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "there");
  Result<OutputFile> file = OutputFile::create(folder / "there/out", false);
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file.value().append("bytes").ok());
  std::filesystem::remove_all(folder / "there");
  EXPECT_EQ(error_of(file.value().finish()), folder / "there/out" + ": No such file or directory");
}

TEST(PositionedFile, a_place_that_no_file_has_is_an_error_with_the_path) {
  const TemporaryFolder folder;
  const std::optional<PositionedFile> file = PositionedFile::open(folder.write("a", "bytes"));
  ASSERT_TRUE(file.has_value());
  std::string bytes(2, '?');
  EXPECT_TRUE(file->read(3, bytes).ok());
  EXPECT_EQ(bytes, "es");
  EXPECT_EQ(error_of(file->read(std::uint64_t{1} << 63U, bytes)), folder / "a" + ": Invalid argument");
}

TEST(WriteOutput, standard_output_and_its_other_names_are_streams) {
  const TemporaryFolder folder;
  const int file = ::open((folder / "out").c_str(), O_WRONLY | O_CREAT, true);
  bool all_ok = true;
  {
    const Redirect redirect(STDOUT_FILENO, file);
    for (const char* const name : {"-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"})
      all_ok = all_ok && write_output(name, "1", false).ok();
  }
  ::close(file);
  EXPECT_TRUE(all_ok);
  EXPECT_EQ(read_whole(folder / "out"), "1111");
}

TEST(WriteOutput, failure_leaves_no_temporary_and_the_old_file) {
  const TemporaryFolder folder;
  EXPECT_EQ(error_of(write_output(folder.path(), "x", true)), folder.path() + ": this is a folder; name a file");
  EXPECT_NE(
      error_of(write_output(folder / "no/where", "x", false)).find("the folder of the output cannot be written to"),
      std::string::npos);
  EXPECT_NE(error_of(write_output(folder / std::string(300, 'a'), "x", false)), "no error");
  EXPECT_TRUE(write_output(folder / std::string(255, 'a'), "x", false).ok());
  EXPECT_EQ(folder.entry_count(), 1U);
}

// A limit on the size of files makes a write fail as a full disk does.
TEST(WriteOutput, write_that_fails_half_way_leaves_no_temporary_and_the_old_file) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{1000, before.rlim_max};
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status replaced = write_output(path, many_bytes(), true);
  const Status made = write_output(folder / "b", many_bytes(), false);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(error_of(replaced), path + ": File too large");
  EXPECT_EQ(error_of(made), folder / "b" + ": File too large");
  EXPECT_EQ(read_whole(path), "old");
  EXPECT_EQ(folder.entry_count(), 1U);
}

TEST(WriteOutput, temporaries_that_are_on_their_way_can_be_removed_all_at_once) {
  const TemporaryFolder folder;
  const TemporaryFile first(folder / "a", true);
  ASSERT_TRUE(first.is_open());
  {
    TemporaryFile second(folder / "b", true);
    ASSERT_TRUE(second.is_open());
    EXPECT_EQ(folder.entry_count(), 2U);
  }
  EXPECT_EQ(folder.entry_count(), 1U);
  TemporaryFile named(folder / "c", true);
  ASSERT_TRUE(named.rename_to(folder / "c", false));
  std::vector<std::unique_ptr<TemporaryFile>> many;
  for (int i = 0; i < 100; ++i) many.push_back(std::make_unique<TemporaryFile>(folder / "d", true));
  EXPECT_EQ(folder.entry_count(), 102U);
  many.clear();
  remove_temporaries();
  EXPECT_EQ(folder.entry_count(), 1U);
  EXPECT_TRUE(std::filesystem::exists(folder / "c"));
}

TEST(WriteOutput, temporary_becomes_no_file_that_somebody_made_meanwhile) {
  const TemporaryFolder folder;
  const std::string theirs = folder.write("a", "theirs");
  TemporaryFile file(theirs, true);
  EXPECT_FALSE(file.rename_to(theirs, false));
  EXPECT_EQ(errno, EEXIST);
  EXPECT_EQ(read_whole(theirs), "theirs");
  EXPECT_TRUE(file.rename_to(theirs, true));
  EXPECT_EQ(read_whole(theirs), "");
}

}  // namespace
}  // namespace chronormal::file_test
