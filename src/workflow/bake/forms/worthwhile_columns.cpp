// Normals are held against limits without any angle: of shown normals s and right ones r, |s x r| <= tan(limit) s . r.
#include "workflow/bake/forms/worthwhile_columns.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/blocks.h"
#include "core/portable_math.h"
#include "workflow/bake/forms/unit_targets.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 16;
// Selections that are looked at one by one, and sums that this may take; those of a walk from the fullest one.
constexpr std::size_t kMostSelections = 8192;
constexpr double kMostSums = 1e9;
// A limit lets a normal be farther off than it is with all columns, or with the stored deltas, by so many degrees.
constexpr double kSlack = 0.01;
constexpr double kLeastLength = 1e-3;
// Selections that a limit lets through and that may turn out to be worse than it in the tracks of a file.
constexpr std::size_t kMostTaken = 24;
// By which part of a limit of bytes less is tried where tracks turn out to take more than that leaves.
constexpr std::size_t kPartOfRoom = 8;

// Tangents, squared; below zero of obtuse angles, and infinite where there is no limit.
float limit_of(double degrees) {
  const double angle = degrees / kDegreesPerRadian;
  if (degrees >= 180) return INFINITY;
  const double tangent = portable::sin(angle) / portable::cos(angle);
  return static_cast<float>(std::copysign(tangent * tangent, tangent));
}

bool is_within(const Vec3f& shown, const Vec3f& right, float limit) {
  if (limit == INFINITY) return true;
  const Vec3f aside = cross(shown, right);
  const float along = dot(shown, right), across = dot(aside, aside), allowed = limit * along * along;
  if (limit >= 0) return along > 0 && across <= allowed;
  return along >= 0 ? shown != Vec3f{} : across >= -allowed;
}

class Search {
 public:
  Search(const RightNormals& rights, std::span<const std::uint32_t> vertices,
         std::span<const std::uint32_t> element_of_vertex, const Worthwhile& offered, std::span<const AskedPose> poses,
         std::span<const Host> hosts, double tolerance)
      : offered_(offered), poses_(poses.size()), base_(vertices.size()) {
    for (const AskedPose& pose : poses)
      for (std::size_t c = 0; c < offered.columns.size(); ++c) {
        const ExtraWeight& weight = offered.columns[c].weight;
        weights_.push_back(static_cast<float>(weight.at(pose.weights[weight.i], pose.weights[weight.j])));
      }
    for (std::size_t n = 0; n < vertices.size(); ++n) base_[n] = to_float(rights.stored(vertices[n]));
    add_kinds(rights, vertices, hosts);
    set_limits(rights, vertices, element_of_vertex, poses, tolerance);
  }

  [[nodiscard]] std::vector<bool> columns_of(const Selection& selection) const {
    std::vector<bool> result(offered_.columns.size(), false);
    for (std::size_t s = 0; s < selection.size(); ++s)
      for (const std::size_t c : offered_.slots[s][selection[s]].columns) result[c] = true;
    return result;
  }

  // Whether these columns are near enough at some vertices, or all of them.
  [[nodiscard]] bool is_near(const std::vector<bool>& has, std::span<const std::uint32_t> numbers = {}) const {
    const std::size_t count = numbers.empty() ? base_.size() : numbers.size();
    std::atomic<bool> is_near = true;
    parallel_blocks(count, kBlock, [&](IndexRange range) {
      for (std::size_t n = range.first; n < range.first + range.count && is_near; ++n)
        if (!is_near_at(has, numbers.empty() ? n : numbers[n])) is_near = false;
    });
    return is_near;
  }

  // How many products of a weight and a delta all columns have.
  [[nodiscard]] double sums() const {
    double result = static_cast<double>(base_.size());
    for (const Kind& kind : kinds_) result += static_cast<double>(kind.deltas.entries.size());
    return result * static_cast<double>(poses_);
  }
  [[nodiscard]] double sums_of(std::span<const std::uint32_t> numbers) const {
    double result = 0;
    for (const Kind& kind : kinds_)
      for (const std::uint32_t n : numbers) result += static_cast<double>(kind.deltas.of(n).size());
    return result * static_cast<double>(poses_);
  }

  // The squares of all turns that a column makes, about.
  [[nodiscard]] double energy_of(std::size_t column) const {
    double weights = 0, deltas = 0;
    for (std::size_t p = 0; p < poses_; ++p) {
      const auto w = static_cast<double>(weight(p, column));
      weights += w * w;
    }
    for (const Vec3f& delta : offered_.columns[column].deltas.vectors) deltas += static_cast<double>(dot(delta, delta));
    return weights * deltas;
  }

  // The largest turn that a column makes, to order them by.
  [[nodiscard]] double size_of(std::size_t column) const {
    double most_weight = 0, most = 0;
    for (std::size_t p = 0; p < poses_; ++p)
      most_weight = std::fmax(most_weight, std::fabs(static_cast<double>(weight(p, column))));
    for (const Vec3f& delta : offered_.columns[column].deltas.vectors)
      most = std::fmax(most, static_cast<double>(dot(delta, delta)));
    return most_weight * std::sqrt(most);
  }

 private:
  // One kind of host: the part of all columns that it keeps, and how far off each vertex may be at each pose.
  struct Kind {
    VertexColumns deltas;
    std::vector<float> limits;
  };

  [[nodiscard]] float weight(std::size_t pose, std::size_t column) const {
    return weights_[pose * offered_.columns.size() + column];
  }

  void add_kinds(const RightNormals& rights, std::span<const std::uint32_t> vertices, std::span<const Host> hosts) {
    std::vector<const VertexVectors*> all;
    for (const Column& column : offered_.columns) all.push_back(&column.deltas);
    const VertexColumns deltas = by_vertex(all, vertices);
    for (const Host& host : hosts) {
      VertexColumns kept = kept_columns(judged_as(host), rights, vertices, deltas);
      for (std::size_t k = 0; k < kept.entries.size(); ++k)
        if (!offered_.columns[kept.entries[k].column].is_stored) kept.entries[k] = deltas.entries[k];
      if (std::none_of(kinds_.begin(), kinds_.end(),
                       [&](const Kind& kind) { return kind.deltas.entries == kept.entries; }))
        kinds_.push_back({std::move(kept), {}});
    }
  }

  [[nodiscard]] Vec3f shown(const Kind& kind, std::size_t n, std::size_t pose, const std::vector<bool>& has) const {
    Vec3f sum = base_[n];
    for (const auto& [column, delta] : kind.deltas.of(n))
      if (has[column]) sum = sum + weight(pose, column) * delta;
    return sum;
  }

  void set_limits(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                  std::span<const std::uint32_t> element_of_vertex, std::span<const AskedPose> poses,
                  double tolerance) {
    Selection fullest, stored(offered_.slots.size(), 0);
    for (const Slot& slot : offered_.slots) fullest.push_back(slot.size() - 1);
    const std::vector<bool> of_all = columns_of(fullest), of_stored = columns_of(stored);
    right_.resize(base_.size() * poses_);
    for (Kind& kind : kinds_) kind.limits.resize(right_.size());
    for (std::size_t p = 0; p < poses_; ++p) {
      const std::vector<Vec3d> normals = rights.of_elements(std::span(poses[p].weights).first(rights.targets()));
      parallel_each(base_.size(), kBlock, [&](std::size_t n) {
        const Vec3d right = rights.of_vertex(vertices[n], normals[element_of_vertex[vertices[n]]]);
        right_[n * poses_ + p] = to_float(unit(right));
        for (Kind& kind : kinds_) {
          const auto error = [&](const std::vector<bool>& has) {
            const Vec3d sum = to_double(shown(kind, n, p, has));
            return max_abs(sum) > 0 ? kDegreesPerRadian * angle_between(sum, right) : 180;
          };
          double limit = 180;
          if (right != Vec3d{}) {
            limit = std::fmax(tolerance, error(of_all) + kSlack);
            if (!poses[p].must_be_near || !(length(right) > kLeastLength))
              limit = std::fmax(limit, error(of_stored) + kSlack);
          }
          kind.limits[n * poses_ + p] = limit_of(limit);
        }
      });
    }
  }

  [[nodiscard]] bool is_near_at(const std::vector<bool>& has, std::size_t n) const {
    for (const Kind& kind : kinds_)
      for (std::size_t p = 0; p < poses_; ++p)
        if (!is_within(shown(kind, n, p, has), right_[n * poses_ + p], kind.limits[n * poses_ + p])) return false;
    return true;
  }

  const Worthwhile& offered_;
  std::size_t poses_;
  std::vector<Vec3f> base_, right_;  // right_ and limits are (vertices, poses)
  std::vector<float> weights_;       // (poses, columns)
  std::vector<Kind> kinds_;
};

std::size_t bytes_of(const Worthwhile& offered, const Selection& selection) {
  std::size_t bytes = 0;
  for (std::size_t s = 0; s < selection.size(); ++s) bytes += offered.slots[s][selection[s]].bytes;
  return bytes;
}

// All selections, the cheapest first.
std::vector<Selection> all_selections(const Worthwhile& offered) {
  std::vector<Selection> all = {Selection(offered.slots.size(), 0)};
  for (std::size_t s = 0; s < offered.slots.size(); ++s) {
    const std::size_t before = all.size();
    for (std::size_t option = 1; option < offered.slots[s].size(); ++option)
      for (std::size_t n = 0; n < before; ++n) {
        all.push_back(all[n]);
        all.back()[s] = option;
      }
  }
  std::stable_sort(all.begin(), all.end(),
                   [&](const Selection& a, const Selection& b) { return bytes_of(offered, a) < bytes_of(offered, b); });
  return all;
}

// Spares what can be spared of the fullest selection.
Selection spare(const Search& search, const Worthwhile& offered, std::span<const std::uint32_t> vertices) {
  Selection selection;
  std::vector<std::size_t> order;
  std::vector<double> sizes;
  for (const Slot& slot : offered.slots) {
    double size = 0;
    for (const std::size_t column : slot.back().columns) size = std::fmax(size, search.size_of(column));
    order.push_back(order.size());
    sizes.push_back(size);
    selection.push_back(slot.size() - 1);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return sizes[a] < sizes[b]; });
  double sums = 0;
  for (const std::size_t s : order) {
    std::vector<std::uint32_t> numbers;
    for (const Option& option : offered.slots[s])
      for (const std::size_t column : option.columns) {
        const std::vector<std::uint32_t>& of_column = offered.columns[column].deltas.vertices;
        numbers.insert(numbers.end(), of_column.begin(), of_column.end());
      }
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    for (std::uint32_t& n : numbers)
      n = static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), n) - vertices.begin());
    const std::size_t fullest = selection[s];
    for (std::size_t option = 0; option < fullest && sums < kMostSums; ++option) {
      selection[s] = option;
      sums += search.sums_of(numbers);
      if (numbers.empty() || search.is_near(search.columns_of(selection), numbers)) break;
      selection[s] = fullest;
    }
  }
  return selection;
}

// Takes the options with the least in them for their bytes out of a selection until it takes no more than the room.
void leave_out(const Search& search, const Worthwhile& offered, std::size_t room, Selection& selection) {
  const auto energy_of = [&](const Option& option) {
    double energy = 0;
    for (const std::size_t column : option.columns) energy += search.energy_of(column);
    return energy;
  };
  for (std::size_t bytes = bytes_of(offered, selection); bytes > room; bytes = bytes_of(offered, selection)) {
    double least = INFINITY;
    std::size_t slot = 0, to = 0;
    for (std::size_t s = 0; s < selection.size(); ++s) {
      const Option& now = offered.slots[s][selection[s]];
      for (std::size_t option = 0; option < selection[s]; ++option) {
        const Option& other = offered.slots[s][option];
        if (other.bytes >= now.bytes) continue;
        const double lost = std::fmax(energy_of(now) - energy_of(other), 0);
        const double of_byte = lost / static_cast<double>(now.bytes - other.bytes);
        if (of_byte < least) least = of_byte, slot = s, to = option;
      }
    }
    if (least == INFINITY) return;
    selection[slot] = to;
  }
}

}  // namespace

VertexColumns kept_columns(const Host& host, const RightNormals& rights, std::span<const std::uint32_t> vertices,
                           const VertexColumns& form) {
  constexpr double kSame = 1e-4;
  VertexColumns result = form;
  bool is_same = true;
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    const BaseNormal base(rights.stored(vertices[n]));
    const Vec3f normal = to_float(base.stored), of_normal = kept_normal(host, normal);
    for (std::size_t k = form.first[n]; k < form.first[n + 1]; ++k) {
      const Vec3f& delta = form.entries[k].delta;
      Vec3d kept = to_double(kept_delta(host, normal, of_normal, delta));
      if (host.normals == NormalRule::kUnit) kept = base.length * kept;
      is_same = is_same && length(kept - to_double(delta)) <= kSame * base.length;
      result.entries[k].delta = to_float(kept);
    }
  }
  return is_same ? form : result;
}

void find_worthwhile(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                     std::span<const std::uint32_t> element_of_vertex, const Worthwhile& offered,
                     std::span<const AskedPose> poses, std::span<const Host> hosts, double tolerance,
                     std::size_t most_bytes, const std::function<std::optional<std::size_t>(const Selection&)>& take) {
  const Search search(rights, vertices, element_of_vertex, offered, poses, hosts, tolerance);
  double count = 1;
  for (const Slot& slot : offered.slots) count *= static_cast<double>(slot.size());
  bool is_affordable = false;
  const auto look_at = [&](const Selection& selection) {
    const std::optional<std::size_t> bytes = take(selection);
    is_affordable = is_affordable || (bytes && *bytes <= most_bytes);
    return bytes.has_value();
  };
  Selection last;
  if (count <= kMostSelections && count * search.sums() <= kMostSums) {
    std::size_t taken = 0;
    for (const Selection& selection : all_selections(offered)) {
      last = selection;
      if (!search.is_near(search.columns_of(selection))) continue;
      if (!look_at(selection)) return;
      if (++taken == kMostTaken) break;
    }
  } else {
    last = spare(search, offered, vertices);
    if (!look_at(last)) return;
  }
  for (std::size_t room = most_bytes; !is_affordable && room > 0;
       room -= std::max<std::size_t>(1, room / kPartOfRoom)) {
    Selection selection = last;
    leave_out(search, offered, room, selection);
    const std::size_t bytes = bytes_of(offered, selection);
    if (bytes > room || !look_at(selection) || bytes == 0) return;
    room = std::min(room, bytes);
  }
}

}  // namespace chronormal::inline internal
