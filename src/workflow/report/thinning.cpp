#include "workflow/report/thinning.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/text.h"
#include "workflow/report/coarse_part.h"
#include "workflow/report/keep_only.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kNumber = 4;  // the number of bytes of a float or an index

std::size_t bytes_of(const ModelVectors& vectors) {
  return kNumber * vectors.vertices.size() + kNumber * vectors.values.size();
}

std::size_t bytes_of_keyframes(const ModelPart& part) {
  std::size_t bytes = 0;
  for (const ModelVectors& keyframe : part.keyframe_positions) bytes += bytes_of(keyframe);
  for (const ModelVectors& keyframe : part.keyframe_normals) bytes += bytes_of(keyframe);
  return bytes;
}

// Returns the bytes of the weights in all samples. The other data of a sample are small.
std::size_t bytes_of_samples(const ModelPart& part) {
  std::size_t bytes = 0;
  for (const ModelMotion& motion : part.motions)
    for (const ModelWeights& weights : motion.weights) bytes += kNumber * weights.values.size();
  return bytes;
}

std::size_t bytes_of_vertices(const ModelPart& part) {
  std::size_t numbers = part.labels.size() + part.triangles.size() + part.faces.size() + part.coarse.size() +
                        part.element.size() + part.positions.size() + part.normals.size();
  std::size_t bytes = 0;
  for (const ModelVectors& target : part.targets) bytes += bytes_of(target);
  for (const ModelShown& shown : part.shown) {
    numbers += shown.normals.size();
    for (const ModelVectors& target : shown.targets) bytes += bytes_of(target);
  }
  for (const ModelMotion& motion : part.motions) bytes += sizeof(double) * motion.least.size();
  constexpr std::size_t kOfOffset = 24;
  numbers += part.truth.first.size() + part.truth.corners.size() + part.truth.terms.size();
  for (const ModelOffset& offset : part.truth.offsets) bytes += kOfOffset + kNumber * offset.edges.size();
  for (const ModelTruth::Changes& changes : part.truth.changes)
    numbers += changes.offsets.size() + changes.values.size();
  return bytes + kNumber * numbers;
}

std::size_t bytes_of_rest(const ModelPart& part) {
  std::size_t bytes = 0;
  constexpr std::size_t kOfSample = 28, kOfScheme = 8;
  for (const ModelMotion& motion : part.motions)
    bytes += motion.at.size() * (kOfSample + kOfScheme * motion.schemes.size());
  return bytes;
}

template <class OfPart>
std::size_t sum(const ReportModel& model, const OfPart& of_part) {
  std::size_t result = 0;
  for (const ModelPart& part : model.parts) result += of_part(part);
  return result;
}

// Returns the number of bytes that are left of `most` after `taken` bytes are used, or 0 if `taken` is larger.
std::size_t left(std::size_t most, std::size_t taken) { return most > taken ? most - taken : 0; }

std::vector<std::size_t> worst_samples(const ReportModel& model, std::size_t part, std::size_t motion) {
  std::vector<std::size_t> samples;
  for (const ReportPlace& place : model.worst)
    if (place.part == part && place.motion == motion) samples.push_back(place.sample);
  return samples;
}

// Leaves out keyframes of the motion until the others take about most_bytes. Returns the number of keyframes that are
// left.
std::size_t thin_keyframes(ReportModel& model, std::size_t most_bytes) {
  ModelPart& part = model.parts[0];
  const std::size_t keyframes = part.times.size(), segments = part.segments.size() / 2;
  const std::size_t most = keyframes * most_bytes / std::max<std::size_t>(1, bytes_of_keyframes(part));
  std::vector<bool> is_segment_kept(segments), is_kept(keyframes);
  const auto keep = [&](std::size_t s) {
    if (s >= segments) return;
    is_segment_kept[s] = true;
    is_kept[part.segments[2 * s]] = is_kept[part.segments[2 * s + 1]] = true;
  };
  is_kept[0] = true;  // all other keyframes store only vertices that differ from keyframe 0
  for (const ReportPlace& place : model.worst) {
    const std::size_t s = part.motions[place.motion].segments[place.sample];
    keep(s);
    if (model.kind != "sequence") continue;
    keep(s + 1);
    if (s > 0) keep(s - 1);
  }
  const std::size_t have = static_cast<std::size_t>(std::count(is_kept.begin(), is_kept.end(), true));
  // Counts the segments that fit into the limit of keyframes. In a sequence, a segment without kept neighbours needs
  // two keyframes. In targets, all segments share the base, so each segment needs only one more keyframe.
  const std::size_t room = left(most, have) / (model.kind == "sequence" ? 2 : 1);
  for (std::size_t n = 0; n < room; ++n) keep(n * segments / room);

  std::vector<std::uint32_t> number(keyframes, kNoReportElement), number_of_segment(segments, kNoReportElement);
  std::uint32_t count = 0, segment_count = 0;
  for (std::size_t k = 0; k < keyframes; ++k)
    if (is_kept[k]) number[k] = count++;
  for (std::size_t s = 0; s < segments; ++s)
    if (is_segment_kept[s]) number_of_segment[s] = segment_count++;
  keep_only(is_kept, 1, part.times);
  keep_only(is_kept, 1, part.keyframe_numbers);
  keep_only(is_kept, 1, part.keyframe_positions);
  keep_only(is_kept, 1, part.keyframe_normals);
  keep_only(is_segment_kept, 2, part.segments);
  for (std::uint32_t& key : part.segments) key = number[key];
  for (ModelMotion& motion : part.motions)
    for (std::uint32_t& segment : motion.segments) segment = number_of_segment[segment];
  return count;
}

// Keeps every `step`-th sample, the first and last sample, and the samples of worst places. Leaves out all other
// samples.
void thin_samples(ReportModel& model, std::size_t step) {
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    for (std::size_t m = 0; m < model.parts[p].motions.size(); ++m) {
      ModelMotion& motion = model.parts[p].motions[m];
      const std::size_t samples = motion.at.size();
      if (samples < 2) continue;
      std::vector<bool> is_kept(samples);
      for (std::size_t i = 0; i < samples; ++i) is_kept[i] = i % step == 0 || i + 1 == samples;
      for (const std::size_t i : worst_samples(model, p, m)) is_kept[i] = true;
      for (ReportPlace& place : model.worst) {
        if (place.part != p || place.motion != m) continue;
        const auto end = is_kept.begin() + static_cast<std::ptrdiff_t>(place.sample);
        place.sample = static_cast<std::size_t>(std::count(is_kept.begin(), end, true));
      }
      keep_only(is_kept, 1, motion.at);
      keep_only(is_kept, 1, motion.worst);
      keep_only(is_kept, 1, motion.mean);
      for (ModelWeights& weights : motion.weights) keep_only(is_kept, weights.values.size() / samples, weights.values);
    }
  }
}

}  // namespace

std::size_t bytes_of(const ReportModel& model) {
  return sum(model, [](const ModelPart& part) {
    return bytes_of_keyframes(part) + bytes_of_samples(part) + bytes_of_vertices(part) + bytes_of_rest(part);
  });
}

void thin_out(ReportModel& model, std::size_t most_bytes) {
  const auto note = [&](const std::string& sentence) { model.thinned.push_back(sentence); };
  if (const std::size_t all = bytes_of(model); model.kind != "gltf" && all > most_bytes) {
    const std::size_t of_keyframes = sum(model, bytes_of_keyframes), before = model.parts[0].times.size();
    // Lets keyframes take at least half of the page. If the page is still too large after this step, the mesh has too
    // many vertices.
    const std::size_t after = thin_keyframes(model, std::max(left(most_bytes, all - of_keyframes), most_bytes / 2));
    const bool is_sequence = model.kind == "sequence";
    if (after < before)
      note((is_sequence ? grouped(after) + " of " + counted(before, "keyframe", "keyframes")
                        : grouped(after - 1) + " of " + counted(before - 1, "target", "targets")) +
           " can be shown here, among them the worst one; the plot has the errors of all of them.");
  }
  if (const std::size_t all = bytes_of(model), of_samples = sum(model, bytes_of_samples);
      all > most_bytes && of_samples > 0) {
    const std::size_t most = std::max({left(most_bytes, all - of_samples), most_bytes / 4, std::size_t{1}});
    const std::size_t step = (of_samples + most - 1) / most;
    if (step > 1) {
      thin_samples(model, step);
      note("Only one of every " + counted(step, "sample", "samples") +
           " of a motion can be shown here, beside those of the worst places.");
    }
  }
  if (const std::size_t all = bytes_of(model); all > most_bytes) {
    const std::size_t fixed = sum(model, bytes_of_samples) + sum(model, bytes_of_rest);
    const double share = static_cast<double>(left(most_bytes, fixed)) / static_cast<double>(all - fixed);
    for (std::size_t p = 0; p < model.parts.size(); ++p) {
      ModelPart& part = model.parts[p];
      const std::size_t before = part.triangles.size() / 3, vertices = part.vertex_count();
      make_coarse(model, p, static_cast<std::size_t>(share * static_cast<double>(vertices)));
      note((part.name.empty() ? std::string("The mesh") : printable(part.name)) + " is shown with " +
           grouped((part.triangles.size() + part.coarse.size()) / 3) + " of " +
           counted(before, "triangle", "triangles") + "; " +
           counted(part.triangles.size() / 3,
                   "of them, around the worst places, is as in the file and shows its errors.",
                   "of them, around the worst places, are as in the file and show their errors."));
    }
  }
}

}  // namespace chronormal::inline internal
