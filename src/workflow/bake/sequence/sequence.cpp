// Bakes a sequence. A viewer renders normalize(N + sum_k w_k D_k). Each key has a target whose weight is a hat: it is 1
// at the key and falls linearly to 0 at both neighbours. Each segment has one more target with the weight t (1 - t).
// The sum is then eq. 41 of docs/theory.md (section 15), so the normals are exact.
//
//     AreaSums                        sums of the areas of faces around elements, in blocks          area_sums
//     SequenceNormals                 normals at keys and bends between keys, from a stream         sequence_normals
//     sequence_elements               base normals, and which of them key 0 cannot have             sequence_deltas
//     *_deltas, each_exact_segment    the deltas of each target, as arrays                          sequence_deltas
//     unit_*                          deltas that every viewer renders alike                        harmless_sequence
//     fewest_keys                     the instants that need keys                                   fewest_keys
//     SequenceFile                    the arrays, the weights that drive them, and the mark, as a GLB   sequence_file
//
// Each step goes through all keyframes. Two keyframes are in memory at a time or, while keys are chosen, the keyframes
// between two keys. The arrays of the file are written to a spool. For this reason memory does not grow with the number
// of keyframes, unless a weighting other than area is fitted.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "chronormal/analysis/quality.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/bake.h"
#include "core/text.h"
#include "io/bytes/output_file.h"
#include "io/bytes/spool.h"
#include "io/gltf/glb/glb_builder.h"
#include "motion/triangles.h"
#include "workflow/bake/sequence/fewest_keys.h"
#include "workflow/bake/sequence/harmless_sequence.h"
#include "workflow/bake/sequence/sequence_deltas.h"
#include "workflow/bake/sequence/sequence_file.h"
#include "workflow/bake/sequence/sequence_normals.h"
#include "workflow/shading/authored_weighting.h"

namespace chronormal {
namespace {

using Step = std::function<void(std::size_t done, std::size_t total)>;

Result<NormalGroups> groups_of(MotionStream& stream, const BakeOptions& options) {
  const bool are_vertices = options.normal_of_corner.count == 0 && options.crease_angle == 180;
  return make_groups(stream, {.kind = are_vertices ? ElementKind::kVertices : ElementKind::kCorners,
                              .weld = options.weld,
                              .crease_angle = options.crease_angle,
                              .normal_of_corner = options.normal_of_corner});
}

// Makes the groups, and leaves the stored normals out of the options, with a warning, if they have nothing to do with
// the surface at keyframe 0. For example, the normals of a mesh do not fit a cache with another order of vertices.
Result<NormalGroups> groups_without_foreign(MotionStream& stream, BakeOptions& options,
                                            std::vector<std::string>& warnings) {
  Result<NormalGroups> groups = groups_of(stream, options);
  if (!groups || options.normal_of_corner.count == 0) return groups;
  if (const Status status = stream.hold(0, 0); !status) return status.error();
  const std::vector<float>& base = stream.motion().keyframes[0].positions;
  const double angle =
      median_angle(stream.motion().topology, VectorView<const float>::packed(base.data(), base.size() / 3),
                   groups.value(), options.normal_of_corner);
  if (!(angle > kLargestMedian)) return groups;
  warnings.push_back(
      "the stored normals differ from the surface by " + with_decimals(angle, 1) +
      " degrees in the median, so they do not belong to it and are ignored; check that the cache belongs to this "
      "mesh");
  options.normal_of_corner = {};
  options.normals_of_keyframe = {};
  return groups_of(stream, options);
}

// Returns the weighting that the stored normals clearly follow, for a bake whose options give no weighting. Returns area
// if there is no such weighting, or if fits of all segments to this weighting would take too much memory.
Weighting weighting_of(MotionStream& stream, const NormalGroups& groups, const BakeOptions& options) {
  constexpr double kMostBytes = 1 << 30, kBytesOfFit = 80;
  const Motion& motion = stream.motion();
  const auto segments = static_cast<double>(motion.segments.size());
  if (options.weighting || options.normal_of_corner.count == 0 ||
      kBytesOfFit * segments * static_cast<double>(groups.size()) > kMostBytes)
    return Weighting::kArea;
  std::vector<float> later;
  const auto read = [&](std::size_t k) -> std::optional<ShadedKeyframe> {
    VectorView<const float> normals = options.normal_of_corner;
    if (k > 0) {
      Result<std::vector<float>> of_keyframe =
          options.normals_of_keyframe ? options.normals_of_keyframe(k) : std::vector<float>();
      if (!of_keyframe || of_keyframe.value().size() != 3 * motion.topology.corner_count()) return std::nullopt;
      later = std::move(of_keyframe).value();
      normals = VectorView<const float>::packed(later.data(), later.size() / 3);
    }
    if (!stream.hold(k, k)) return std::nullopt;
    std::vector<StoredNormal> stored;
    for (std::uint32_t e = 0; e < groups.size(); ++e) {
      if (groups.corners(e).empty()) continue;
      const std::size_t c = groups.corners(e)[0];
      const Vec3d normal = to_double(normals[c]);
      if (normal != Vec3d{} && is_finite(normal)) stored.push_back({motion.topology.corners()[c], e, normal});
    }
    const std::vector<float>& positions = motion.keyframes[k].positions;
    return ShadedKeyframe{VectorView<const float>::packed(positions.data(), positions.size() / 3), std::move(stored)};
  };
  return find_authored_weighting(motion.topology, groups, motion.keyframes.size(), read).detected;
}

// Returns the times of keyframes as the file stores them: in float32, and shifted so that no time is below 0.
Result<std::vector<float>> file_times(const Motion& motion, std::vector<std::string>& warnings) {
  const double shift = std::max(-motion.keyframes[0].time, 0.0);
  if (shift > 0)
    warnings.push_back(
        "the motion starts before time 0, which glTF does not allow; its times are moved so that it starts at 0");
  std::vector<float> times;
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    const auto time = static_cast<float>(keyframe.time + shift);
    // The shortest time between two keys, in seconds. The slope of a weight is up to 1 / (time between two keys), and
    // float32 must be able to hold this slope.
    constexpr double kShortest = 1 / static_cast<double>(std::numeric_limits<float>::max());
    const bool is_after = times.empty() || double{time} - double{times.back()} > kShortest;
    if (!is_after || !std::isfinite(time))
      return invalid_input("keyframe " + std::to_string(times.size()),
                           "this keyframe is so close to the one before that glTF cannot tell their times apart; leave "
                           "one of the two keyframes out");
    times.push_back(time);
  }
  return times;
}

// Wraps elements in HarmlessElements, without counting deltas beyond 1. Encodings that do not limit deltas for
// compressors use this function.
Result<HarmlessElements> without_limits(Result<std::vector<SequenceElement>> elements) {
  if (!elements) return elements.error();
  return HarmlessElements{std::move(elements).value(), 0};
}

// Counts the polygons that cross themselves. Some triangles of such a polygon face the other way.
std::size_t count_crossing(const Topology& topology, const std::vector<float>& positions) {
  const auto at = [&](std::uint32_t v) {
    return to_double(VectorView<const float>::packed(positions.data(), topology.vertex_count())[v]);
  };
  std::size_t count = 0;
  for (std::size_t f = 0; f < topology.face_count() && !topology.all_triangles(); ++f) {
    const auto face = topology.face(f);
    std::vector<Vec3d> triangles;
    Vec3d normal;
    for (const auto& [a, b, c] : triangles_of_face(face, positions)) {
      triangles.push_back(cross(at(face[b]) - at(face[a]), at(face[c]) - at(face[a])));
      normal = normal + triangles.back();
    }
    const bool turns =
        std::any_of(triangles.begin(), triangles.end(), [&](const Vec3d& n) { return dot(n, normal) < 0; });
    count += turns ? 1 : 0;
  }
  return count;
}

// Returns the largest error bound of the normals that were fitted to a weighting, in degrees. Returns 0 if normals are
// weighted by area.
double largest_bound(const SequenceNormals& normals) {
  double largest = 0;
  for (const std::vector<double>& bounds : normals.bounds()) {
    for (const double bound : bounds) largest = std::max(largest, kDegreesPerRadian * bound);
  }
  return largest;
}

void report_elements(const std::vector<SequenceElement>& elements, BakeEncoding encoding, SequenceBake& report) {
  const auto freed =
      std::count_if(elements.begin(), elements.end(), [](const SequenceElement& e) { return e.frees_base; });
  const auto without =
      std::count_if(elements.begin(), elements.end(), [](const SequenceElement& e) { return e.has_none; });
  report.without_normals = static_cast<std::size_t>(without);
  if (encoding == BakeEncoding::kExact && freed > 0)
    report.warnings.push_back(std::to_string(freed) + (freed == 1 ? " normal needs" : " normals need") +
                              " a morph target for keyframe 0, whose weight is 1 at rest, since the faces around have "
                              "no area in this keyframe, or much less than later");
}

// Adds the targets of the encoding exact to the file, and records in which segments normals bend. If are_final is
// false, the elements may still change. The function then returns false as soon as a segment needs other elements.
Result<bool> try_exact(const SequenceNormals& normals, const std::vector<SequenceElement>& elements, bool are_final,
                       const Step& step, SequenceTargets& targets, SequenceFile& file) {
  return each_exact_segment(normals, elements, are_final, [&](std::size_t s, const ExactSegment& values) {
    if (s == 0 && targets.has_key_0) file.add_key(0, {}, values.start);
    file.add_key(s + 1, values.positions, values.key);
    if (values.bends) {
      targets.bent_segments.push_back(s);
      file.add_bend(s, values.bend);
    }
    step(s + 1, normals.keys() - 1);
    return file.check();
  });
}

bool any_frees_base(const std::vector<SequenceElement>& elements) {
  return std::any_of(elements.begin(), elements.end(), [](const SequenceElement& e) { return e.frees_base; });
}

// Writes the targets of the encoding exact. In almost every sequence the first segment determines the base normals of
// all elements, and the keyframes are read once. Otherwise the keyframes are read three times.
Status write_exact(const SequenceNormals& normals, std::vector<SequenceElement>& elements, const Step& step,
                   SequenceTargets& targets, SequenceFile& file) {
  std::size_t furthest = 0;
  const Step forward = [&](std::size_t done, std::size_t total) {
    if (done > furthest) step(furthest = done, total);
  };
  if (!any_frees_base(elements)) {
    const Result<bool> written = try_exact(normals, elements, false, forward, targets, file);
    if (!written) return written.error();
    if (written.value()) return Success{};
  }
  if (Status status = normals.check_deltas(normals.keys()); !status) return status;
  Result<std::vector<SequenceElement>> all = sequence_elements(normals);
  if (!all) return all.error();
  elements = std::move(all).value();
  targets.has_key_0 = any_frees_base(elements);
  targets.bent_segments.clear();
  file.restart(normals.base(), elements);
  const Result<bool> written = try_exact(normals, elements, true, forward, targets, file);
  if (!written) return written.error();
  return Success{};
}

// Adds the targets of the encoding endpoint to the file. Returns the largest angle that is left between rendered and
// true normals, in degrees.
Result<double> write_endpoint(const SequenceNormals& normals, const std::vector<SequenceElement>& elements,
                              const Step& step, SequenceFile& file) {
  EndDeltas end{std::vector<Vec3d>(elements.size()), 0};
  double largest = 0;
  const Status status = each_segment(normals, [&](std::size_t s, const SegmentForm& form) {
    const auto bounds = normals.bounds().empty() ? std::span<const double>() : std::span(normals.bounds()[s]);
    end = end_deltas(elements, form, bounds, end.deltas);
    largest = std::max(largest, kDegreesPerRadian * std::min(end.error, std::numbers::pi));
    file.add_key(s + 1, normals.deltas(s + 1), end.deltas);
    step(s + 1, normals.keys() - 1);
    return file.check();
  });
  if (!status) return status.error();
  return largest;
}

// Returns the largest number of targets that all of these viewers support, or the largest integer if no viewer has a
// limit.
std::size_t room_for_targets(std::span<const Viewer> viewers) {
  std::size_t room = std::numeric_limits<std::size_t>::max();
  for (const Viewer& viewer : viewers)
    if (viewer.most_targets > 0) room = std::min(room, viewer.most_targets);
  return room;
}

// Calls body(segment, form, ends) for every segment. `form` has the normals of the segment, and `ends` their directions
// at its two keys.
template <class Body>
Status each_unit_segment(const SequenceNormals& normals, const std::vector<SequenceElement>& elements,
                         const Body& body) {
  SegmentEnds ends;
  return each_segment(normals, [&](std::size_t s, const SegmentForm& form) {
    ends = segment_ends(elements, form, ends.to);
    return body(s, form, ends);
  });
}

// Chooses the segments that get a bend. If viewers support fewer bends (`room`) than there are segments, chooses the
// segments in which bends reduce errors most.
Result<std::vector<bool>> segments_to_bend(const SequenceNormals& normals, const std::vector<SequenceElement>& elements,
                                           std::size_t room) {
  const std::size_t segments = normals.keys() - 1;
  std::vector<bool> is_bent(segments, segments <= room);
  if (segments <= room) return is_bent;
  std::vector<std::pair<double, std::size_t>> gains;
  const auto weigh = [&](std::size_t s, const SegmentForm& form, const SegmentEnds& ends) -> Status {
    gains.emplace_back(-unit_bends(elements, form, ends).gain, s);
    return Success{};
  };
  if (const Status status = each_unit_segment(normals, elements, weigh); !status) return status.error();
  std::sort(gains.begin(), gains.end());
  for (std::size_t n = 0; n < room; ++n) is_bent[gains[n].second] = true;
  return is_bent;
}

// Adds the targets of the encoding harmless to the file, and records in which segments normals bend. Returns the
// largest angle that is left between rendered and true normals, in degrees.
Result<double> write_harmless(const SequenceNormals& normals, const std::vector<SequenceElement>& elements,
                              std::span<const Viewer> viewers, const Step& step, SequenceTargets& targets,
                              SequenceFile& file) {
  const std::size_t room = room_for_targets(viewers), total = 2 * normals.keys() - 1;
  const Result<std::vector<bool>> chosen =
      segments_to_bend(normals, elements, room - std::min(room, targets.of_keys()));
  if (!chosen) return chosen.error();
  const std::vector<bool>& is_bent = chosen.value();
  Status status = each_unit_segment(normals, elements, [&](std::size_t s, const SegmentForm&, const SegmentEnds& ends) {
    if (s == 0 && targets.has_key_0) file.add_key(0, {}, unit_key_deltas(elements, ends.from));
    file.add_key(s + 1, normals.deltas(s + 1), unit_key_deltas(elements, ends.to));
    step(s + 1, total);
    return file.check();
  });
  if (!status) return status.error();
  double largest = 0;
  status = each_unit_segment(normals, elements, [&](std::size_t s, const SegmentForm& form, const SegmentEnds& ends) {
    const UnitBends bends = unit_bends(elements, form, ends);
    if (is_bent[s] && !bends.deltas.empty()) {
      targets.bent_segments.push_back(s);
      file.add_bend(s, bends.deltas);
    }
    largest = std::max(largest, is_bent[s] ? bends.error : bends.straight);
    step(normals.keys() + s, total);
    return file.check();
  });
  if (!status) return status.error();
  return kDegreesPerRadian * largest;
}

// Chooses keys, and adds a target for each key except the first one. Returns the times of all keys, in seconds.
Result<std::vector<float>> write_keys(const Motion& motion, const SequenceNormals& normals,
                                      const std::vector<SequenceElement>& elements, const std::vector<float>& keyframes,
                                      double tolerance, const Step& step, SequenceFile& file, SequenceBake& report) {
  const std::size_t segments = motion.segments.size();
  const Result<SequenceKeys> found =
      fewest_keys(motion, normals, tolerance / kDegreesPerRadian, [&](std::size_t s) { step(s, 2 * segments); });
  if (!found) return found.error();
  const SequenceKeys& keys = found.value();
  report.largest_error = kDegreesPerRadian * keys.largest_error;
  report.keys = {keys.at.size(), 0, 0, keys.even, keys.beyond};
  std::vector<float> times;
  for (std::size_t k = 0; k < keys.at.size(); ++k) {
    const std::size_t at = keys.at[k], s = std::min(at / kKeySteps, segments - 1);
    const double t = static_cast<double>(at - s * kKeySteps) / kKeySteps;
    times.push_back(static_cast<float>((1 - t) * double{keyframes[s]} + t * double{keyframes[s + 1]}));
    if (k > 0 && !(times[k] > times[k - 1]))
      return invalid_input("keyframe " + std::to_string(s),
                           "the next keyframe is so close in time that no key fits between the two in float32; leave "
                           "one of the two keyframes out");
    if (at % kKeySteps != 0) ++report.keys->in_between;
    if (k == 0) continue;
    const Result<KeyPose> pose = key_pose(normals, at);
    if (!pose) return pose.error();
    file.add_key(k, pose.value().deltas, unit_key_deltas(elements, pose.value().directions));
    step(segments + s, 2 * segments);
    if (Status status = file.check(); !status) return status.error();
  }
  report.keys->left_out = segments + 1 + report.keys->in_between - report.keys->count;
  if (keys.beyond > 0)
    report.warnings.push_back("in " + std::to_string(keys.beyond) + (keys.beyond == 1 ? " case" : " cases") +
                              ", a normal vanishes or turns too fast between two keyframes, and its error exceeds the "
                              "tolerance there; add keyframes, or use --encode exact");
  return times;
}

std::string titles_of_others(std::span<const Viewer> viewers) {
  std::string titles;
  for (const Viewer& viewer : viewers)
    if (viewer.normals != NormalRule::kSum) titles.append(titles.empty() ? "" : ", ").append(viewer.title);
  return titles;
}

void warn_of_viewers(BakeEncoding encoding, std::span<const Viewer> viewers, std::size_t targets,
                     std::size_t without_room, std::vector<std::string>& warnings) {
  if (const std::string titles = titles_of_others(viewers); encoding != BakeEncoding::kHarmless && !titles.empty())
    warnings.push_back("--encode " + std::string(name_of(encoding)) + " can look wrong in " + titles +
                       "; use --encode harmless for these viewers");
  if (without_room > 0)
    warnings.push_back(std::to_string(without_room) + (without_room == 1 ? " normal turns" : " normals turn") +
                       " so far from keyframe 0 that compressors change such normals; check the compressed file with "
                       "chronormal audit");
  for (const Viewer& viewer : viewers)
    if (viewer.most_targets > 0 && targets > viewer.most_targets)
      warnings.push_back(counted(targets, "target is", "targets are") + " too many for " + std::string(viewer.title) +
                         "; " + std::string(viewer.beyond) + ", so bake fewer keyframes");
}

// Returns the options with all viewers among the viewers for which the bake is made. A sequence has no candidates to
// choose from, so the bake is the same for all viewers.
BakeOptions for_all_viewers(const BakeOptions& asked) {
  BakeOptions options = with_viewers(asked);
  options.viewers.insert(options.viewers.end(), options.spared.begin(), options.spared.end());
  options.spared.clear();
  return options;
}

// Bakes a sequence. Writes the arrays of the file to the spool, and in the end passes all bytes of the file to `take`.
Result<SequenceBake> bake_stream(MotionStream& stream, const BakeOptions& asked, Spool spool,
                                 const GlbBuilder::Take& take) {
  BakeOptions options = for_all_viewers(asked);
  const Motion& motion = stream.motion();
  const BakeEncoding encoding = options.encoding.value_or(BakeEncoding::kExact);
  const Step step = options.progress ? options.progress : [](std::size_t, std::size_t) {};
  const double tolerance = options.tolerance.value_or(kHarmlessTolerance);
  if (encoding == BakeEncoding::kKeys) {
    if (options.weighting.value_or(Weighting::kArea) != Weighting::kArea)
      return Error{
          ErrorCode::kUsage, "",
          "--encode keys can only be used with --weighting area; leave --weighting out, or choose another --encode"};
    if (!(tolerance >= kLeastKeyTolerance))
      return Error{ErrorCode::kUsage, "",
                   "the tolerance of --encode keys must be at least 0.001 degrees; choose a larger --tolerance"};
  }
  SequenceBake report;
  const Result<NormalGroups> groups = groups_without_foreign(stream, options, report.warnings);
  if (!groups) return groups.error();
  const bool is_authored = encoding != BakeEncoding::kKeys;
  const VectorView<const float> stored = is_authored ? options.normal_of_corner : VectorView<const float>();
  Result<SequenceNormals> made = Error{ErrorCode::kFailed, "", ""};
  if (const Weighting weighting = is_authored ? weighting_of(stream, groups.value(), options) : Weighting::kArea;
      weighting != Weighting::kArea && !options.weighting) {
    made = SequenceNormals::make(stream, groups.value(), weighting, stored);
    if (made)
      report.weighting = weighting;
    else
      report.warnings.push_back("the stored normals are weighted by " + std::string(weighting_name(weighting)) +
                                ", but the result is weighted by area, since at " + made.error().text());
  }
  if (!made) made = SequenceNormals::make(stream, groups.value(), options.weighting.value_or(Weighting::kArea), stored);
  if (!made) return made.error();
  const SequenceNormals& normals = made.value();
  report.has_offsets = normals.has_offsets();
  Result<std::vector<float>> times = file_times(motion, report.warnings);
  if (!times) return times.error();

  const bool is_exact = encoding == BakeEncoding::kExact;
  // Checks that float32 can hold all deltas. The encoding exact needs no check here, because it checks deltas while it
  // writes them. Fits need no check either, because deltas were checked before the fits were made.
  if (!is_exact && normals.bounds().empty()) {
    if (const Status status = normals.check_deltas(normals.keys()); !status) return status.error();
  }
  const bool are_units = encoding == BakeEncoding::kHarmless || encoding == BakeEncoding::kKeys;
  Result<HarmlessElements> found = are_units  ? harmless_elements(normals)
                                   : is_exact ? without_limits(elements_of_start(normals))
                                              : without_limits(sequence_elements(normals));
  if (!found) return found.error();
  std::vector<SequenceElement>& elements = found.value().elements;
  SequenceTargets targets{are_units ? BakeEncoding::kHarmless : encoding, false, normals.keys(), {}};
  const bool by_area =
      report.weighting == Weighting::kArea && options.weighting.value_or(Weighting::kArea) == Weighting::kArea;
  targets.follow_author = encoding != BakeEncoding::kEndpoint && !(by_area && motion.topology.all_triangles());
  SequenceFile file(motion.topology, groups.value(), normals.base(), elements, options, std::move(spool));
  file.set_origin(motion.origin);
  if (is_exact) {
    if (Status status = write_exact(normals, elements, step, targets, file); !status) return status.error();
  }
  report_elements(elements, encoding, report);
  report.largest_error = largest_bound(normals);
  if (const std::size_t crossing = count_crossing(motion.topology, normals.base()); crossing > 0)
    report.warnings.push_back(
        std::to_string(crossing) +
        (crossing == 1 ? " polygon crosses itself, so its" : " polygons cross themselves, so their") +
        " triangles overlap in the file; split such polygons to avoid this");
  report.keyframes = normals.keys();
  report.vertices = file.vertex_count();
  if (encoding == BakeEncoding::kKeys) {
    times = write_keys(motion, normals, elements, times.value(), tolerance, step, file, report);
    if (!times) return times.error();
    targets.keys = times.value().size();
  } else if (!is_exact) {
    const Result<double> error = encoding == BakeEncoding::kEndpoint
                                     ? write_endpoint(normals, elements, step, file)
                                     : write_harmless(normals, elements, options.viewers, step, targets, file);
    if (!error) return error.error();
    report.largest_error = std::max(report.largest_error, error.value());
  }
  warn_of_viewers(targets.encoding, options.viewers, targets.count(), found.value().without_room, report.warnings);
  const Result<std::size_t> bytes = file.finish(targets, times.value(), take);
  if (!bytes) return bytes.error();
  report.targets = targets.of_keys();
  report.extra_targets = targets.bent_segments.size();
  report.bytes = bytes.value();
  return report;
}

}  // namespace

Result<SequenceBake> bake_sequence(const Motion& motion, const BakeOptions& options, std::string& glb) {
  MotionStream stream(motion);
  std::string bytes;
  Result<SequenceBake> baked = bake_stream(stream, options, Spool(), GlbBuilder::gather_in(bytes));
  if (baked) glb = std::move(bytes);
  return baked;
}

Result<SequenceBake> bake_sequence(MotionStream& stream, const BakeOptions& options, const std::string& path,
                                   bool force) {
  Result<OutputFile> file = OutputFile::create(path, force);
  if (!file) return file.error();
  Result<Spool> spool = file.value().spool();
  if (!spool) return spool.error();
  Result<SequenceBake> baked =
      bake_stream(stream, options, std::move(spool).value(),
                  [&](std::string_view bytes, std::size_t) { return file.value().append(bytes); });
  if (!baked) return baked.error();
  if (const Status status = file.value().finish(); !status) return status.error();
  return baked;
}

}  // namespace chronormal
