// Writes motions as files: one file for the whole motion, or one for each keyframe.
#include <cassert>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/io/output.h"
#include "io/bytes/expansion.h"
#include "io/bytes/extension.h"
#include "io/bytes/output_file.h"
#include "io/bytes/scan.h"
#include "io/gltf/glb/glb.h"
#include "io/gltf/glb/glb_targets.h"
#include "io/input/formats.h"
#include "io/input/write_motion.h"
#include "io/system/names.h"

namespace chronormal {
namespace {

// A file name that may have a place for the number of a keyframe.
struct NamePattern {
  std::string before, after;
  bool has_number = false;
  std::size_t width = 0;  // number of digits to which the number is padded with zeros

  [[nodiscard]] std::string name(std::size_t k) const {
    if (!has_number) return before;
    std::string number = std::to_string(k);
    if (number.size() < width) number.insert(0, width - number.size(), '0');
    return before + number + after;
  }
};

Result<NamePattern> parse_pattern(const std::string& pattern) {
  const Error misuse{
      ErrorCode::kUsage, pattern,
      "the name of the output must have one %d, or %03d for three digits, where the number of each file goes"};
  NamePattern parts;
  const std::size_t percent = pattern.find('%', begin_of_name(pattern));
  parts.before = pattern.substr(0, percent);
  if (percent == std::string::npos) return parts;

  std::string_view rest = std::string_view(pattern).substr(percent + 1);
  if (rest.starts_with('0')) {
    rest.remove_prefix(1);
    std::size_t digits = 0;
    for (; digits < 2 && digits < rest.size() && scan::is_digit(rest[digits]); ++digits)
      parts.width = 10 * parts.width + static_cast<std::size_t>(rest[digits] - '0');
    if (parts.width == 0) return misuse;
    rest.remove_prefix(digits);
  }
  if (!rest.starts_with('d') || rest.find('%') != std::string_view::npos) return misuse;
  parts.after = rest.substr(1);
  parts.has_number = true;
  return parts;
}

Status write_keyframes(MotionStream& stream, const Format& format, const std::string& pattern, bool force,
                       const Expansion& expansion) {
  const Motion& motion = stream.motion();
  const Result<std::vector<std::string>> names = numbered_names(pattern, motion.keyframes.size());
  if (!names) return names.error();
  for (const std::string& name : names.value()) {
    if (Status status = check_output(name, force); !status) return status;
  }
  // No file gets its final name before all keyframes have been read, because the keyframes may be read from existing
  // files with the same names.
  std::vector<OutputFile> files;
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    if (Status status = stream.hold(k, k); !status) return status;
    const std::vector<float>& coordinates = motion.keyframes[k].positions;
    assert(coordinates.size() == 3 * motion.topology.vertex_count());
    const auto positions = VectorView<const float>::packed(coordinates.data(), motion.topology.vertex_count());
    const std::string bytes = format.write_mesh(motion.topology, positions, motion.origin);
    // Keyframes have similar sizes, so the size of the first one gives an estimate of the total. A total that is too
    // large is refused before anything is written.
    const std::uint64_t all = std::uint64_t{bytes.size()} * motion.keyframes.size();
    if (Status status = k == 0 ? expansion.check(all, pattern) : Success{}; !status) return status;
    Result<OutputFile> file = OutputFile::create(names.value()[k], force);
    if (!file) return file.error();
    if (Status status = file.value().append(bytes); !status) return status;
    if (Status status = file.value().seal(); !status) return status;
    files.push_back(std::move(file).value());
  }
  for (OutputFile& file : files) {
    if (Status status = file.finish(); !status) return status;
  }
  return Success{};
}

}  // namespace

Result<std::vector<std::string>> numbered_names(const std::string& pattern, std::size_t count) {
  const Result<NamePattern> parts = parse_pattern(pattern);
  if (!parts) return parts.error();
  if (!parts.value().has_number && count > 1)
    return Error{ErrorCode::kUsage, pattern,
                 "the result is " + std::to_string(count) +
                     " files; put %d into the name of the output, where the number of each file goes"};
  std::vector<std::string> names;
  for (std::size_t k = 0; k < count; ++k) names.push_back(parts.value().name(k));
  return names;
}

bool is_motion_file(const std::string& path) noexcept {
  const Format* const format = find_format(path);
  return format != nullptr && (format->write_mesh != nullptr || format->write_motion != nullptr);
}

Status write_motion(const Motion& motion, const std::string& path, bool force, bool weld) {
  MotionStream stream(motion);
  return write_motion(stream, path, force, weld);
}

Status write_motion(MotionStream& stream, const std::string& path, bool force, bool weld) {
  return write_motion(stream, path, force, Expansion::unlimited(), weld);
}

Status internal::write_motion(MotionStream& stream, const std::string& path, bool force, const Expansion& expansion,
                              bool weld) {
  const Motion& motion = stream.motion();
  const Format* const format = find_format(path);
  if (format != nullptr && format->write_mesh != nullptr)
    return write_keyframes(stream, *format, path, force, expansion);
  if (format != nullptr && format->holds == Holds::kGltf) {
    if (motion.kind != MotionKind::kTargets || !is_glb_extension(lower_extension(path)))
      return Error{ErrorCode::kUsage, path,
                   "convert can only write glTF as .glb, and only from a base with morph targets; for another input, "
                   "use bake instead"};
    if (Status status = check_output(path, force); !status) return status;
    if (Status status = stream.hold_all(); !status) return status;
    const Result<std::string> glb = write_glb_targets(motion, weld);
    if (!glb) return Error{glb.error().code, path, glb.error().message};
    return write_output(path, glb.value(), force);
  }
  if (format == nullptr || format->write_motion == nullptr) {
    std::string writable;
    for (const Format& each : formats())
      if (each.write_mesh != nullptr || each.write_motion != nullptr)
        writable.append(each.extensions.front()).append(", ");
    return Error{ErrorCode::kUsage, path,
                 "the format of the output is unknown; its name must end in one of " + writable +
                     "or .glb (for targets over a base)"};
  }
  Result<OutputFile> file = OutputFile::create(path, force);
  if (!file) return file.error();
  if (Status status = format->write_motion(stream, file.value()); !status) {
    Error error = status.error();
    if (error.place.empty()) error.place = path;
    return error;
  }
  return file.value().finish();
}

}  // namespace chronormal
