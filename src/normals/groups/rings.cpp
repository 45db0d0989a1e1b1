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
  PathMaker(const Topology& topology, const NormalGroups& groups) : topology_(topology), groups_(groups) {}

  const Path& make(std::size_t element) {
    path_.clear();
    points_.clear();
    pieces_.clear();
    const auto corners = groups_.corners(element), faces = groups_.faces(element);
    path_.push_back(corners.empty() ? 0 : topology_.corners()[corners[0]]);
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
  Path path_;
  std::vector<std::uint32_t> points_;
  std::vector<Piece> pieces_;
};

}  // namespace

// path_of(element) gives the centre and the path of an element.
template <class PathOf>
Rings::Rings(std::size_t count, const PathOf& path_of) {
  first_row_.reserve(1 + (count + kRingLanes - 1) / kRingLanes);
  for (std::size_t first = 0; first < count; first += kRingLanes) {
    const std::size_t begin = indices_.size();
    std::size_t rows = 0;
    for (std::size_t lane = 0; lane < kRingLanes; ++lane) {
      // Behind the last element, slices are filled up with a path that adds nothing.
      static const Path kNone = {0, 0};
      const Path& path = first + lane < count ? path_of(first + lane) : kNone;
      const auto row = [&](std::size_t r) { return &indices_[begin + kRingLanes * r]; };
      for (; rows < path.size(); ++rows) {
        indices_.resize(begin + kRingLanes * (rows + 1));
        if (rows > 0) std::copy_n(row(0), lane, row(rows));  // shorter paths repeat their last point
      }
      for (std::size_t r = 0; r < rows; ++r) row(r)[lane] = path[r < path.size() ? r : 0];
    }
    first_row_.push_back(first_row_.back() + rows);
  }
  indices_.shrink_to_fit();
}

Rings Rings::of_faces(const Topology& topology) {
  return Rings(topology.face_count(), [&topology](std::size_t f) {
    const auto face = topology.face(f);  // the first corner is the centre, and the others are the path
    return Path(face.begin(), face.end());
  });
}

Rings Rings::of_groups(const Topology& topology, const NormalGroups& groups) {
  PathMaker paths(topology, groups);
  return Rings(groups.size(), [&paths](std::size_t e) -> const Path& { return paths.make(e); });
}

}  // namespace chronormal::inline internal
