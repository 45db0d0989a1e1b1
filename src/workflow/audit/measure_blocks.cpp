// Measures blocks of outputs on all threads, and adds up their errors in the order of the outputs.
#include "workflow/audit/measure_blocks.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/quality/kernels/shown_angles.h"
#include "chronormal/core/parallel.h"
#include "core/blocks.h"
#include "core/float32.h"
#include "core/rounding.h"
#include "workflow/audit/measure.h"

namespace chronormal::inline internal {
namespace {

// The number of blocks per thread that are measured before their results are added up. It is large enough to keep all
// threads busy, and small enough for the results to take little memory.
constexpr std::size_t kBlocksPerWaveAndThread = 8;

// The largest number of samples per segment for which outputs are measured block by block. The errors of a block take
// 20 kB for each sample.
constexpr std::size_t kMostSamples = 128;

// A group of outputs that are measured together, and the faces from which their normals are computed.
struct Block {
  IndexRange outputs, elements;
  // For each face of the block, the indices of its three vertices in the mesh.
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> faces, face_ends;  // the faces of each element, by their numbers in the block
};

std::vector<Block> make_blocks(const JudgedPart& part) {
  const std::span<const JudgedOutput> outputs = part.outputs();
  std::vector<Block> blocks;
  std::vector<std::uint32_t> number(part.face_count()), owner(part.face_count());
  for (std::size_t first = 0; first < outputs.size(); first += kRange) {
    Block& block = blocks.emplace_back();
    const auto b = static_cast<std::uint32_t>(blocks.size());
    const std::size_t last = std::min(first + kRange, outputs.size());
    block.outputs = {first, last - first};
    block.elements.first = outputs[first].element;
    block.elements.count = outputs[last - 1].element + 1 - block.elements.first;
    for (std::size_t e = block.elements.first; e < block.elements.end(); ++e) {
      for (const std::uint32_t face : part.faces_of(e)) {
        if (owner[face] != b) {
          owner[face] = b;
          number[face] = static_cast<std::uint32_t>(block.corners.size() / 3);
          for (const std::uint32_t v : part.corners_of(face)) block.corners.push_back(part.vertices()[v]);
        }
        block.faces.push_back(number[face]);
      }
      block.face_ends.push_back(static_cast<std::uint32_t>(block.faces.size()));
    }
  }
  return blocks;
}

struct Scratch {
  TrianglesInMotion triangles;
  std::vector<TrianglesInMotion::Normal> faces;
  PlanesOf4 start, end, between;  // true normals at both ends of a segment and at a moment in between
  PlanesOf4 from, to;             // the normals at both ends as a viewer stores them
  std::vector<double> degrees;
};

// Adds up the normals of the faces around each element at time t, and also the lengths of these face normals.
void add_up_at(const Block& block, double t, Scratch& scratch, PlanesOf4& result) {
  scratch.triangles.normals(t, scratch.faces);
  sums_around(scratch.faces, block.faces, block.face_ends, result);
}

Vec3d normal_of(const PlanesOf4& sums, std::size_t e) {
  return without_rounding(Vec3d{sums.x[e], sums.y[e], sums.z[e]}, kRoundingOfTerms * sums.w[e]);
}

// Raises each entry of `largest` to the length of the largest control normal that its element has in `segments`, as in
// largest_control_normals() in measure.h.
void keep_largest_normals(const Motion& motion, std::span<const std::size_t> segments, const Block& block,
                          std::vector<double>& largest) {
  Scratch scratch;
  std::optional<std::size_t> keyframe;  // the keyframe whose normals scratch.end has
  for (const std::size_t s : segments) {
    const Segment segment = motion.segment(s);
    scratch.triangles.gather(segment.from, segment.to, block.corners);
    if (keyframe == motion.segments[s].from)
      std::swap(scratch.start, scratch.end);
    else
      add_up_at(block, 0, scratch, scratch.start);
    add_up_at(block, 0.5, scratch, scratch.between);
    add_up_at(block, 1, scratch, scratch.end);
    keyframe = motion.segments[s].to;
    for (std::size_t e = 0; e < largest.size(); ++e) {
      const Vec3d start = normal_of(scratch.start, e), end = normal_of(scratch.end, e);
      const Vec3d m = 2.0 * normal_of(scratch.between, e) - 0.5 * (start + end);
      largest[e] = std::max({largest[e], length(start), length(m), length(end)});
    }
  }
}

// Replaces each number by the largest value that any peer process has for this number. Sends all numbers in one
// exchange.
void maximize(const SegmentRun& run, std::vector<std::vector<double>>& numbers) {
  if (run.peers == nullptr) return;
  std::vector<double> all;
  for (const std::vector<double>& some : numbers) all.insert(all.end(), some.begin(), some.end());
  run.maximize(all);
  auto from = all.begin();
  for (std::vector<double>& some : numbers) {
    const auto end = from + static_cast<std::ptrdiff_t>(some.size());
    std::copy(from, end, some.begin());
    from = end;
  }
}

// Computes the normals that a viewer stores at a keyframe and interpolates afterwards: the true normals, rounded to
// float32.
void keep_as_viewer(AuditRule rule, const PlanesOf4& sums, PlanesOf4& result) {
  result.resize(sums.x.size());
  for (std::size_t e = 0; e < sums.x.size(); ++e) {
    Vec3d kept = rounded_to_float(unit(normal_of(sums, e)));
    if (rule != AuditRule::kLerp) kept = unit(kept);
    result.x[e] = kept.x;
    result.y[e] = kept.y;
    result.z[e] = kept.z;
  }
}

// Returns a bound of the change of an element's normal if the positions are rounded to float32.
double rounding_at(const Segment& segment, double t, const Block& block, std::size_t e) {
  double sum = 0;
  for (std::uint32_t i = e == 0 ? 0 : block.face_ends[e - 1]; i < block.face_ends[e]; ++i) {
    const std::uint32_t* const corners = &block.corners[3 * std::size_t{block.faces[i]}];
    sum += rounding_of_area(3, [&](std::size_t c) {
      return lerp(to_double(segment.from[corners[c]]), to_double(segment.to[corners[c]]), t);
    });
  }
  return sum;
}

// Returns the normal that a viewer renders for element e, interpolated between the normals that the viewer keeps at
// both ends of the segment.
Vec3d shown_at(const Scratch& scratch, std::size_t e, double weight) {
  const auto kept = [e](const PlanesOf4& planes) { return Vec3d{planes.x[e], planes.y[e], planes.z[e]}; };
  return rounded_to_float(unit(lerp(kept(scratch.from), kept(scratch.to), weight)));
}

// Computes the errors of a block at each sample of a segment, and writes them to `errors`.
void measure_block(const Segment& segment, std::size_t number, const Block& block, std::span<const double> largest,
                   const JudgedPart& part, AuditRule rule, const FindPlace& at, Scratch& scratch,
                   std::span<MotionError> errors) {
  scratch.triangles.gather(segment.from, segment.to, block.corners);
  add_up_at(block, 0, scratch, scratch.start);
  add_up_at(block, 1, scratch, scratch.end);
  keep_as_viewer(rule, scratch.start, scratch.from);
  keep_as_viewer(rule, scratch.end, scratch.to);
  for (std::size_t e = 0; e < largest.size(); ++e) scratch.from.w[e] = kVanished * largest[e];
  scratch.degrees.resize(block.elements.count);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double t = time_of_sample(i, errors.size());
    const bool is_inside = i > 0 && i + 1 < errors.size();
    if (is_inside) add_up_at(block, t, scratch, scratch.between);
    const PlanesOf4& right = is_inside ? scratch.between : i == 0 ? scratch.start : scratch.end;
    const double weight = rule != AuditRule::kStep ? t : t < 1 ? 0 : 1;
    shown_angles({scratch.from, scratch.to, right, kRoundingOfTerms}, weight, scratch.degrees);
    errors[i] = {};
    add_errors(
        part.outputs().subspan(block.outputs.first, block.outputs.count),
        [&](const JudgedOutput& output, std::size_t) { return scratch.degrees[output.element - block.elements.first]; },
        [&](const JudgedOutput& output, std::size_t) {
          const std::size_t e = output.element - block.elements.first;
          const Vec3d normal = normal_of(right, e);
          const double faint = normal == Vec3d{} ? kNotJudged
                                                 : faint_degrees(shown_at(scratch, e, weight), normal, length(normal),
                                                                 rounding_at(segment, t, block, e));
          return faint == kNotJudged && right.w[e] > scratch.from.w[e] ? kCancels : faint;
        },
        [&](const JudgedOutput& output) { return at(number, t, output); }, errors[i]);
  }
}

}  // namespace

bool can_measure_blocks(const JudgedPart& part, AuditRule rule, Weighting weighting, std::size_t samples) noexcept {
  if (samples > kMostSamples) return false;
  if (weighting != Weighting::kArea) return false;
  if (rule != AuditRule::kLerp && rule != AuditRule::kNlerp && rule != AuditRule::kStep) return false;
  for (std::size_t f = 0; f < part.face_count(); ++f)
    if (part.corners_of(f).size() != 3) return false;
  return true;
}

Status measure_blocks(const SegmentsOfRun& segments, const JudgedPart& part, AuditRule rule, const FindPlace& at,
                      AuditSubject& subject) {
  const Motion& motion = segments.stream.motion();
  const std::vector<Block> blocks = make_blocks(part);
  // For each block, the length of the largest control normal of each element. An element whose outputs lie in two
  // blocks is in the lists of both blocks.
  std::vector<std::vector<double>> largest;
  largest.reserve(blocks.size());
  for (const Block& block : blocks) largest.emplace_back(block.elements.count, 0.0);
  // The segments that are in memory at the same time are examined together, because neighbours share a keyframe and its
  // normals.
  const std::size_t at_once = segments.stream.keeps_all() ? std::max<std::size_t>(segments.of_motion.size(), 1) : 1;
  const Status looked =
      SegmentRun::look_over(segments.stream, segments.keys(), segments.looked_at(), at_once, [&](IndexRange some) {
        const auto held = segments.of_motion.subspan(some.first, some.count);
        parallel_for(blocks.size(), [&](std::size_t b) { keep_largest_normals(motion, held, blocks[b], largest[b]); });
        return Status(Success{});
      });
  if (!looked) return looked;
  maximize(segments.run, largest);

  const std::size_t per_wave = std::min(blocks.size(), kBlocksPerWaveAndThread * thread_count());
  std::vector<std::vector<MotionError>> wave(per_wave, std::vector<MotionError>(subject.samples));
  std::vector<Scratch> scratch(per_wave);
  const Status measured = segments.over(subject, [&](std::size_t s) {
    const Segment segment = motion.segment(segments.of_motion[s]);
    std::vector<MotionError> of_samples(subject.samples);
    for (std::size_t first = 0; first < blocks.size(); first += per_wave) {
      const std::size_t count = std::min(per_wave, blocks.size() - first);
      parallel_for(count, [&](std::size_t b) {
        measure_block(segment, s, blocks[first + b], largest[first + b], part, rule, at, scratch[b], wave[b]);
      });
      // Errors are added in order, so that sums do not depend on the number of threads.
      for (std::size_t b = 0; b < count; ++b)
        for (std::size_t i = 0; i < of_samples.size(); ++i) of_samples[i].add(wave[b][i]);
    }
    SegmentErrors found{s, {}, {}};
    for (std::size_t i = 0; i < of_samples.size(); ++i) {
      found.error.add(of_samples[i]);
      if (i == 0 || i + 1 == of_samples.size()) found.at_keys.add(of_samples[i]);
    }
    return found;
  });
  if (!measured) return measured;
  subject.vertices = part.outputs().size();
  return Success{};
}

}  // namespace chronormal::inline internal
