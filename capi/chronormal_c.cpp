// Implements the C interface. Each function checks what the types of C cannot express, calls its counterpart in the
// library, and turns errors and exceptions into a status with a message.
#include "chronormal_c.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/chronormal_io.h"

namespace {

using namespace chronormal;

thread_local std::string last_message;

chronormal_status fail(const Error& error) noexcept {
  try {
    last_message = error.text();
  } catch (...) {
    last_message.clear();
  }
  return static_cast<chronormal_status>(error.code);
}

chronormal_status misuse(const char* place, const char* message) noexcept {
  try {
    return fail(Error{ErrorCode::kUsage, place, message});
  } catch (...) {
    return CHRONORMAL_USAGE;
  }
}

// Calls body(), which may throw, and turns an exception into a status.
template <class Body>
chronormal_status guarded(const Body& body) noexcept {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return fail(Error{ErrorCode::kFailed, "", "there is not enough memory; free some, or use a smaller mesh"});
  } catch (const std::exception& e) {
    return fail(Error{ErrorCode::kFailed, "", e.what()});
  } catch (...) {
    return fail(Error{ErrorCode::kFailed, "",
                      "an unknown exception was thrown in the library; please report this with the input"});
  }
}

double angle_in_degrees(const Vec3d& right, const Vec3d& shown) noexcept {
  const bool is_right = right != Vec3d{}, is_shown = is_finite(shown) && shown != Vec3d{};
  if (is_right != is_shown) return 180;
  return is_right ? angle_between(right, shown) * kDegreesPerRadian : 0;
}

constexpr std::size_t kPacked = 3 * sizeof(float);

// Makes a view of vectors that lie `stride` bytes apart. Errors: kUsage for a null pointer, and for a stride that is
// not a multiple of 4 or with which vectors overlap.
template <class T>
Result<VectorView<T>> view_of(T* data, std::size_t stride, std::size_t count, const char* place) {
  if (count == 0) return VectorView<T>{};
  if (data == nullptr) return Error{ErrorCode::kUsage, place, "the pointer is NULL; pass a valid pointer"};
  if (stride == 0) stride = kPacked;
  if (stride % sizeof(float) != 0) return Error{ErrorCode::kUsage, place, "the stride must be a multiple of 4 bytes"};
  if (stride < kPacked)
    return Error{ErrorCode::kUsage, place, "the stride must be at least 12 bytes, the size of a vector"};
  return VectorView<T>{data, data + 1, data + 2, count, stride / sizeof(float)};
}

Result<VectorView<const float>> view_of(const chronormal_vectors& vectors, std::size_t count, const char* place) {
  return view_of(vectors.data, vectors.stride, count, place);
}

Result<VectorView<float>> view_of(const chronormal_result& result, std::size_t count) {
  return view_of(result.data, result.stride, count, "normals");
}

Result<Topology> topology_of(const chronormal_mesh* mesh) {
  if (mesh == nullptr) return Error{ErrorCode::kUsage, "mesh", "the pointer is NULL; pass a valid pointer"};
  if (mesh->face_count == 0) return invalid_input("mesh", "the mesh has no faces, so it has no normals; give it faces");
  if (mesh->corners == nullptr)
    return Error{ErrorCode::kUsage, "mesh.corners", "the pointer is NULL; pass a valid pointer"};
  if (mesh->offsets == nullptr) {
    if (mesh->face_count > std::numeric_limits<std::size_t>::max() / (3 * sizeof(std::uint32_t)))
      return invalid_input("mesh.face_count", "the number of faces is larger than memory can hold; check face_count");
    return Topology::triangles(mesh->vertex_count, {mesh->corners, mesh->corners + 3 * mesh->face_count});
  }
  const std::span<const std::uint32_t> offsets(mesh->offsets, mesh->face_count + 1);
  return Topology::polygons(mesh->vertex_count, {offsets.begin(), offsets.end()},
                            {mesh->corners, mesh->corners + offsets.back()});
}

// Checks a structure that begins with its size. A structure from a newer header may have further fields that this
// library does not know. The bytes of these fields must be 0.
template <class Struct>
Status check_size(const Struct& given, const char* name) {
  const std::string place = std::string(name) + ".size";
  if (given.size < sizeof(Struct))
    return Error{
        ErrorCode::kUsage, place,
        std::string("the size must be sizeof(chronormal_") + name + "); call chronormal_" + name + "_init() to set it"};
  constexpr std::size_t kMost = 4096;
  if (given.size > kMost)
    return Error{ErrorCode::kUsage, place,
                 std::string("the size is larger than that of any version of this structure; call chronormal_") + name +
                     "_init() to set it"};
  const auto* const bytes = reinterpret_cast<const unsigned char*>(&given);
  if (std::any_of(bytes + sizeof(Struct), bytes + given.size, [](unsigned char byte) { return byte != 0; }))
    return Error{ErrorCode::kUsage, place,
                 "a field is set that this version of the library does not know; use a newer library"};
  return Success{};
}

// Converts the options of C to those of the library. Errors: kUsage with the name of the field.
Result<MeshNormalsOptions> options_of(const chronormal_options* given) {
  MeshNormalsOptions options;
  if (given == nullptr) return options;
  if (const Status status = check_size(*given, "options"); !status) return status.error();
  if (given->elements < CHRONORMAL_FACES || given->elements > CHRONORMAL_CORNERS)
    return Error{ErrorCode::kUsage, "options.elements", "elements must be faces (0), vertices (1) or corners (2)"};
  if (!std::isfinite(given->tolerance) || given->tolerance <= 0)
    return Error{ErrorCode::kUsage, "options.tolerance", "the tolerance must be an angle in radians, greater than 0"};
  if (given->weighting != nullptr) {
    const Result<Weighting> weighting = make_weighting(given->weighting);
    if (!weighting) return weighting.error();
    options.weighting = weighting.value();
  }
  options.elements.kind = static_cast<ElementKind>(given->elements);
  options.elements.weld = given->separate == 0;
  options.elements.crease_angle = given->crease_angle;
  options.tolerance = given->tolerance;
  options.threads = given->all_threads != 0 ? Threads::kAll : Threads::kOne;
  return options;
}

// Calls write(result, range). `result` is a view of the memory that `given` describes: vectors of three floats, or
// normals that are packed into four bytes each. Returns the number of zero normals, as write() does. Errors: kUsage.
template <class Write>
Result<std::size_t> write_to(const chronormal_output* given, std::size_t size, const Write& write) {
  if (given == nullptr) return Error{ErrorCode::kUsage, "output", "the pointer is NULL; pass a valid pointer"};
  if (const Status status = check_size(*given, "output"); !status) return status.error();
  const IndexRange range{given->first, given->count};
  if (range.first > size || (range.count != CHRONORMAL_ALL && range.count > size - range.first))
    return Error{ErrorCode::kUsage, "output.count",
                 "the range goes beyond the last normal; first + count may be at most " + std::to_string(size)};
  if (given->format == CHRONORMAL_FLOAT32) {
    const auto view = view_of(static_cast<float*>(given->data), given->stride, size, "output");
    if (!view) return view.error();
    return write(view.value(), range);
  }
  if (given->format != CHRONORMAL_OCTAHEDRAL && given->format != CHRONORMAL_RGB10A2)
    return Error{ErrorCode::kUsage, "output.format",
                 "the format must be float32 (0), octahedral (1) or 10-10-10-2 (2)"};
  if (given->data == nullptr && size > 0)
    return Error{ErrorCode::kUsage, "output", "the pointer is NULL; pass a valid pointer"};
  if (given->stride != 0 && given->stride != sizeof(std::uint32_t))
    return Error{ErrorCode::kUsage, "output.stride",
                 "the stride must be 0 or 4 bytes, since normals of this format have 4 bytes"};
  if (given->format == CHRONORMAL_OCTAHEDRAL)
    return write(std::span(static_cast<Octahedral*>(given->data), size), range);
  return write(std::span(static_cast<Rgb10A2*>(given->data), size), range);
}

}  // namespace

struct chronormal_curves {
  MeshNormals curves;
  Threads threads;
  std::vector<float> exact;  // exact normals (size, 3), against which chronormal_curves_errors() measures
};

struct chronormal_blend {
  MeshNormals blend;
  std::size_t targets;
  Threads threads;
};

struct chronormal_motion {
  Input input;
  const Motion* motion;
  SampleOptions options;
  NormalSampler sampler;
  std::unique_ptr<Motion> pieces = {};  // the straight pieces of curves; empty for straight paths
};

const char* chronormal_version(void) { return CHRONORMAL_VERSION; }

const char* chronormal_last_message(void) { return last_message.c_str(); }

void chronormal_options_init(chronormal_options* options) {
  if (options != nullptr)
    *options = {sizeof(chronormal_options), CHRONORMAL_VERTICES, 0, 180, nullptr, kExactTolerance, 0};
}

void chronormal_output_init(chronormal_output* output, void* data) {
  if (output != nullptr) *output = {sizeof(chronormal_output), data, 0, CHRONORMAL_FLOAT32, 0, CHRONORMAL_ALL};
}

chronormal_status chronormal_curves_create(const chronormal_mesh* mesh, chronormal_vectors from, chronormal_vectors to,
                                           const chronormal_options* options, chronormal_curves** result) {
  if (result == nullptr) return misuse("result", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const Result<MeshNormalsOptions> chosen = options_of(options);
    if (!chosen) return fail(chosen.error());
    Result<Topology> topology = topology_of(mesh);
    if (!topology) return fail(topology.error());
    const auto first = view_of(from, mesh->vertex_count, "from"), last = view_of(to, mesh->vertex_count, "to");
    if (!first) return fail(first.error());
    if (!last) return fail(last.error());
    Result<MeshNormals> curves = MeshNormals::make(std::move(topology).value(), chosen.value());
    if (!curves) return fail(curves.error());
    if (const Status status = curves.value().set_segment(first.value(), last.value()); !status)
      return fail(status.error());
    *result = new chronormal_curves{std::move(curves).value(), chosen.value().threads, {}};
    return CHRONORMAL_DONE;
  });
}

chronormal_status chronormal_curves_next(chronormal_curves* curves, chronormal_vectors from, chronormal_vectors to) {
  if (curves == nullptr) return misuse("curves", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const std::size_t vertices = curves->curves.topology().vertex_count();
    const auto first = view_of(from, vertices, "from"), last = view_of(to, vertices, "to");
    if (!first) return fail(first.error());
    if (!last) return fail(last.error());
    const Status status = curves->curves.set_segment(first.value(), last.value());
    return status ? CHRONORMAL_DONE : fail(status.error());
  });
}

size_t chronormal_curves_size(const chronormal_curves* curves) { return curves != nullptr ? curves->curves.size() : 0; }

size_t chronormal_curves_bytes(const chronormal_curves* curves) {
  return curves != nullptr ? curves->curves.bytes() : 0;
}

chronormal_status chronormal_curves_unit_normals(chronormal_curves* curves, double t, chronormal_result normals,
                                                 size_t* zeros) {
  if (curves == nullptr) return misuse("curves", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const auto view = view_of(normals, curves->curves.size());
    if (!view) return fail(view.error());
    const std::size_t count = curves->curves.unit_normals(t, view.value(), curves->threads);
    if (zeros != nullptr) *zeros = count;
    return CHRONORMAL_DONE;
  });
}

chronormal_status chronormal_curves_write(const chronormal_curves* curves, const double* times,
                                          const chronormal_output* outputs, size_t count, size_t* zeros) {
  if (curves == nullptr) return misuse("curves", "the pointer is NULL; pass a valid pointer");
  if (count > 0 && times == nullptr) return misuse("times", "the pointer is NULL; pass a valid pointer");
  if (count > 0 && outputs == nullptr) return misuse("outputs", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const MeshNormals& normals = curves->curves;
    const auto write = [&](std::size_t k, bool is_real) {
      return write_to(&outputs[k], normals.size(), [&](const auto& result, IndexRange range) -> std::size_t {
        return is_real ? normals.unit_normals(times[k], result, range) : 0;
      });
    };
    // All arguments are checked before any output is written.
    for (std::size_t k = 0; k < count; ++k) {
      if (!(times[k] >= 0 && times[k] <= 1)) return misuse("times", "t must be from 0 to 1");
      if (const auto checked = write(k, false); !checked) return fail(checked.error());
    }
    std::size_t all = 0;
    for (std::size_t k = 0; k < count; ++k) all += write(k, true).value();
    if (zeros != nullptr) *zeros = all;
    return CHRONORMAL_DONE;
  });
}

chronormal_status chronormal_curves_errors(chronormal_curves* curves, double t, chronormal_vectors normals,
                                           float* degrees) {
  if (curves == nullptr) return misuse("curves", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const std::size_t size = curves->curves.size();
    const auto view = view_of(normals, size, "normals");
    if (!view) return fail(view.error());
    if (degrees == nullptr && size > 0) return misuse("degrees", "the pointer is NULL; pass a valid pointer");
    curves->exact.resize(3 * size);
    const auto exact = VectorView<float>::packed(curves->exact.data(), size);
    curves->curves.unit_normals(t, exact, curves->threads);
    for (std::size_t i = 0; i < size; ++i) {
      degrees[i] = static_cast<float>(angle_in_degrees(to_double(exact[i]), to_double(view.value()[i])));
    }
    return CHRONORMAL_DONE;
  });
}

void chronormal_curves_destroy(chronormal_curves* curves) { delete curves; }

chronormal_status chronormal_blend_create(const chronormal_mesh* mesh, chronormal_vectors base,
                                          const chronormal_target* targets, size_t target_count,
                                          const chronormal_options* options, chronormal_blend** result) {
  if (result == nullptr) return misuse("result", "the pointer is NULL; pass a valid pointer");
  if (targets == nullptr && target_count > 0) return misuse("targets", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const Result<MeshNormalsOptions> chosen = options_of(options);
    if (!chosen) return fail(chosen.error());
    if (chosen.value().weighting != Weighting::kArea)
      return misuse("options.weighting", "normals of blend shapes can only be weighted by area; choose this weighting");
    if (chosen.value().tolerance != kExactTolerance)
      return misuse("options.tolerance",
                    "the tolerance must be 1e-6 radians for blend shapes, which are always exact; set it to 1e-6");
    Result<Topology> topology = topology_of(mesh);
    if (!topology) return fail(topology.error());
    const auto packed = [](VectorView<const float> view) {
      std::vector<float> values(3 * view.count);
      for (std::size_t i = 0; i < view.count; ++i) VectorView<float>::packed(values.data(), view.count).set(i, view[i]);
      return values;
    };
    const auto base_view = view_of(base, mesh->vertex_count, "base");
    if (!base_view) return fail(base_view.error());
    BlendSet set{std::move(topology).value(), packed(base_view.value()), {}};
    for (std::size_t k = 0; k < target_count; ++k) {
      const chronormal_target& target = targets[k];
      if (target.vertices == nullptr && target.count != mesh->vertex_count)
        return misuse("targets",
                      "a target without a list of vertices must have a delta for every vertex of the mesh; give the "
                      "list, or all deltas");
      const auto deltas = view_of(target.deltas, target.count, "targets");
      if (!deltas) return fail(deltas.error());
      std::vector<float> values = packed(deltas.value());
      set.targets.push_back(
          target.vertices == nullptr
              ? BlendTarget::from_dense(values)
              : BlendTarget{"", {target.vertices, target.vertices + target.count}, std::move(values)});
    }
    Result<MeshNormals> blend = MeshNormals::make(set.topology, {.elements = chosen.value().elements});
    if (!blend) return fail(blend.error());
    if (const Status status = blend.value().set_targets(std::move(set)); !status) return fail(status.error());
    *result = new chronormal_blend{std::move(blend).value(), target_count, chosen.value().threads};
    return CHRONORMAL_DONE;
  });
}

size_t chronormal_blend_size(const chronormal_blend* blend) { return blend != nullptr ? blend->blend.size() : 0; }

chronormal_status chronormal_blend_unit_normals(chronormal_blend* blend, const double* weights,
                                                chronormal_result normals, size_t* zeros) {
  if (blend == nullptr) return misuse("blend", "the pointer is NULL; pass a valid pointer");
  if (weights == nullptr && blend->targets > 0) return misuse("weights", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const auto view = view_of(normals, blend->blend.size());
    if (!view) return fail(view.error());
    const std::size_t count =
        blend->blend.unit_normals(std::span(weights, blend->targets), view.value(), blend->threads);
    if (zeros != nullptr) *zeros = count;
    return CHRONORMAL_DONE;
  });
}

chronormal_status chronormal_blend_set_weights(chronormal_blend* blend, const double* weights) {
  if (blend == nullptr) return misuse("blend", "the pointer is NULL; pass a valid pointer");
  if (weights == nullptr && blend->targets > 0) return misuse("weights", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const std::span<const double> all(weights, blend->targets);
    if (!std::all_of(all.begin(), all.end(), [](double weight) { return std::isfinite(weight); }))
      return misuse("weights", "a weight is NaN or infinite; give finite weights");
    blend->blend.set_weights(all, blend->threads);
    return CHRONORMAL_DONE;
  });
}

chronormal_status chronormal_blend_write(const chronormal_blend* blend, const chronormal_output* output,
                                         size_t* zeros) {
  if (blend == nullptr) return misuse("blend", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const auto written = write_to(output, blend->blend.size(), [&](const auto& result, IndexRange range) {
      return blend->blend.unit_normals(result, range);
    });
    if (!written) return fail(written.error());
    if (zeros != nullptr) *zeros = written.value();
    return CHRONORMAL_DONE;
  });
}

void chronormal_blend_destroy(chronormal_blend* blend) { delete blend; }

chronormal_status chronormal_motion_read(const char* const* files, size_t file_count, const chronormal_options* options,
                                         chronormal_motion** result) {
  if (result == nullptr) return misuse("result", "the pointer is NULL; pass a valid pointer");
  if (files == nullptr || std::find(files, files + file_count, nullptr) != files + file_count)
    return misuse("files", "the pointer is NULL; pass a valid pointer");
  if (file_count == 0) return misuse("file_count", "there are no files; pass at least one name");
  return guarded([&] {
    const Result<MeshNormalsOptions> chosen = options_of(options);
    if (!chosen) return fail(chosen.error());
    InputOptions reading;
    reading.files.assign(files, files + file_count);
    reading.velocities = true;
    Result<Input> input = open_input(reading);
    if (!input) return fail(input.error());
    const Result<const Motion*> motion = input.value().motion();
    if (!motion) return fail(motion.error());
    SampleOptions sampling;
    sampling.elements = chosen.value().elements;
    sampling.weighting = chosen.value().weighting;
    Result<NormalSampler> sampler = NormalSampler::make(*motion.value(), sampling);
    if (!sampler) return fail(sampler.error());
    *result = new chronormal_motion{std::move(input).value(), motion.value(), sampling, std::move(sampler).value()};
    return CHRONORMAL_DONE;
  });
}

chronormal_status chronormal_motion_follow(chronormal_motion* motion, const char* path) {
  if (motion == nullptr) return misuse("motion", "the pointer is NULL; pass a valid pointer");
  if (path == nullptr) return misuse("path", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const Result<Path> wanted = make_path(path);
    if (!wanted) return fail(Error{ErrorCode::kUsage, "path", wanted.error().message});
    Result<CutMotion> cut = cut_into_segments(*motion->input.motion().value(), wanted.value());
    if (!cut) return fail(cut.error());
    auto pieces = std::make_unique<Motion>(std::move(cut).value().motion);
    Result<NormalSampler> sampler = NormalSampler::make(*pieces, motion->options);
    if (!sampler) return fail(sampler.error());
    motion->sampler = std::move(sampler).value();
    motion->motion = pieces.get();
    motion->pieces = std::move(pieces);
    return CHRONORMAL_DONE;
  });
}

size_t chronormal_motion_size(const chronormal_motion* motion) {
  return motion != nullptr ? motion->sampler.output_count() : 0;
}

void chronormal_motion_times(const chronormal_motion* motion, double* first, double* last) {
  const bool runs =
      motion != nullptr && motion->motion->kind != MotionKind::kTargets && !motion->motion->keyframes.empty();
  if (first != nullptr) *first = runs ? motion->motion->keyframes.front().time : 0;
  if (last != nullptr) *last = runs ? motion->motion->keyframes.back().time : 0;
}

chronormal_status chronormal_motion_unit_normals(chronormal_motion* motion, double time, chronormal_result normals) {
  if (motion == nullptr) return misuse("motion", "the pointer is NULL; pass a valid pointer");
  return guarded([&] {
    const std::size_t size = motion->sampler.output_count();
    const auto view = view_of(normals, size);
    if (!view) return fail(view.error());
    const Result<Pose> pose = motion->sampler.at_time(time);
    if (!pose) return fail(pose.error());
    const std::vector<float> values = motion->sampler.normals_of_outputs(pose.value());
    for (std::size_t i = 0; i < size; ++i) view.value().set(i, VectorView<const float>::packed(values.data(), size)[i]);
    return CHRONORMAL_DONE;
  });
}

void chronormal_motion_destroy(chronormal_motion* motion) { delete motion; }
