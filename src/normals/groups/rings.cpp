// Orders the faces around an element so that each face adjoins the previous face, and stores the paths around sixteen
// elements side by side.
#include "normals/groups/rings.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>

namespace chronormal::inline internal {
namespace {

// The largest number of pieces of a path for which the code looks for an order in which they adjoin.
constexpr std::size_t kMostSearched = 64;
using Path = std::vector<std::uint32_t>;  // first the centre, and then the points of the path

// Makes the paths around elements, one after the other.
class PathMaker {
 public:
  PathMaker(const Topology& topology, const NormalGroups& groups, std::size_t most_points)
      : topology_(topology), groups_(groups), most_points_(most_points) {}

  const Path& make(std::size_t element) {
    is_left_out_ = false;
    path_.clear();
    const auto corners = groups_.corners(element), faces = groups_.faces(element);
    path_.push_back(corners.empty() ? 0 : topology_.corners()[corners[0]]);
    if (topology_.all_triangles() && corners.size() <= kMostTriangles && make_of_triangles(corners)) return path_;
    std::size_t points = 0;
    for (const std::uint32_t f : faces) points += topology_.face(f).size() - 1;
    if (points > most_points_) return no_path();
    points_.clear();
    pieces_.clear();
    for (std::size_t i = 0; i < corners.size(); ++i) add_piece(corners[i], topology_.face(faces[i]));
    if (pieces_.size() > kMostSearched) {
      for (const Piece& piece : pieces_) append(piece);
    } else {
      while (!pieces_.empty()) {
        const std::size_t next = next_piece();
        append(pieces_[next]);
        pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(next));
      }
    }
    if (path_.size() - 1 > most_points_) return no_path();
    if (path_.size() == 1) path_.resize(2, path_[0]);
    return path_;
  }

  // Returns true if the path that was made last would have more than most_points points, and was replaced by a path
  // that adds nothing.
  [[nodiscard]] bool is_left_out() const { return is_left_out_; }

 private:
  static constexpr std::size_t kMostTriangles = 16;

  struct Piece {
    std::size_t first, last;  // the first and the last point of the piece, as indices into points_
  };

  // Returns a path that consists only of the centre and adds nothing, in place of a path that is too long.
  const Path& no_path() {
    is_left_out_ = true;
    path_.resize(1);
    path_.resize(2, path_[0]);
    return path_;
  }

  // Makes the path that next_piece() and append() would make, for a few triangles around one vertex. Each triangle is
  // then a piece of two points. Returns false if the triangles are not around one vertex; the path then has only the
  // centre.
  bool make_of_triangles(std::span<const std::uint32_t> corners) {
    std::array<std::uint32_t, kMostTriangles> from, to;
    const std::uint32_t* const vertices = topology_.corners().data();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::uint32_t corner = corners[i], in_face = corner % 3;
      if (vertices[corner] != path_[0]) return false;
      from[i] = vertices[in_face == 2 ? corner - 2 : corner + 1];
      to[i] = vertices[in_face == 0 ? corner + 2 : corner - 1];
    }
    if (3 * corners.size() > most_points_) return false;
    std::uint32_t left = (1U << corners.size()) - 1;  // a bit for each triangle that is not in the path
    const auto first_of = [&left](const auto& is_one) {
      for (std::uint32_t bits = left; bits != 0; bits &= bits - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(bits));
        if (is_one(i)) return i;
      }
      return kMostTriangles;
    };
    while (left != 0) {
      std::size_t next = kMostTriangles;
      if (path_.size() > 1) next = first_of([&](std::size_t i) { return from[i] == path_.back(); });
      const bool joins = next < kMostTriangles;
      if (!joins) {
        const auto has_none_before = [&](std::size_t i) {
          return first_of([&](std::size_t j) { return to[j] == from[i]; }) == kMostTriangles;
        };
        next = first_of(has_none_before);
        if (next == kMostTriangles) next = static_cast<std::size_t>(std::countr_zero(left));
        if (path_.size() > 1) path_.push_back(path_[0]);
        path_.push_back(from[next]);
      }
      path_.push_back(to[next]);
      left &= ~(1U << next);
    }
    if (path_.size() == 1) path_.resize(2, path_[0]);
    return true;
  }

  // Adds the piece of the path that a face contributes at a corner: the other corners of the face in order. The vertex
  // of the corner may be a copy of the centre and not the centre itself. The piece is then the whole outline of the
  // face, closed at this corner.
  void add_piece(std::size_t corner, std::span<const std::uint32_t> face) {
    const std::size_t first = points_.size();
    const std::size_t at = corner - static_cast<std::size_t>(face.data() - topology_.corners().data());
    const bool is_centre = face[at] == path_[0];
    for (std::size_t i = is_centre ? 1 : 0; i < face.size() + (is_centre ? 0 : 1); ++i)
      points_.push_back(face[(at + i) % face.size()]);
    pieces_.push_back({first, points_.size() - 1});
  }

  // Adds a piece to the path. If the piece does not adjoin the last piece, the path goes through the centre in between.
  void append(const Piece& piece) {
    std::size_t from = piece.first;
    if (path_.size() > 1 && path_.back() == points_[from]) {
      ++from;
    } else if (path_.size() > 1) {
      path_.push_back(path_[0]);
    }
    for (; from <= piece.last; ++from) path_.push_back(points_[from]);
  }

  // Returns a piece that adjoins the last piece of the path. If no piece does, returns a piece to which no other piece
  // leads, or else any piece.
  [[nodiscard]] std::size_t next_piece() const {
    const auto start = [this](std::size_t piece) { return points_[pieces_[piece].first]; };
    for (std::size_t i = 0; i < pieces_.size() && path_.size() > 1; ++i) {
      if (start(i) == path_.back()) return i;
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const auto leads_to = [&](const Piece& piece) { return points_[piece.last] == start(i); };
      if (std::none_of(pieces_.begin(), pieces_.end(), leads_to)) return i;
    }
    return 0;
  }

  const Topology& topology_;
  const NormalGroups& groups_;
  std::size_t most_points_;
  bool is_left_out_ = false;
  Path path_;
  std::vector<std::uint32_t> points_;
  std::vector<Piece> pieces_;
};

}  // namespace

// Stores the centre and the path of each element. Calls path_of(element) twice: first for the length, so that no more
// memory is allocated than needed, and then for the points.
template <class PathOf>
Rings::Rings(std::size_t count, const PathOf& path_of) {
  first_row_.reserve(1 + (count + kRingLanes - 1) / kRingLanes);
  for (std::size_t first = 0; first < count; first += kRingLanes) {
    std::size_t rows = 2;
    for (std::size_t e = first; e < std::min(first + kRingLanes, count); ++e) rows = std::max(rows, path_of(e).size());
    first_row_.push_back(first_row_.back() + rows);
  }
  indices_.resize(kRingLanes * first_row_.back());
  for (std::size_t slice = 0; slice + 1 < first_row_.size(); ++slice) {
    for (std::size_t lane = 0; lane < kRingLanes; ++lane) {
      const Path& path = path_of(std::min(kRingLanes * slice + lane, count - 1));
      const std::size_t rows = first_row_[slice + 1] - first_row_[slice];
      std::uint32_t* const column = &indices_[kRingLanes * first_row_[slice] + lane];
      for (std::size_t r = 0; r < rows; ++r) column[kRingLanes * r] = path[r < path.size() ? r : 0];
    }
  }
}

Rings Rings::of_faces(const Topology& topology, std::size_t most_points) {
  Path path;
  return Rings(topology.face_count(), [&topology, &path, most_points](std::size_t f) -> const Path& {
    const auto face = topology.face(f);  // the first corner is the centre, and the others are the path
    path.assign(face.begin(), face.size() - 1 > most_points ? face.begin() + 1 : face.end());
    if (path.size() == 1) path.push_back(path[0]);
    return path;
  });
}

Rings Rings::of_groups(const Topology& topology, const NormalGroups& groups, std::size_t most_points) {
  PathMaker paths(topology, groups, most_points);
  std::vector<std::uint32_t> left_out;
  Rings rings(groups.size(), [&](std::size_t e) -> const Path& {
    const Path& path = paths.make(e);
    // Each path is requested twice, but its element must be listed only once. Elements are requested in ascending
    // order.
    if (paths.is_left_out() && (left_out.empty() || left_out.back() < e))
      left_out.push_back(static_cast<std::uint32_t>(e));
    return path;
  });
  rings.left_out_ = std::move(left_out);
  return rings;
}

const Rings& rings_around(const Topology& topology, const NormalGroups& groups) {
  static const Rings kNone;
  if (!groups.rings_) return kNone;
  std::call_once(groups.rings_->once,
                 [&] { groups.rings_->rings = Rings::of_groups(topology, groups, kMostPathPoints); });
  return groups.rings_->rings;
}

}  // namespace chronormal::inline internal
