#include "workflow/bake/sequence/harmless_sequence.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/blocks.h"
#include "core/float32.h"
#include "workflow/bake/deltas/unit_targets.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kHarmlessBlock = 256;
constexpr double kWorthIt = 2e-3;  // radians: a smaller gain is not worth the bytes of a target
// The number of instants at which a segment is judged. The start of the segment is not one of them.
constexpr std::size_t kJudged = 40;

// Returns the weight of a bend at t, as the LINEAR track plays it: the curve 4 t (1 - t) in straight pieces.
double bend_weight(double t) {
  const double at = t * kBendPieces, piece = std::min(std::floor(at), kBendPieces - 1.0);
  const auto exact = [](double n) { return 4 * (n / kBendPieces) * (1 - n / kBendPieces); };
  return exact(piece) + (at - piece) * (exact(piece + 1) - exact(piece));
}

// Returns the largest angle between rendered and true normals in a segment, in radians.
double worst_angle(const ControlNormals& n, const Vec3d& from, const Vec3d& to, const Vec3d& bend) {
  double worst = 0;
  for (std::size_t j = 1; j <= kJudged; ++j) {
    const double t = static_cast<double>(j) / kJudged;
    const Vec3d right = unit_normal_at(n, t).vector;
    if (right == Vec3d{}) continue;
    worst = std::max(worst, angle_between((1 - t) * from + t * to + bend_weight(t) * bend, right));
  }
  return worst;
}

}  // namespace

Result<HarmlessElements> harmless_elements(const SequenceNormals& normals) {
  HarmlessElements result{std::vector<SequenceElement>(normals.elements()), 0};
  std::vector<char> has_room(normals.elements(), 1);
  const Status status = each_segment(normals, [&](std::size_t, const SegmentForm& form) -> Status {
    parallel_each(has_room.size(), kHarmlessBlock, [&](std::size_t e) {
      SequenceElement& element = result.elements[e];
      const ControlNormals n = form.control_normals(e);
      if (element.has_none) {
        element.normal = rounded_to_float(unit_normal_at(n, 0).vector);
        element.has_none = element.normal == Vec3d{};
      }
      if (!element.has_none && !fits(element.normal, unit_normal_at(n, 1).vector)) has_room[e] = 0;
    });
    return Success{};
  });
  if (!status) return status.error();
  for (SequenceElement& element : result.elements)
    if (element.has_none) element.normal = kAnyNormal;
  result.without_room = static_cast<std::size_t>(std::count(has_room.begin(), has_room.end(), 0));
  return result;
}

SegmentEnds segment_ends(std::span<const SequenceElement> elements, const SegmentForm& form,
                         const std::vector<Vec3d>& before) {
  SegmentEnds ends{before, std::vector<Vec3d>(elements.size())};
  ends.from.resize(elements.size());
  parallel_each(elements.size(), kHarmlessBlock, [&](std::size_t e) {
    const ControlNormals n = form.control_normals(e);
    const auto direction = [&](double t, const Vec3d& otherwise) {
      const Vec3d found = unit_normal_at(n, t).vector;
      return found == Vec3d{} ? otherwise : found;
    };
    if (before.empty()) ends.from[e] = direction(0, elements[e].normal);
    ends.to[e] = direction(1, ends.from[e]);
  });
  return ends;
}

std::vector<Vec3d> unit_key_deltas(std::span<const SequenceElement> elements, std::span<const Vec3d> directions) {
  std::vector<Vec3d> deltas(elements.size());
  for (std::size_t e = 0; e < elements.size(); ++e)
    if (!elements[e].has_none) deltas[e] = rounded_to_float(directions[e] - elements[e].normal);
  return deltas;
}

UnitBends unit_bends(std::span<const SequenceElement> elements, const SegmentForm& form, const SegmentEnds& ends) {
  UnitBends result;
  result.deltas.resize(elements.size());
  struct Angles {
    double gain = 0, error = 0, straight = 0;
  };
  const auto bend = [&](std::size_t e, Angles& angles) {
    if (elements[e].has_none) return;
    const ControlNormals n = form.control_normals(e);
    const double straight = worst_angle(n, ends.from[e], ends.to[e], {});
    double error = straight;
    const Vec3d half = unit_normal_at(n, 0.5).vector, shown = 0.5 * (ends.from[e] + ends.to[e]);
    if (straight > kWorthIt && half != Vec3d{}) {
      if (const std::optional<Vec3d> u = turning_unit(elements[e].normal, shown, half, 1)) {
        const Vec3d delta = rounded_to_float(*u - elements[e].normal);
        const double bent = worst_angle(n, ends.from[e], ends.to[e], delta);
        if (bent < straight - kWorthIt) {
          result.deltas[e] = delta;
          error = bent;
        }
      }
    }
    angles = {angles.gain + straight - error, std::max(angles.error, error), std::max(angles.straight, straight)};
  };
  const Angles all = parallel_fold<Angles>(elements.size(), kHarmlessBlock, bend, [](Angles& sum, const Angles& each) {
    sum = {sum.gain + each.gain, std::max(sum.error, each.error), std::max(sum.straight, each.straight)};
  });
  result.gain = all.gain;
  result.error = all.error;
  result.straight = all.straight;
  if (result.gain == 0) result.deltas.clear();
  return result;
}

}  // namespace chronormal::inline internal
