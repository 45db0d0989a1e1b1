// Measures how long commands of the program take on one large sequence: chronormal_bench_commands (./run bench
// --commands). For comparison it measures lower bounds: reading the bytes of the files (cat), copying them in memory
// (memcpy), reading the files as a motion, and copying the output to the disk for a command that writes a large file.
// It also measures how long one frame of OBJ takes to read: by our reader, by a loop that parses numbers with
// std::from_chars, and by other libraries if they are installed. All readers except Assimp, which returns corners, must
// find the same positions. With --json FILE it also writes the results to a file, from which docs/benchmarks.md is
// made.

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#ifdef CHRONORMAL_HAVE_ASSIMP
#include <assimp/scene.h>
#include <assimp/Importer.hpp>
#endif
#ifdef CHRONORMAL_HAVE_TINYOBJ
#include <tiny_obj_loader.h>

#include <sstream>
#endif

#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "io/bytes/file.h"
#include "io/mesh/obj.h"

namespace chronormal::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Times {
  double wall = 0, cpu = 0;  // elapsed time and processor time, in seconds
};

// Makes a sheet of about `vertices` vertices that bends while waves run through it.
Motion make_waves(std::size_t vertices, std::size_t keyframes) {
  const auto side = std::max<std::size_t>(2, static_cast<std::size_t>(std::sqrt(static_cast<double>(vertices))));
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i + 1 < side; ++i) {
    for (std::size_t j = 0; j + 1 < side; ++j) {
      const auto a = static_cast<std::uint32_t>(i * side + j), b = a + static_cast<std::uint32_t>(side);
      corners.insert(corners.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  }
  Motion motion;
  motion.topology = Topology::triangles(side * side, std::move(corners)).value();
  for (std::size_t k = 0; k < keyframes; ++k) {
    const double t = 4.0 * static_cast<double>(k) / static_cast<double>(keyframes);
    Motion::Keyframe keyframe{{}, static_cast<double>(k), std::to_string(k)};
    keyframe.positions.reserve(3 * side * side);
    for (std::size_t i = 0; i < side; ++i) {
      for (std::size_t j = 0; j < side; ++j) {
        const double u = static_cast<double>(i) / static_cast<double>(side - 1);
        const double v = static_cast<double>(j) / static_cast<double>(side - 1);
        const double z = 0.05 * std::sin(9 * u + 3 * t) * std::cos(7 * v + 2 * t) +
                         0.004 * std::sin(60 * u + 5 * t) * std::sin(50 * v - 4 * t);
        const double turn = 0.6 * t * std::sin(2 * u);
        for (const double coordinate :
             {u, v * std::cos(turn) - z * std::sin(turn), v * std::sin(turn) + z * std::cos(turn)})
          keyframe.positions.push_back(static_cast<float>(coordinate));
      }
    }
    motion.keyframes.push_back(std::move(keyframe));
  }
  motion.connect_as_sequence();
  return motion;
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// Runs body() in a child process, which exits with the result of body(). Returns the wall time and the processor time
// of the child in seconds.
Times time_child(const std::string& name, const std::function<int()>& body) {
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child == -1) throw std::runtime_error("no process can be started");
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    ::_exit(body());
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  // An audit that finds errors exits with 4, which does not mean that the command failed.
  if (!WIFEXITED(status) || (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != 4))
    throw std::runtime_error(fmt::format("{} failed", name));
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime)};
}

Times time_command(const std::string& program, const std::vector<std::string>& arguments) {
  return time_child(arguments[0], [&] {
    std::vector<char*> list = {const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) list.push_back(const_cast<char*>(argument.c_str()));
    list.push_back(nullptr);
    ::execv(program.c_str(), list.data());
    return 127;
  });
}

// Copies a file and waits until the copy is on the disk, as the program does with its outputs. Removes the copy
// afterwards.
int copy_to_disk(const std::string& file) {
  const std::string copy = file + ".copy";
  const int from = ::open(file.c_str(), O_RDONLY), to = ::open(copy.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0600);
  std::vector<char> buffer(1 << 18);
  ssize_t count = from < 0 || to < 0 ? -1 : ::read(from, buffer.data(), buffer.size());
  while (count > 0 && ::write(to, buffer.data(), static_cast<std::size_t>(count)) == count)
    count = ::read(from, buffer.data(), buffer.size());
  const bool is_whole = count == 0 && ::fsync(to) == 0;
  ::unlink(copy.c_str());
  return is_whole ? 0 : 1;
}

// Prints a row of the table and appends it to `rows`. The row compares the processor time with `reading`, which is the
// processor time of reading the input, in seconds.
void add_row(Json& rows, const std::string& name, const Times& times, double reading) {
  fmt::print("{:<34}{:>10.2f}{:>10.2f}{:>12.2f}\n", name, times.wall, times.cpu, times.cpu / reading);
  std::fflush(stdout);
  rows.push_back({{"name", name}, {"wall_s", times.wall}, {"cpu_s", times.cpu}});
}

Json measure_input(const std::string& program, const std::string& title, const std::vector<std::string>& files,
                   const std::vector<std::vector<std::string>>& commands) {
  std::size_t bytes = 0;
  for (const std::string& file : files) bytes += fs::file_size(file);
  InputOptions input;
  input.files = files;
  const auto open = [&input] { return open_input(input) ? 0 : 1; };
  // The first reading loads the files into the file cache of the system, so that later readings do not wait for the
  // disk.
  time_child("reading", open);
  const Times cat = time_child("cat", [&] {
    std::vector<char> buffer(1 << 17);
    for (const std::string& file : files) {
      const int descriptor = ::open(file.c_str(), O_RDONLY);
      while (::read(descriptor, buffer.data(), buffer.size()) > 0) {
      }
      ::close(descriptor);
    }
    return 0;
  });
  const Times copy = time_child("memcpy", [bytes] {
    const std::vector<char> from(bytes, 1);
    std::vector<char> to(bytes);
    std::memcpy(to.data(), from.data(), bytes);
    return to[bytes / 2] == 1 ? 0 : 1;
  });
  const Times reading = time_child("reading", open);
  fmt::print("\n{:<34}{:>10}{:>10}{:>12}\n", fmt::format("{}, {:.0f} MB", title, static_cast<double>(bytes) / 1e6),
             "wall", "CPU", "CPU over");
  fmt::print("{:<34}{:>10}{:>10}{:>12}\n", "", "seconds", "seconds", "reading");
  Json rows = Json::array();
  add_row(rows, "cat", cat, reading.cpu);
  add_row(rows, "memcpy, with its memory", copy, reading.cpu);
  add_row(rows, "reading it as a motion", reading, reading.cpu);
  for (const std::vector<std::string>& command : commands) {
    std::vector<std::string> arguments = {command[0]};
    arguments.insert(arguments.end(), files.begin(), files.end());
    arguments.insert(arguments.end(), command.begin() + 1, command.end());
    add_row(rows, command[0], time_command(program, arguments), reading.cpu);
    const auto output = std::find(command.begin(), command.end(), "-o");
    if (output == command.end() || fs::file_size(*(output + 1)) < bytes) continue;
    const Times copied = time_child("copying", [&] { return copy_to_disk(*(output + 1)); });
    add_row(rows, fmt::format("a copy of what {} wrote", command[0]), copied, reading.cpu);
  }
  return {{"title", title}, {"bytes", bytes}, {"rows", rows}};
}

// Reads the vertices and corners of an OBJ file without any check. The faces must be triangles that have only vertex
// indices, such as "f 1 2 3".
std::vector<float> loop_over_numbers(std::string_view text) {
  std::vector<float> positions;
  std::vector<std::uint32_t> corners;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end) {
    const auto* const line_end = static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)));
    const bool is_vertex = *at == 'v';
    for (int i = 0; i < 3; ++i) {
      while (at < line_end && (*at < '0' || *at > '9') && *at != '-') ++at;
      if (is_vertex)
        at = std::from_chars(at, line_end, positions.emplace_back()).ptr;
      else
        at = std::from_chars(at, line_end, corners.emplace_back()).ptr;
    }
    at = line_end + 1;
  }
  if (corners.empty()) throw std::runtime_error("the loop finds no faces");
  return positions;
}

Json measure_obj(const std::string& file) {
  const FileBytes mapped = FileBytes::open(file).value();
  const std::string text(mapped.bytes());
  struct Reader {
    std::string name;
    std::function<std::vector<float>()> read;
  };
  std::vector<Reader> readers = {
      {"a loop of std::from_chars", [&] { return loop_over_numbers(text); }},
      {"chronormal", [&] { return read_obj(text, "frame").value().positions; }},
  };
#ifdef CHRONORMAL_HAVE_TINYOBJ
  readers.push_back({"tinyobjloader", [&] {
                       std::istringstream stream(text);
                       tinyobj::attrib_t attributes;
                       std::vector<tinyobj::shape_t> shapes;
                       std::vector<tinyobj::material_t> materials;
                       std::string warning, error;
                       tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &stream, nullptr, true);
                       return std::vector<float>(attributes.vertices.begin(), attributes.vertices.end());
                     }});
#endif
#ifdef CHRONORMAL_HAVE_ASSIMP
  readers.push_back({"assimp", [&] {
                       Assimp::Importer importer;
                       const aiScene* const scene = importer.ReadFileFromMemory(text.data(), text.size(), 0, "obj");
                       if (scene == nullptr) throw std::runtime_error(importer.GetErrorString());
                       std::vector<float> positions;  // one position for each corner, in the library's layout
                       for (unsigned m = 0; m < scene->mNumMeshes; ++m)
                         positions.resize(positions.size() + 3 * std::size_t{scene->mMeshes[m]->mNumVertices});
                       return positions;
                     }});
#endif
  fmt::print("\n{:<34}{:>10}{:>16}\n",
             fmt::format("one frame of OBJ, {:.0f} MB", static_cast<double>(text.size()) / 1e6), "CPU ms",
             "over the loop");
  const std::vector<float> expected = readers[0].read();
  Json rows = Json::array();
  double loop = 0;
  for (const Reader& reader : readers) {
    double best = 1e300;
    for (int i = 0; i < 5; ++i) {
      // Measures processor time, because other programs may run at the same time and lengthen the wall time.
      const std::clock_t start = std::clock();
      const std::vector<float> positions = reader.read();
      best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
      if (reader.name != "assimp" && positions != expected)
        throw std::runtime_error(reader.name + " finds other positions than the loop");
    }
    if (loop == 0) loop = best;
    fmt::print("{:<34}{:>10.1f}{:>16.2f}\n", reader.name, 1e3 * best, best / loop);
    rows.push_back({{"name", reader.name}, {"cpu_ms", 1e3 * best}});
  }
  return {{"bytes", text.size()}, {"readers", rows}};
}

int run(int argc, char** argv) {
  CLI::App app("What each command takes on one large sequence, beside the floor.", "./run bench --commands");
  std::string program, json_path;
  std::size_t vertices = 1000000, keyframes = 24;
  app.add_option("program", program, "chronormal")->required()->check(CLI::ExistingFile);
  app.add_option("--vertices", vertices, "about so many")->capture_default_str()->check(CLI::Range(100, 10000000));
  app.add_option("--keyframes", keyframes)->capture_default_str()->check(CLI::Range(2, 1000));
  app.add_option("--json", json_path, "also write what is measured to this file (bench/results/commands/MACHINE.json)");
  CLI11_PARSE(app, argc, argv);

  std::string pattern = (fs::temp_directory_path() / "chronormal_XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error(pattern + ": cannot be made");
  const struct Folder {
    fs::path path;
    ~Folder() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  } folder{pattern};
  const auto in = [&](const std::string& name) { return (folder.path / name).string(); };
  std::vector<std::string> frames;
  Json json = {{"chronormal_bench_commands", 1}};
  {
    const Motion motion = make_waves(vertices, keyframes);
    json["vertices"] = motion.topology.vertex_count();
    json["faces"] = motion.topology.face_count();
    json["keyframes"] = keyframes;
    fmt::print("{} vertices, {} faces, {} keyframes\n", motion.topology.vertex_count(), motion.topology.face_count(),
               keyframes);
    for (const std::string& path : {in("waves.npz"), in("wave_%04d.obj")})
      if (const Status status = write_motion(motion, path, true); !status)
        throw std::runtime_error(status.error().text());
    frames = numbered_names(in("wave_%04d.obj"), keyframes).value();
  }
  json["inputs"] = {measure_input(program, "NPZ", {in("waves.npz")},
                                  {{"inspect"},
                                   {"sample", "--times", "0.5", "-o", in("pose.npz")},
                                   {"audit"},
                                   {"compare"},
                                   {"bake", "-o", in("baked.glb")}}),
                    measure_input(program, "OBJ, a file for each keyframe", frames,
                                  {{"inspect"}, {"audit"}, {"bake", "-o", in("baked_of_obj.glb")}})};
  json["obj"] = measure_obj(frames[0]);
  if (json_path.empty()) return 0;
  std::ofstream file(json_path);
  file << json.dump(1) << '\n';
  if (!file.flush()) throw std::runtime_error(json_path + ": cannot be written");
  return 0;
}

}  // namespace
}  // namespace chronormal::bench

int main(int argc, char** argv) {
  try {
    return chronormal::bench::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "chronormal_bench_commands: {}\n", error.what());
    return 1;
  }
}
