// Section 1: which of our weightings other libraries have, and the rules of theirs that are not ours.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "weightings/sections.h"
#ifdef CHRONORMAL_HAVE_PEERS
#include "peers/peers.h"
#endif

namespace chronormal::weightings {

#ifndef CHRONORMAL_HAVE_PEERS

std::string peers_part(const std::string&) { return ""; }

#else

namespace {

using Normals = std::vector<Vec3d>;

struct Difference {
  double mean = 0, largest = 0;  // degrees
};

Difference difference(const Normals& a, const Normals& b, const std::vector<bool>& taken) {
  Difference result;
  std::size_t count = 0;
  for (std::size_t v = 0; v < a.size(); ++v) {
    if (!taken[v]) continue;
    const double angle = angle_between(a[v], b[v]) * kDegreesPerRadian;
    result.mean += angle;
    result.largest = std::max(result.largest, angle);
    ++count;
  }
  result.mean /= static_cast<double>(count);
  return result;
}

std::string text(const Difference& d) { return fmt::format("{:.3f} / {:.3f}", d.mean, d.largest); }

// ---- the rules of others that are not sums -------------------------------------------------------------------------

// CGAL takes a normal as enclosed by a circle where its cosine is short of that of the circle by no more than this.
constexpr double kEnclosed = 0.00017453292431333;

// The centre of the smallest circle around some unit normals that goes through two of them, or, where none of those
// encloses the others, through three; "around" with the tolerance of CGAL. Of two circles the smaller one is known by
// the length of its (unscaled) centre.
Vec3d centre_of_smallest_circle(const Normals& normals) {
  Vec3d best;
  double best_product = -1;
  const auto attempt = [&](const Vec3d& centre, std::initializer_list<std::size_t> through) {
    const double product = std::max(0.0, dot(centre, normals[*through.begin()]));
    if (centre == Vec3d{} || product <= best_product) return;
    for (std::size_t l = 0; l < normals.size(); ++l) {
      if (std::find(through.begin(), through.end(), l) != through.end()) continue;
      if (dot(centre, normals[l]) < product - kEnclosed * length(centre)) return;
    }
    best = centre;
    best_product = product;
  };
  const std::size_t count = normals.size();
  if (count == 1) return normals[0];
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j)
      attempt(normals[i] == normals[j] ? normals[i] : normals[i] + normals[j], {i, j});
  }
  if (best_product >= 0) return unit(best);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      for (std::size_t k = j + 1; k < count; ++k) {
        const Vec3d axis = unit(cross(normals[j] - normals[i], normals[k] - normals[i]));
        attempt(dot(axis, normals[i]) * axis, {i, j, k});
      }
    }
  }
  return unit(best);
}

Normals smallest_circles(const Segment& segment, const NormalGroups& groups) {
  Normals of_faces(segment.topology->face_count()), result;
  face_normals_at(segment, 0, {0, of_faces.size()}, of_faces);
  for (std::size_t e = 0; e < groups.size(); ++e) {
    Normals around;
    for (const std::uint32_t f : groups.faces(e)) around.push_back(unit(of_faces[f]));
    result.push_back(centre_of_smallest_circle(around));
  }
  return result;
}

// The neighbours of each vertex, counter-clockwise; none where its faces do not close round it.
std::vector<std::vector<std::uint32_t> > rings(const Topology& topology) {
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t> > > opposite(topology.vertex_count());
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (std::size_t c = 0; c < 3; ++c) opposite[face[c]].emplace_back(face[(c + 1) % 3], face[(c + 2) % 3]);
  }
  std::vector<std::vector<std::uint32_t> > result(topology.vertex_count());
  for (std::size_t v = 0; v < result.size(); ++v) {
    const auto& edges = opposite[v];
    std::vector<std::uint32_t> ring;
    std::uint32_t here = edges[0].first;
    do {
      const auto next = std::find_if(edges.begin(), edges.end(), [here](const auto& e) { return e.first == here; });
      if (next == edges.end()) break;
      ring.push_back(here);
      here = next->second;
    } while (here != edges[0].first);
    if (here == edges[0].first && ring.size() == edges.size()) result[v] = ring;
  }
  return result;
}

// The normal of the limit of Loop subdivision: the cross product of its two tangents, sums over the ring with the
// cosine and the sine of each neighbour's share of a turn. Zero at a boundary.
Normals loop_limits(const Segment& segment) {
  Normals result;
  for (const auto& ring : rings(*segment.topology)) {
    Vec3d along, across;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const double turn = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(ring.size());
      along = along + std::cos(turn) * to_double(segment.from[ring[i]]);
      across = across + std::sin(turn) * to_double(segment.from[ring[i]]);
    }
    result.push_back(cross(along, across));
  }
  return result;
}

// ---- the tables ----------------------------------------------------------------------------------------------------

struct Peer {
  const char* call;
  const char* rule;
};
constexpr std::array kPeers = {
    Peer{"calc_vertex_normal_fast", "uniform"},    Peer{"calc_vertex_normal_correct", "area"},
    Peer{"calc_vertex_normal_loop", "Loop limit"}, Peer{"vtkPolyDataNormals", "uniform"},
    Peer{"vtkTriangleMeshPointNormals", "area"},   Peer{"compute_vertex_normals", "smallest circle"}};

std::vector<peers::Method> all_methods() {
  std::vector<peers::Method> all;
  for (const auto& some : {peers::openmesh_methods(), peers::vtk_methods(), peers::cgal_methods()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace

std::string peers_part(const std::string& folder) {
  Page part("weightings/peers.md.in", folder);
  Cells header = {"degrees, mean / max"};
  for (const WeightingInfo& info : kWeightings) header.push_back(fmt::format("`{}`", info.name));
  header.emplace_back("rule, max");

  double worst_match = 0, loop_at_boundary = 0, apart = 0;
  for (const char* const name : {"bend", "twist", "cloth"}) {
    const Motion motion = posed(make_builtin_morph(name).value(), 0, 0.5);
    const Segment segment = motion.segment(0);
    const std::size_t count = motion.topology.vertex_count();
    const NormalGroups groups = NormalGroups::of_vertices(motion.topology, separate_points(count));
    const Normals circles = smallest_circles(segment, groups), loops = loop_limits(segment);
    const std::vector<bool> all(count, true);
    std::vector<bool> inside, outside;
    for (const Vec3d& n : loops) inside.push_back(n != Vec3d{}), outside.push_back(n == Vec3d{});

    std::vector<Cells> rows;
    for (const peers::Method& method : all_methods()) {
      const auto peer =
          std::find_if(kPeers.begin(), kPeers.end(), [&](const Peer& p) { return p.call == method.call; });
      const Normals theirs = method.normals({motion.keyframes[0].positions, motion.topology.corners()});
      const std::string_view rule = peer->rule;
      const bool loop = rule == "Loop limit";
      Cells row = {fmt::format("{} `{}`{}", method.library, method.call, loop ? " (inside)" : "")};
      double match = rule == "smallest circle" ? difference(theirs, circles, all).largest
                                               : difference(theirs, loops, inside).largest;
      for (const WeightingInfo& info : kWeightings) {
        const Normals ours = all_weighted_normals_at(segment, groups, info.weighting, 0);
        const Difference d = difference(theirs, ours, loop ? inside : all);
        row.push_back(info.name == rule ? fmt::format("**{}**", text(d)) : text(d));
        if (info.name == rule) match = d.largest;
        if (loop && info.weighting == Weighting::kArea)
          loop_at_boundary = std::max(loop_at_boundary, difference(theirs, ours, outside).largest);
      }
      row.push_back(fmt::format("{}, {:.3f}", rule, match));
      rows.push_back(row);
      worst_match = std::max(worst_match, match);
    }
    apart = std::max(apart, difference(all_weighted_normals_at(segment, groups, Weighting::kArea, 0),
                                       all_weighted_normals_at(segment, groups, Weighting::kUniform, 0), all)
                                .largest);
    part.set(fmt::format("{}_vertices", name), grouped(static_cast<double>(count)));
    part.table(name, header, rows, header.size() - 1);
  }
  require(worst_match < 0.001, "every library is matched by a rule");
  require(loop_at_boundary > 90, "the Loop mask is of no use at a boundary");
  part.set({{"area_from_uniform", fmt::format("{:.1f}", apart)},
            {"loop_at_boundary", fmt::format("{:.0f}", loop_at_boundary)}});
  return part.markdown();
}

#endif

}  // namespace chronormal::weightings
