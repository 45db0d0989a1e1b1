// Orders the faces around an element so that each joins the one before, and lays the paths of sixteen elements side by
// side.
#include "normals/groups/rings.h"

#include <algorithm>
#include <span>

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostSearched = 64;  // pieces of a path; in longer paths, nothing looks for the next piece
using Path = std::vector<std::uint32_t>;   // the first point is the centre

// The paths around elements, one after the other.
class PathMaker {
 public:
  PathMaker(const Topology& topology, const NormalGroups& groups, std::size_t most_points)
      : topology_(topology), groups_(groups), most_points_(most_points) {}

  const Path& make(std::size_t element) {
    path_.clear();
    points_.clear();
    pieces_.clear();
    const auto corners = groups_.corners(element), faces = groups_.faces(element);
    path_.push_back(corners.empty() ? 0 : topology_.corners()[corners[0]]);
    std::size_t points = 0;
    for (const std::uint32_t f : faces) points += topology_.face(f).size() - 1;
    if (points > most_points_) {
      path_.push_back(path_[0]);
      return path_;
    }
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
    if (path_.size() == 1) path_.push_back(path_[0]);
    return path_;
  }

 private:
  struct Piece {
    std::size_t first, last;  // of points_
  };

  // The corners of a face that follow this one, or all of them back to it where this corner is not the centre.
  void add_piece(std::size_t corner, std::span<const std::uint32_t> face) {
    const std::size_t first = points_.size();
    const std::size_t at = corner - static_cast<std::size_t>(face.data() - topology_.corners().data());
    const bool is_centre = face[at] == path_[0];
    for (std::size_t i = is_centre ? 1 : 0; i < face.size() + (is_centre ? 0 : 1); ++i)
      points_.push_back(face[(at + i) % face.size()]);
    pieces_.push_back({first, points_.size() - 1});
  }

  // Adds a piece to the path; it goes through the centre where the piece does not join the last one.
  void append(const Piece& piece) {
    std::size_t from = piece.first;
    if (path_.size() > 1 && path_.back() == points_[from]) {
      ++from;
    } else if (path_.size() > 1) {
      path_.push_back(path_[0]);
    }
    for (; from <= piece.last; ++from) path_.push_back(points_[from]);
  }

  // Takes a piece that joins the last one, or else a piece that no other leads to, or else any.
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
  Path path_;
  std::vector<std::uint32_t> points_;
  std::vector<Piece> pieces_;
};

}  // namespace

// path_of(element) gives the centre and the path of an element, twice: first its length is asked for, so that no memory
// is taken that is not kept.
template <class PathOf>
Rings::Rings(std::size_t count, const PathOf& path_of) {
  // Behind the last element, slices are filled up with a path that adds nothing.
  static const Path kNone = {0, 0};
  first_row_.reserve(1 + (count + kRingLanes - 1) / kRingLanes);
  for (std::size_t first = 0; first < count; first += kRingLanes) {
    std::size_t rows = kNone.size();
    for (std::size_t e = first; e < std::min(first + kRingLanes, count); ++e) rows = std::max(rows, path_of(e).size());
    first_row_.push_back(first_row_.back() + rows);
  }
  indices_.resize(kRingLanes * first_row_.back());
  for (std::size_t slice = 0; slice + 1 < first_row_.size(); ++slice) {
    for (std::size_t lane = 0; lane < kRingLanes; ++lane) {
      const std::size_t e = kRingLanes * slice + lane;
      const Path& path = e < count ? path_of(e) : kNone;
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
  return Rings(groups.size(), [&paths](std::size_t e) -> const Path& { return paths.make(e); });
}

}  // namespace chronormal::inline internal
