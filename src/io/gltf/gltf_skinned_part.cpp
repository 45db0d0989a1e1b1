#include "io/gltf/gltf_skinned_part.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "core/blocks.h"
#include "motion/piece_bounds.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kPieceBlock = 1024;

}  // namespace

Result<GltfSkinnedPart> GltfSkinnedPart::read(const GltfDocument& document, const GltfPart& part,
                                              std::shared_ptr<const GltfSkin> skin) {
  GltfSkinnedPart result;
  const Status status = skin->read_shares(document, part.mesh, part.primitive, result.first_, result.shares_);
  if (!status) return status.error();
  result.first_.push_back(result.shares_.size());
  result.skin_ = std::move(skin);
  return result;
}

Vec3d GltfSkinnedPart::place(std::span<const AffineTransform> pose, std::size_t vertex,
                             const Vec3d& before) const noexcept {
  Vec3d sum;
  for (const JointShare& of_joint : shares(vertex)) sum = sum + of_joint.share * pose[of_joint.joint](before);
  return sum;
}

GltfSkinPieces::GltfSkinPieces(const GltfSkinnedPart& part, const Topology& topology, const GltfPart& range,
                               GltfUnskinned before, double sine)
    : part_(part), topology_(topology), range_(range), before_(std::move(before)), sine_(sine) {
  const std::vector<BoneBounds> bones = part.skin().bounds(before_.from, before_.to);
  std::vector<std::uint32_t> vertices(range.vertex_count);
  std::iota(vertices.begin(), vertices.end(), 0U);
  std::vector<Vec3d> from(vertices.size()), to(vertices.size());
  before_.at(vertices, before_.from, false, from);
  before_.at(vertices, before_.to, true, to);
  bends_.resize(2 * range.face_count);
  parallel_each(range.face_count, kPieceBlock, [&](std::size_t f) {
    const auto face = static_cast<std::uint32_t>(range.first_face + f);
    for (std::size_t c = 1; c < 3; ++c)
      bends_[2 * f + c - 1] = bend_of_edge(bones, from, to, vertex(face, 0), vertex(face, c));
  });
}

double GltfSkinPieces::bend_of_edge(std::span<const BoneBounds> bones, std::span<const Vec3d> from,
                                    std::span<const Vec3d> to, std::uint32_t p, std::uint32_t q) const {
  const GltfSkin& skin = part_.skin();
  const double h = before_.to - before_.from;
  // Calls body(joint, share of p, share of q) once for each joint that moves p or q.
  const auto each_joint = [&](const auto& body) {
    const auto share_of = [&](std::uint32_t vertex, std::uint32_t joint) {
      double sum = 0;
      for (const JointShare& one : part_.shares(vertex)) sum += one.joint == joint ? one.share : 0;
      return sum;
    };
    for (const std::uint32_t vertex : {p, q}) {
      const std::span<const JointShare> shares = part_.shares(vertex);
      for (std::size_t i = 0; i < shares.size(); ++i) {
        const std::uint32_t joint = shares[i].joint;
        const auto is_same = [&](const JointShare& one) { return one.joint == joint; };
        const bool is_seen = std::any_of(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(i), is_same);
        if (!is_seen && (vertex == p || share_of(p, joint) == 0)) body(joint, share_of(p, joint), share_of(q, joint));
      }
    }
  };
  // The bone at which the paths to the root meet, for all joints whose shares in p and q differ.
  std::optional<std::size_t> meeting;
  bool is_first = true;
  each_joint([&](std::uint32_t joint, double of_p, double of_q) {
    if (of_p == of_q) return;
    const std::size_t bone = skin.bone_of_joint(joint);
    meeting = is_first ? bone : meeting ? skin.meeting_bone(*meeting, bone) : std::nullopt;
    is_first = false;
  });
  const double path_to_meeting = meeting ? bones[*meeting].path_bend : 0;
  double sum = 0;
  each_joint([&](std::uint32_t joint, double of_p, double of_q) {
    const BoneBounds& bone = bones[skin.bone_of_joint(joint)];
    const AffineTransform& bind = skin.inverse_bind(joint);
    const Vec3d start = of_q * bind(from[q]) - of_p * bind(from[p]), end = of_q * bind(to[q]) - of_p * bind(to[p]);
    double bend = 0;
    if (!before_.bend.empty()) {
      const double scale = length(bind.columns[0]) + length(bind.columns[1]) + length(bind.columns[2]);
      bend = scale * (std::fabs(of_q) * before_.bend[q] + std::fabs(of_p) * before_.bend[p]);
    }
    const double size = std::max(length(start), length(end)) + h * h * bend / 8;
    const double speed = length(end - start) / h + h * bend / 2;
    sum += bone.bend * size + 2 * bone.speed * speed + bone.size * bend;
    if (of_p != of_q) sum += std::fabs(of_q - of_p) * (bone.path_bend - path_to_meeting);
  });
  return sum;
}

std::vector<std::uint32_t> GltfSkinPieces::vertices_of(std::span<const std::uint32_t> faces) const {
  std::vector<bool> is_used(range_.vertex_count, false);
  for (const std::uint32_t face : faces)
    for (std::size_t c = 0; c < 3; ++c) is_used[vertex(face, c)] = true;
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < is_used.size(); ++v)
    if (is_used[v]) vertices.push_back(v);
  return vertices;
}

std::vector<std::uint32_t> GltfSkinPieces::not_within(const std::vector<std::uint32_t>* faces,
                                                      std::size_t pieces) const {
  std::vector<std::uint32_t> asked;
  const auto end = static_cast<std::uint32_t>(range_.first_face + range_.face_count);
  if (faces == nullptr) {
    asked.resize(range_.face_count);
    std::iota(asked.begin(), asked.end(), static_cast<std::uint32_t>(range_.first_face));
  } else {
    asked.assign(std::lower_bound(faces->begin(), faces->end(), range_.first_face),
                 std::lower_bound(faces->begin(), faces->end(), end));
  }
  const std::vector<std::uint32_t> vertices = vertices_of(asked);
  const double duration = before_.to - before_.from, step = duration / static_cast<double>(pieces);
  const auto places_at = [&](std::size_t i, std::vector<Vec3d>& result) {
    const bool is_last = i == pieces;
    const double part = static_cast<double>(i) / static_cast<double>(pieces);
    const double time = is_last ? before_.to : before_.from + duration * part;
    const std::vector<AffineTransform> pose = part_.skin().pose(time, is_last);
    before_.at(vertices, time, is_last, result);
    parallel_each(vertices.size(), kPieceBlock, [&](std::size_t n) {
      Vec3d& place = result[vertices[n]];
      place = part_.place(pose, vertices[n], place);
    });
  };
  std::vector<Vec3d> from(range_.vertex_count), to(range_.vertex_count);
  std::vector<char> is_wrong(asked.size(), 0);
  places_at(0, from);
  for (std::size_t i = 0; i < pieces; ++i, std::swap(from, to)) {
    places_at(i + 1, to);
    parallel_each(asked.size(), kPieceBlock, [&](std::size_t n) {
      if (is_wrong[n] != 0) return;
      const std::uint32_t face = asked[n], first = vertex(face, 0);
      const auto edge_to = [&](std::size_t c) -> PieceEdge {
        const std::uint32_t other = vertex(face, c);
        const double size =
            std::max({max_abs(from[first]), max_abs(from[other]), max_abs(to[first]), max_abs(to[other])});
        return {{from[other] - from[first], to[other] - to[first]},
                {},
                step * step / 2 * bends_[2 * (face - range_.first_face) + c - 1],
                edge_rounding(size)};
      };
      is_wrong[n] = is_within(3, edge_to, sine_) ? 0 : 1;
    });
    if (std::find(is_wrong.begin(), is_wrong.end(), 0) == is_wrong.end()) break;
  }
  std::vector<std::uint32_t> result;
  for (std::size_t n = 0; n < asked.size(); ++n)
    if (is_wrong[n] != 0) result.push_back(asked[n]);
  return result;
}

}  // namespace chronormal::inline internal
