// Packs elements into blocks of 16 for the kernel; flagged elements are evaluated in double, and overwrite the results
// of the kernel.
//
// The error in float32 is as follows, with u = 2^-24. A control normal, its weight and their product are rounded once
// each, and a product goes through three additions. So n(t) is off by at most 6 u sum w_k |c_k|, and turns by at most 6
// u r where |n(t)| >= sum w_k |c_k| / r; the last product, with 1 / |n|, turns it by u. With r = 2.6 that is 9.9e-7.

#include "chronormal/normals/path_curves.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>

#include "core/blocks.h"
#include "core/memory.h"
#include "core/rounding.h"
#include "core/twofold.h"
#include "core/vector_area.h"
#include "normals/control/local_time.h"
#include "normals/control/shared_faces.h"
#include "normals/curves/certificate.h"
#include "normals/curves/kernels/evaluate_path.h"
#include "normals/curves/outputs.h"
#include "normals/curves/path_sums.h"

namespace chronormal {
namespace {

constexpr std::size_t kPathPiece = 8192;  // elements that a thread takes at a time, a multiple of a block
constexpr double kLongestRatio = 2.6;     // r
constexpr double kSmallest = 0x1p-40;     // of the largest control normal: |n|^2 stays in the range of float32

using Controls = PolynomialNormals<3>;
static_assert(std::tuple_size_v<Controls> == kPathControls);

// The factors of products of two coefficients of degree 6 in the coefficient of degree 12 that they belong to.
struct ProductShares {
  double of[kPathControls][kPathControls];
  constexpr ProductShares() : of() {
    for (std::size_t i = 0; i < kPathControls; ++i)
      for (std::size_t j = 0; j < kPathControls; ++j) of[i][j] = binomial(6, i) * binomial(6, j) / binomial(12, i + j);
  }
};
constexpr ProductShares kShares;

// Whether float32 can carry an element. The proof is a quick test, or else the signs of the coefficients of r^2 |n|^2 -
// (sum w_k |c_k|)^2.
bool stays_long(const Controls& n, double largest) {
  std::array<double, kPathControls> lengths;
  Vec3d sum;
  for (std::size_t k = 0; k < n.size(); ++k) {
    lengths[k] = length(n[k]);
    if (!(lengths[k] > kSmallest * largest)) return false;
    sum = sum + (1 / lengths[k]) * n[k];
  }
  const Vec3d middle = unit(sum);
  const auto is_near = [&](std::size_t k) { return kLongestRatio * dot(middle, n[k]) >= lengths[k]; };
  std::size_t near = 0;
  while (near < n.size() && is_near(near)) ++near;
  if (near == n.size()) return true;
  Bernstein<double, 12> slack{};
  for (std::size_t i = 0; i < n.size(); ++i)
    for (std::size_t j = 0; j < n.size(); ++j)
      slack[i + j] += kShares.of[i][j] * (kLongestRatio * kLongestRatio * dot(n[i], n[j]) - lengths[i] * lengths[j]);
  return certainly_not_negative(slack);
}

PathWeights weights_at(double t) {
  PathWeights weights;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    double weight = binomial(6, k);
    for (std::size_t i = 0; i < 6; ++i) weight *= i < k ? t : 1 - t;
    weights[k] = static_cast<float>(weight);
  }
  return weights;
}

}  // namespace

struct PathCurves::Data {
  std::size_t size = 0;
  AlignedArray<float> blocks;
  std::vector<std::size_t> flagged;  // ascending
  std::vector<Controls> flagged_normals;

  template <class MakeSource>
  Data(std::size_t count, Threads threads, const MakeSource& make_source);

  // Writes an element into its block, or zeros where float32 cannot carry it. Returns whether it can.
  bool pack(std::size_t element, const Controls& normals) {
    double largest = 0;
    for (const Vec3d& n : normals) largest = std::max(largest, max_abs(n));
    const bool fits = largest > 0 && std::isfinite(largest);
    const double scale = fits ? std::ldexp(1.0, -std::ilogb(largest)) : 0;
    Controls scaled;
    for (std::size_t k = 0; k < kPathControls; ++k) scaled[k] = scale * normals[k];
    const bool carries = fits && std::isfinite(scale) && stays_long(scaled, 1);
    float* const lane = blocks.data() + element / kTile * kPathBlock + element % kTile;
    for (std::size_t k = 0; k < kPathControls; ++k) {
      const Vec3f n = carries ? to_float(scaled[k]) : Vec3f{1, 0, 0};
      for (const auto& [c, value] : {std::pair{0, n.x}, std::pair{1, n.y}, std::pair{2, n.z}})
        lane[(3 * k + static_cast<std::size_t>(c)) * kTile] = value;
    }
    return carries;
  }

  // Writes the unit normals of a range at t. Returns how many have no direction.
  std::size_t evaluate(IndexRange range, double t, VectorView<float> result, MemoryAccess pass) const noexcept;
};

namespace {

// Where the control normals of curves come from, some elements at a time: an array, the faces of a segment, or its groups.
class GivenSource {
 public:
  explicit GivenSource(std::span<const Controls> normals) : normals_(normals) {}
  void write(IndexRange elements, std::span<Controls> result) const {
    std::copy_n(normals_.begin() + static_cast<std::ptrdiff_t>(elements.first), elements.count, result.begin());
  }

 private:
  std::span<const Controls> normals_;
};

class FaceSource {
 public:
  explicit FaceSource(const PolynomialSegment<3>& segment) : segment_(segment) {}
  void write(IndexRange faces, std::span<Controls> result) const { polynomial_face_normals(segment_, faces, result); }

 private:
  const PolynomialSegment<3>& segment_;
};

// The control normals of a sum of faces in twice the digits of double. Products are added up with whole factors.
struct FineSums {
  Twofold sums[kPathControls][3];
  double sizes[kPathControls] = {};
  std::size_t triangles = 0;

  void add(const FineSums& other) noexcept {
    for (std::size_t k = 0; k < kPathControls; ++k) {
      for (std::size_t c = 0; c < 3; ++c) sums[k][c] = sums[k][c] + other.sums[k][c];
      sizes[k] += other.sizes[k];
    }
    triangles += other.triangles;
  }

  void add(const PolynomialSegment<3>& segment, std::uint32_t f) noexcept {
    struct Edge {
      Twofold at[4][3];
      double size[4];
    };
    const auto face = segment.topology->face(f);
    triangles += face.size() - 2;
    const auto edge_to = [&](std::size_t c) {
      Edge edge;
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec3d a = segment.control[k][face[0]], b = segment.control[k][face[c]];
        edge.at[k][0] = Twofold::sum(b.x, -a.x);
        edge.at[k][1] = Twofold::sum(b.y, -a.y);
        edge.at[k][2] = Twofold::sum(b.z, -a.z);
        edge.size[k] = max_abs(b - a);
      }
      return edge;
    };
    for_fan(face.size(), edge_to, [&](const Edge& e, const Edge& g) {
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
          const Twofold factor{binomial(3, i) * binomial(3, j), 0};
          for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t x = (c + 1) % 3, y = (c + 2) % 3;
            const Twofold product = e.at[i][x] * g.at[j][y] + -(e.at[i][y] * g.at[j][x]);
            sums[i + j][c] = sums[i + j][c] + factor * product;
          }
          sizes[i + j] += factor.high * e.size[i] * g.size[j];
        }
      }
    });
  }
};

// The control normals of the sum of some faces, where those of double cancel; zero for what is nothing but rounding.
Controls fine_normals(const PolynomialSegment<3>& segment, std::span<const std::uint32_t> faces,
                      const LargeFaceValues<FineSums>& large) noexcept {
  constexpr double kRounding = 0x1p-102;  // of a product and its additions, at most four for each triangle
  FineSums all;
  for (const std::uint32_t f : faces) {
    if (!large.are_kept_of(*segment.topology, f)) {
      all.add(segment, f);
      continue;
    }
    all.add(large.of(*segment.topology, f, [&] {
      FineSums of_face;
      of_face.add(segment, f);
      return of_face;
    }));
  }
  const auto& [sums, sizes, triangles] = all;
  Controls result;
  for (std::size_t k = 0; k < kPathControls; ++k) {
    const Vec3d sum{sums[k][0].value(), sums[k][1].value(), sums[k][2].value()};
    result[k] = 1 / binomial(6, k) * without_rounding(sum, kRounding * static_cast<double>(triangles + 1) * sizes[k]);
  }
  return result;
}

// The faces around these elements are computed once for all of them.
class GroupSource {
 public:
  GroupSource(const PolynomialSegment<3>& segment, const NormalGroups& groups)
      : segment_(segment), groups_(groups), place_of_face_(segment.topology->face_count(), kNoPlace) {}

  void write(IndexRange elements, std::span<Controls> result) {
    faces_.clear();
    for (std::size_t e = elements.first; e < elements.end(); ++e) {
      for (const std::uint32_t f : groups_.faces(e)) {
        if (place_of_face_[f] != kNoPlace) continue;
        place_of_face_[f] = static_cast<std::uint32_t>(faces_.size());
        faces_.push_back(f);
      }
    }
    of_faces_.resize(faces_.size());
    for (std::size_t i = 0; i < faces_.size(); ++i)
      polynomial_face_normals(segment_, {faces_[i], 1}, std::span(&of_faces_[i], 1));
    sum_path_normals<3>(
        groups_, elements, [this](std::uint32_t f) -> const Controls& { return of_faces_[place_of_face_[f]]; }, result,
        [&](std::size_t i) { result[i] = fine_normals(segment_, groups_.faces(elements.first + i), large_); });
    for (const std::uint32_t f : faces_) place_of_face_[f] = kNoPlace;
  }

 private:
  static constexpr std::uint32_t kNoPlace = ~std::uint32_t{0};

  const PolynomialSegment<3>& segment_;
  const NormalGroups& groups_;
  std::vector<std::uint32_t> place_of_face_, faces_;
  std::vector<Controls> of_faces_;
  LargeFaceValues<FineSums> large_;
};

// Calls body(source, piece) for pieces that cover all elements, on each thread with a source of its own.
template <class MakeSource, class Body>
void each_piece(std::size_t size, Threads threads, const MakeSource& make_source, const Body& body) {
  const std::size_t pieces = block_count(size, kPathPiece);
  const std::size_t workers = threads == Threads::kAll ? thread_count() : 1;
  std::atomic<std::size_t> next = 0;
  parallel_for(std::min(workers, pieces), [&](std::size_t) {
    auto source = make_source();
    for (std::size_t p = next++; p < pieces; p = next++)
      body(source, IndexRange{p * kPathPiece, std::min(kPathPiece, size - p * kPathPiece)});
  });
}

}  // namespace

std::vector<PolynomialNormals<3>> all_path_normals(const PolynomialSegment<3>& segment) {
  std::vector<Controls> result(segment.topology->face_count());
  parallel_blocks(result.size(), kPathPiece, [&](IndexRange range) {
    polynomial_face_normals(segment, range, std::span(result).subspan(range.first, range.count));
  });
  return result;
}

std::vector<PolynomialNormals<3>> all_path_normals(const PolynomialSegment<3>& segment, const NormalGroups& groups) {
  std::vector<Controls> result(groups.size());
  each_piece(
      result.size(), Threads::kAll, [&] { return GroupSource(segment, groups); },
      [&](GroupSource& source, IndexRange piece) {
        source.write(piece, std::span(result).subspan(piece.first, piece.count));
      });
  return result;
}

PathCurves::PathCurves() noexcept = default;
PathCurves::PathCurves(PathCurves&&) noexcept = default;
PathCurves& PathCurves::operator=(PathCurves&&) noexcept = default;
PathCurves::~PathCurves() = default;

PathCurves::PathCurves(std::span<const PolynomialNormals<3>> normals, Threads threads)
    : data_(std::make_unique<Data>(normals.size(), threads, [normals] { return GivenSource(normals); })) {}
PathCurves::PathCurves(const PolynomialSegment<3>& segment, Threads threads)
    : data_(std::make_unique<Data>(segment.topology->face_count(), threads, [&] { return FaceSource(segment); })) {}
PathCurves::PathCurves(const PolynomialSegment<3>& segment, const NormalGroups& groups, Threads threads)
    : data_(std::make_unique<Data>(groups.size(), threads, [&] { return GroupSource(segment, groups); })) {}

template <class MakeSource>
PathCurves::Data::Data(std::size_t count, Threads threads, const MakeSource& make_source)
    : size(count), blocks(block_count(count, kTile) * kPathBlock) {
  struct Flagged {
    std::vector<std::size_t> elements;
    std::vector<Controls> normals;
  };
  std::vector<Flagged> of_pieces(block_count(size, kPathPiece));
  each_piece(size, threads, make_source, [&](auto& source, IndexRange piece) {
    std::vector<Controls> normals(piece.count);
    source.write(piece, normals);
    Flagged& found = of_pieces[piece.first / kPathPiece];
    for (std::size_t i = 0; i < piece.count; ++i) {
      if (pack(piece.first + i, normals[i])) continue;
      found.elements.push_back(piece.first + i);
      found.normals.push_back(normals[i]);
    }
  });
  for (std::size_t i = size; i % kTile != 0; ++i) pack(i, {});
  for (const Flagged& found : of_pieces) {
    flagged.insert(flagged.end(), found.elements.begin(), found.elements.end());
    flagged_normals.insert(flagged_normals.end(), found.normals.begin(), found.normals.end());
  }
}

std::size_t PathCurves::unit_normals(double time, VectorView<float> result, Threads threads) const {
  assert(result.count == size());
  if (std::isnan(time)) {
    for (std::size_t i = 0; i < size(); ++i) result.set(i, {});
    return size();
  }
  const double t = local_time(time);
  std::atomic<std::size_t> without_direction = 0;
  const MemoryAccess pass = access_of_pass(bytes(), size() * 3 * sizeof(float));
  blocks_on(threads, size(), kPathPiece, [&](IndexRange range) {
    without_direction += data_->evaluate(range, t, result, pass);
    flush_stream();
  });
  return without_direction;
}

// Evaluates a range of elements that begins at a block.
std::size_t PathCurves::Data::evaluate(IndexRange range, double t, VectorView<float> result,
                                       MemoryAccess pass) const noexcept {
  if (range.count == 0) return 0;
  const PathWeights weights = weights_at(t);
  const float* const first_block = blocks.data() + range.first / kTile * kPathBlock;
  std::size_t done = range.count / kTile * kTile;  // the elements of whole blocks, all of which the kernel may write
  if (result.is_packed())
    evaluate_path_blocks(first_block, done / kTile, weights,
                         PackedResult{result.x + 3 * range.first, access_to(pass, result.x)});
  else if (result.stride == 1)
    evaluate_path_blocks(first_block, done / kTile, weights,
                         PlanesResult{result.x + range.first, result.y + range.first, result.z + range.first,
                                      access_to(pass, result.x, result.y, result.z)});
  else
    done = 0;
  alignas(64) float x[kTile], y[kTile], z[kTile];
  for (; done < range.count; done += kTile) {
    evaluate_path_blocks(first_block + done / kTile * kPathBlock, 1, weights, PlanesResult{x, y, z});
    const std::size_t count = std::min(kTile, range.count - done);
    for (std::size_t i = 0; i < count; ++i) result.set(range.first + done + i, {x[i], y[i], z[i]});
  }
  std::size_t without_direction = 0;
  auto at = std::lower_bound(flagged.begin(), flagged.end(), range.first);
  for (; at != flagged.end() && *at < range.end(); ++at) {
    const UnitNormal u = unit_normal_at(flagged_normals[static_cast<std::size_t>(at - flagged.begin())], t);
    result.set(*at, to_float(u.vector));
    if (u.direction == Direction::kNone) ++without_direction;
  }
  return without_direction;
}

std::size_t PathCurves::size() const noexcept { return data_ ? data_->size : 0; }
std::size_t PathCurves::flagged_count() const noexcept { return data_ ? data_->flagged.size() : 0; }
std::size_t PathCurves::bytes() const noexcept {
  constexpr std::size_t kIndex = 8, kElement = 3 * kPathControls * sizeof(float);
  return size() * kElement + flagged_count() * (kIndex + sizeof(Controls));
}

}  // namespace chronormal
