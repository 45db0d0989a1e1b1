// Compares the normals that the deltas of blend shapes give with exact normals.
#include "chronormal/workflow/compare.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "analysis/quality/blend_quality.h"
#include "chronormal/core/parallel.h"
#include "chronormal/motion/motion.h"
#include "chronormal/workflow/sample.h"
#include "core/blocks.h"
#include "core/text.h"
#include "core/vector_area.h"
#include "normals/blend/blend_normals.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/shading/target_weights.h"

namespace chronormal {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"file", "end point", "least squares", "exact"};
constexpr std::array<std::size_t, 5> kActive = {1, 2, 4, 8, 16};
constexpr std::size_t kRowsPerTarget = 16;  // rows of weights per target, to which deltas are fitted by least squares
// The largest number of weights in all poses together, because one list in memory has all of these weights.
constexpr std::size_t kMostWeights = std::size_t{1} << 27;
// The largest number of bytes for the precomputed terms of n(w). If the terms take more, normals are computed from
// blended positions.
constexpr std::size_t kMostBytes = std::size_t{1} << 30;
constexpr std::size_t kChunk = 512;

Error misuse(std::string place, std::string message) {
  return Error{ErrorCode::kUsage, std::move(place), std::move(message)};
}

Vec3d vector_at(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

// A face, vertex or corner that shows a normal: the element that has this normal, and the number that messages print.
struct Output {
  std::uint32_t element = 0, number = 0;
};

// A set of blend shapes whose normals are compared. If `groups` is nullptr, the elements are faces. `shading` is
// nullptr if the set does not come from a glTF file.
struct Subject {
  const BlendSet* set = nullptr;
  const NormalGroups* groups = nullptr;
  const GltfShading* shading = nullptr;
  std::vector<Output> outputs;

  [[nodiscard]] std::size_t elements() const { return groups ? groups->size() : set->topology.face_count(); }
};

// A normal, and the sum of the sizes of its terms. The size of a term is the product of the lengths of two edges.
struct SizedNormal {
  Vec3d value;
  double size = 0;

  // Returns the normal, or (0, 0, 0) if its terms cancel so far that only rounding error is left. The direction of a
  // returned normal has an error of at most 1e-6 rad.
  [[nodiscard]] Vec3d without_rounding() const { return length(value) > 1e-10 * size ? value : Vec3d{}; }
};

SizedNormal operator+(const SizedNormal& a, const SizedNormal& b) { return {a.value + b.value, a.size + b.size}; }

// Computes the normals n(w) of all elements as cross products of blended positions, independently of the formula for
// n(w) that is tested. Returns (0, 0, 0) for an n(w) that is only rounding error.
std::vector<Vec3d> true_normals(const Subject& subject, std::span<const double> weights) {
  const Topology& topology = subject.set->topology;
  std::vector<double> positions(subject.set->base.size());
  blend_positions(*subject.set, weights, positions);
  std::vector<SizedNormal> faces(topology.face_count());
  numbered_blocks(faces.size(), kChunk, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; ++f) {
      const auto face = topology.face(f);
      const auto at = [&](std::size_t c) {
        const double* p = positions.data() + 3 * std::size_t{face[c]};
        return Vec3d{p[0], p[1], p[2]};
      };
      const auto edge_to = [&](std::size_t c) { return at(c) - at(0); };
      for_fan(face.size(), edge_to, [&](const Vec3d& a, const Vec3d& b) {
        faces[f] = faces[f] + SizedNormal{cross(a, b), length(a) * length(b)};
      });
    }
  });
  std::vector<Vec3d> result(subject.elements());
  numbered_blocks(result.size(), kChunk, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) {
      SizedNormal sum;
      if (subject.groups == nullptr)
        sum = faces[e];
      else
        for (const std::uint32_t f : subject.groups->faces(e)) sum = sum + faces[f];
      result[e] = sum.without_rounding();
    }
  });
  return result;
}

// Lists for each target the outputs whose normals change with its weight, in ascending order.
std::vector<std::vector<std::uint32_t>> moved_outputs(const Subject& subject) {
  const Topology& topology = subject.set->topology;
  const std::size_t targets = subject.set->targets.size();
  std::vector<std::vector<std::uint32_t>> faces_of_vertex(topology.vertex_count());
  for (std::size_t f = 0; f < topology.face_count(); ++f)
    for (const std::uint32_t v : topology.face(f)) faces_of_vertex[v].push_back(static_cast<std::uint32_t>(f));
  std::vector<std::vector<std::uint32_t>> elements_of_face(topology.face_count());
  for (std::size_t e = 0; e < subject.elements(); ++e) {
    const auto element = static_cast<std::uint32_t>(e);
    if (subject.groups == nullptr) {
      elements_of_face[e].push_back(element);
    } else {
      for (const std::uint32_t f : subject.groups->faces(e)) elements_of_face[f].push_back(element);
    }
  }
  std::vector<std::vector<std::uint32_t>> result(targets);
  std::vector<std::size_t> moved_by(subject.elements(), targets);  // for each element, the last target that moved it
  for (std::size_t k = 0; k < targets; ++k) {
    for (const std::uint32_t v : subject.set->targets[k].vertices)
      for (const std::uint32_t f : faces_of_vertex[v])
        for (const std::uint32_t e : elements_of_face[f]) moved_by[e] = k;
    const bool has_deltas = subject.shading != nullptr && !subject.shading->normal_deltas[k].empty();
    for (std::size_t i = 0; i < subject.outputs.size(); ++i) {
      const Output& output = subject.outputs[i];
      if (moved_by[output.element] == k ||
          (has_deltas && vector_at(subject.shading->normal_deltas[k], output.number) != Vec3d{}))
        result[k].push_back(static_cast<std::uint32_t>(i));
    }
  }
  return result;
}

// A meter that measures the errors of a subject's normals in one pose after the other. Each pose is a row of weights.
class BlendMeter {
 public:
  explicit BlendMeter(const Subject& subject)
      : subject_(subject),
        moved_(moved_outputs(subject)),
        normals_(subject.groups != nullptr
                     ? BlendNormals::of_groups(*subject.set, *subject.groups, {kMostBytes, std::nullopt})
                     : BlendNormals::of_faces(*subject.set, {kMostBytes, std::nullopt})),
        base_(true_normals(subject, std::vector<double>(targets()))),
        end_point_(endpoint_deltas(normals_)) {}

  [[nodiscard]] std::size_t targets() const { return subject_.set->targets.size(); }
  [[nodiscard]] bool moves() const {
    return std::any_of(moved_.begin(), moved_.end(), [](const auto& outputs) { return !outputs.empty(); });
  }

  // Measures the errors at the weights in `rows`. Deltas by least squares are fitted to other weights, which are in
  // fitted_rows.
  BlendErrors measure(std::span<const double> rows, std::span<const double> fitted_rows,
                      const std::function<void()>& progress) {
    const DeltaNormals best = best_deltas(normals_, fitted_rows);
    BlendErrors errors;
    errors.rows = rows.size() / targets();
    for (const BlendDeltas deltas :
         {BlendDeltas::kFile, BlendDeltas::kEndPoint, BlendDeltas::kLeastSquares, BlendDeltas::kExact}) {
      if (deltas != BlendDeltas::kFile || subject_.shading != nullptr) errors.deltas.emplace_back().deltas = deltas;
    }
    for (std::size_t row = 0; row < errors.rows; ++row) {
      const std::span<const double> weights = rows.subspan(row * targets(), targets());
      errors.active = std::max(errors.active, static_cast<std::size_t>(std::count_if(weights.begin(), weights.end(),
                                                                                     [](double w) { return w != 0; })));
      measure(row, weights, best, errors);
      progress();
    }
    for (BlendError& error : errors.deltas) locate_worst(rows, error);
    return errors;
  }

 private:
  [[nodiscard]] std::vector<std::uint32_t> moved_by(std::span<const double> weights) const {
    std::vector<bool> moved(subject_.outputs.size());
    for (std::size_t k = 0; k < weights.size(); ++k) {
      if (weights[k] == 0) continue;
      for (const std::uint32_t i : moved_[k]) moved[i] = true;
    }
    std::vector<std::uint32_t> result;
    for (std::size_t i = 0; i < moved.size(); ++i)
      if (moved[i]) result.push_back(static_cast<std::uint32_t>(i));
    return result;
  }

  // Returns the sum that a viewer computes for an output: the stored normal, plus weight times stored delta over all
  // targets. Adds in float32 and in the order of targets, as viewers do.
  [[nodiscard]] Vec3d stored(const Output& output, std::span<const double> weights) const {
    Vec3f sum = to_float(vector_at(subject_.shading->normals, output.number));
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const std::vector<float>& deltas = subject_.shading->normal_deltas[k];
      if (weights[k] == 0 || deltas.empty()) continue;
      sum = sum + static_cast<float>(weights[k]) * to_float(vector_at(deltas, output.number));
    }
    return to_double(sum);
  }

  void measure(std::size_t row, std::span<const double> weights, const DeltaNormals& best, BlendErrors& errors) {
    const std::size_t elements = normals_.size();
    std::vector<float> exact(3 * elements);
    (void)normals_.unit_normals(weights, VectorView<float>::packed(exact.data(), elements), Threads::kAll);
    std::vector<Vec3d> ends(elements), bests(elements);
    shown_normals(end_point_, weights, ends);
    shown_normals(best, weights, bests);
    const std::vector<Vec3d> truth = true_normals(subject_, weights);
    const std::vector<std::uint32_t> moved = moved_by(weights);
    const std::size_t methods = errors.deltas.size();
    std::vector<Quality> parts((moved.size() + kChunk - 1) / kChunk * methods);
    numbered_blocks(moved.size(), kChunk, [&](std::size_t chunk, std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const Output& output = subject_.outputs[moved[i]];
        const std::size_t e = output.element;
        for (std::size_t m = 0; m < methods; ++m) {
          Quality& quality = parts[chunk * methods + m];
          if (truth[e] == Vec3d{}) {  // the true normal is only rounding error, so no deltas are judged by it
            ++quality.degenerate;
            continue;
          }
          Vec3d shown, right = truth[e];
          switch (errors.deltas[m].deltas) {
            case BlendDeltas::kFile:
              shown = stored(output, weights);
              right = shown_direction(vector_at(subject_.shading->normals, output.number), base_[e], truth[e]);
              break;
            case BlendDeltas::kEndPoint:
              shown = ends[e];
              break;
            case BlendDeltas::kLeastSquares:
              shown = bests[e];
              break;
            case BlendDeltas::kExact:
              shown = vector_at(exact, e);
          }
          add(shown, right, {row, moved[i], 0}, quality);
        }
      }
    });
    for (std::size_t p = 0; p < parts.size(); ++p) errors.deltas[p % methods].quality.add(parts[p]);
  }

  // Adds an error in radians. A normal that cannot be lit has the largest possible error.
  static void add(const Vec3d& shown, const Vec3d& right, const ErrorPlace& place, Quality& quality) {
    const bool is_lit = is_finite(shown) && shown != Vec3d{};
    if (!is_lit) ++quality.missing;
    const double angle = is_lit ? angle_between(shown, right) : std::numbers::pi;
    quality.sum += angle;
    quality.sum_of_squares += angle * angle;
    ++quality.count;
    if (angle > quality.max) {
      quality.max = angle;
      quality.max_at = place;
    }
  }

  void locate_worst(std::span<const double> rows, BlendError& error) const {
    if (!(error.quality.max > 0)) return;
    const ErrorPlace& at = error.quality.max_at;
    for (std::size_t k = 0; k < targets(); ++k) {
      const double weight = rows[at.segment * targets() + k];
      if (weight != 0) error.worst_weights.push_back({k, weight});
    }
    error.worst_output = subject_.outputs[at.element].number;
    if (subject_.shading == nullptr) return;
    for (const GltfPart& part : subject_.shading->parts) {
      if (error.worst_output < part.first_vertex || error.worst_output - part.first_vertex >= part.vertex_count)
        continue;
      error.worst_primitive = part.primitive;
      error.worst_output -= part.first_vertex;
      break;
    }
  }

  const Subject& subject_;
  std::vector<std::vector<std::uint32_t>> moved_;
  BlendNormals normals_;
  std::vector<Vec3d> base_;
  DeltaNormals end_point_;
};

Status check(const BlendCompareOptions& options) {
  if (options.rows < 1 || options.rows > kMostBlendRows)
    return misuse("", "the number of poses must be from 1 to 10,000");
  if (options.active > 0 && !options.animation.empty())
    return misuse("",
                  "an animation itself says which targets are active; leave out either the number of active targets or "
                  "the animation");
  return Success{};
}

// Lists the numbers of targets that are active at the same time. Schemes are compared separately for each number. If
// `wanted` is not 0, the list has only this number, or the number of targets if it is smaller. Otherwise the list has
// the numbers in kActive that are below the number of targets, and then the number of targets.
std::vector<std::size_t> active_counts(std::size_t targets, std::size_t wanted) {
  if (wanted > 0) return {std::min(wanted, targets)};
  std::vector<std::size_t> result;
  for (const std::size_t active : kActive)
    if (active < targets) result.push_back(active);
  result.push_back(targets);
  return result;
}

std::size_t fitted_rows(std::size_t rows, std::size_t targets) { return std::max(rows, kRowsPerTarget * targets); }

Status check_memory(const std::string& place, std::size_t rows, std::size_t targets) {
  // fitted_rows() cannot overflow, because a list of so many targets would not fit into memory.
  if (targets == 0 || fitted_rows(rows, targets) <= kMostWeights / targets) return Success{};
  return invalid_input(place, "the weights of " + counted(rows, "pose", "poses") + " of " +
                                  counted(targets, "target", "targets") +
                                  " would need too much memory; compare fewer poses");
}

// Draws random weights for `own`, the mesh's own targets. Returns rows with the weights of all targets, in which the
// weights of correction targets follow from the drawn weights.
std::vector<double> random_rows(const Subject& subject, const std::vector<std::size_t>& own, std::size_t count,
                                std::size_t active, std::uint64_t seed) {
  const std::vector<double> drawn = random_blend_weights({own.size(), count, active, 0, 1, seed});
  const std::size_t targets = subject.set->targets.size();
  std::vector<double> rows(count * targets);
  for (std::size_t row = 0; row < count; ++row) {
    const std::span<double> weights(rows.data() + row * targets, targets);
    for (std::size_t i = 0; i < own.size(); ++i) weights[own[i]] = drawn[row * own.size() + i];
    if (subject.shading != nullptr) fill_extra_weights(*subject.shading, weights);
  }
  return rows;
}

void measure_random(BlendMeter& meter, const Subject& subject, const std::vector<std::size_t>& own,
                    const BlendCompareOptions& options, const std::function<void()>& progress, BlendSubject& result) {
  for (const std::size_t active : active_counts(own.size(), options.active)) {
    const std::vector<double> rows = random_rows(subject, own, options.rows, active, options.seed);
    const std::vector<double> others =
        random_rows(subject, own, fitted_rows(options.rows, own.size()), active, ~options.seed);
    result.errors.push_back(meter.measure(rows, others, progress));
    result.errors.back().active = active;  // the number of active targets, without correction targets
  }
}

BlendSubject describe(const Subject& subject, ElementKind kind) {
  BlendSubject result;
  result.kind = kind;
  result.vertices = subject.set->topology.vertex_count();
  result.faces = subject.set->topology.face_count();
  result.outputs = subject.outputs.size();
  for (const BlendTarget& target : subject.set->targets) result.targets.push_back(target.name);
  return result;
}

std::vector<Output> outputs_of(const GltfShading& shading) {
  std::vector<Output> result;
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v)
    if (shading.element_of_vertex[v] != GltfShading::kNoElement) result.push_back({shading.element_of_vertex[v], v});
  return result;
}

// Reads the weights that an animation gives a mesh, track after track. Returns an empty list if the animation has no
// weights for the mesh.
Result<std::vector<std::vector<double>>> animated_weights(const GltfDocument& document, std::size_t animation,
                                                          std::size_t mesh, std::size_t most) {
  const std::vector<GltfTrack>& tracks = document.animations()[animation].tracks;
  const std::size_t targets = document.meshes()[mesh].target_count;
  std::vector<WeightTrack> read;
  read.reserve(tracks.size());  // WeightUse points to these tracks, so they must not move
  WeightUse use(targets);
  std::vector<std::size_t> known;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (document.nodes()[tracks[t].node].mesh != mesh) continue;
    if (std::find(known.begin(), known.end(), tracks[t].same_keys_as) != known.end()) continue;
    known.push_back(tracks[t].same_keys_as);
    Result<GltfKeys> keys = document.keys(animation, t);
    if (!keys) return keys.error();
    read.push_back({tracks[t].interpolation, std::move(keys).value(), targets});
    use.add_track(read.back());
  }
  return use.samples(most);
}

bool has_stored_normals(const GltfMesh& mesh) {
  return std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                     [](const GltfPrimitive& p) { return p.has_faces() && p.has_normals; });
}

std::vector<std::size_t> own_targets(const GltfMesh& mesh) {
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k < mesh.target_count; ++k) {
    const auto is_it = [k](const GltfExtraTarget& extra) { return extra.target == k; };
    if (!mesh.mark || std::none_of(mesh.mark->extras.begin(), mesh.mark->extras.end(), is_it)) result.push_back(k);
  }
  return result;
}

}  // namespace

std::string_view name_of(BlendDeltas deltas) noexcept { return kNames[static_cast<std::size_t>(deltas)]; }

Result<BlendComparison> compare_blends(const Motion& star, const BlendCompareOptions& options) {
  if (const Status status = check(options); !status) return status.error();
  if (!options.animation.empty())
    return misuse("",
                  "this input has no animations, since only glTF files can have them; give a glTF file, or leave "
                  "--animation out");
  if (star.kind != MotionKind::kTargets)
    return misuse(
        "", "this input has no morph targets to blend, since it is a sequence of keyframes; give a mesh with targets");
  Result<BlendSet> set = blend_set_of(star);
  if (!set) return set.error();
  const std::size_t targets = set.value().targets.size();
  if (options.active > targets)
    return misuse("", "the input has only " + counted(targets, "target", "targets") +
                          "; choose a smaller number of active targets");
  if (const Status status = check_memory("", options.rows, targets); !status) return status.error();

  Subject subject;
  subject.set = &set.value();
  NormalGroups groups;
  const ElementKind kind = options.elements.kind;
  if (kind == ElementKind::kFaces) {
    for (std::uint32_t f = 0; f < set.value().topology.face_count(); ++f) subject.outputs.push_back({f, f});
  } else {
    Result<NormalGroups> made = make_groups(star, options.elements);
    if (!made) return made.error();
    groups = std::move(made).value();
    subject.groups = &groups;
    std::vector<bool> known(groups.size());
    const auto elements = groups.element_of_output();
    for (std::uint32_t i = 0; i < elements.size(); ++i) {
      if (!known[elements[i]]) subject.outputs.push_back({elements[i], i});
      known[elements[i]] = true;
    }
  }
  std::vector<std::size_t> own(targets);
  for (std::size_t k = 0; k < targets; ++k) own[k] = k;
  const std::size_t total = active_counts(targets, options.active).size() * options.rows;
  std::size_t done = 0;
  const auto progress = [&] {
    if (options.progress) options.progress(++done, total);
  };
  BlendComparison result;
  result.subjects.push_back(describe(subject, kind));
  BlendMeter meter(subject);
  measure_random(meter, subject, own, options, progress, result.subjects.back());
  return result;
}

Result<BlendComparison> compare_blends(const GltfDocument& document, const BlendCompareOptions& options) {
  if (const Status status = check(options); !status) return status.error();
  std::optional<std::size_t> animation;
  if (!options.animation.empty()) {
    const Result<std::size_t> found = document.find_animation(options.animation);
    if (!found) return found.error();
    animation = found.value();
  }
  const std::vector<GltfMesh>& meshes = document.meshes();
  std::vector<std::size_t> compared;
  std::size_t total = 0, done = 0, most = 0;
  BlendComparison result;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const std::string place = (document.name() + ", /meshes/").append(std::to_string(m));
    const auto has_faces = [](const GltfPrimitive& p) { return p.has_faces(); };
    if (meshes[m].target_count == 0 ||
        std::none_of(meshes[m].primitives.begin(), meshes[m].primitives.end(), has_faces))
      continue;
    if (!has_stored_normals(meshes[m])) {
      ++result.flat;
      continue;
    }
    if (animation) {
      const std::vector<GltfTrack>& tracks = document.animations()[*animation].tracks;
      const auto drives = [&](const GltfTrack& track) { return document.nodes()[track.node].mesh == m; };
      if (std::none_of(tracks.begin(), tracks.end(), drives)) continue;
    } else if (meshes[m].mark && meshes[m].mark->sequence) {
      return misuse(
          place,
          "the targets of this mesh are the keyframes of a baked sequence; choose its animation with --animation");
    }
    if (const Status status = check_memory(place, options.rows, meshes[m].target_count); !status) return status.error();
    const std::size_t own = own_targets(meshes[m]).size();
    most = std::max(most, own);
    total += options.rows * (animation ? 1 : active_counts(own, options.active).size());
    compared.push_back(m);
  }
  if (compared.empty()) {
    if (animation)
      return misuse("", "the animation drives no mesh with morph targets and normals; choose another animation");
    return invalid_input(document.name(),
                         "the file has no mesh with both morph targets and normals; export the mesh with both");
  }
  if (options.active > most)
    return misuse("", "no mesh has more than " + counted(most, "target", "targets") +
                          "; choose a smaller number of active targets");
  const auto progress = [&] {
    if (options.progress) options.progress(std::min(++done, total), total);
  };
  for (const std::size_t m : compared) {
    const Result<GltfShading> shading = read_gltf_shading(document, m);
    if (!shading) return shading.error();
    Subject subject{&shading.value().set, &shading.value().groups, &shading.value(), outputs_of(shading.value())};
    BlendMeter meter(subject);
    if (!meter.moves()) {
      ++result.still;
      continue;
    }
    BlendSubject described = describe(subject, ElementKind::kVertices);
    described.mesh = m;
    described.name = meshes[m].name;
    if (animation) {
      const auto poses = animated_weights(document, *animation, m, options.rows);
      if (!poses) return poses.error();
      std::vector<double> rows;
      for (const std::vector<double>& pose : poses.value()) rows.insert(rows.end(), pose.begin(), pose.end());
      described.errors.push_back(meter.measure(rows, rows, progress));
    } else {
      measure_random(meter, subject, own_targets(meshes[m]), options, progress, described);
    }
    result.subjects.push_back(std::move(described));
  }
  return result;
}

}  // namespace chronormal
