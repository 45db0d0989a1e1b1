// Computes the control normals of faces between two steps, their sums for points and cells, and the directions of the
// sums at t.
#include "poly_data_normals.h"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "chronormal/core/parallel.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "core/rounding.h"
#include "core/vector_area.h"
#include "normals/groups/group_sum.h"

namespace chronormal::vtk {
namespace {

constexpr std::size_t kBlock = 4096;  // number of elements that one thread takes at a time

std::size_t size(vtkIdType count) { return static_cast<std::size_t>(count); }

// Calls body(i) for every element, in blocks on all cores.
template <class Body>
void for_elements(std::size_t count, const Body& body) {
  parallel_for((count + kBlock - 1) / kBlock, [&](std::size_t block) {
    const std::size_t end = std::min(count, (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i) body(i);
  });
}

// Returns the four lists of cells of a vtkPolyData, in the order in which vtkPolyData numbers cells.
std::array<vtkCellArray*, 4> cell_lists(vtkPolyData* mesh) {
  return {mesh->GetVerts(), mesh->GetLines(), mesh->GetPolys(), mesh->GetStrips()};
}

Status check_cells(vtkPolyData* from, vtkPolyData* to) {
  const auto before = cell_lists(from), after = cell_lists(to);
  vtkIdType number = 0;
  vtkNew<vtkIdList> a, b;
  for (std::size_t list = 0; list < before.size(); ++list) {
    const vtkIdType count = before[list]->GetNumberOfCells();
    if (count != after[list]->GetNumberOfCells())
      return invalid_input("", "the two steps have different numbers of vertices, lines, polygons or strips");
    for (vtkIdType c = 0; c < count; ++c, ++number) {
      const auto place = [number] { return "cell " + std::to_string(number); };
      before[list]->GetCellAtId(c, a);
      for (const vtkIdType point : *a) {
        if (point < 0 || point >= from->GetNumberOfPoints())
          return invalid_input(place(),
                               "the cell refers to point " + std::to_string(point) + ", which the mesh does not have");
      }
      if (before[list] == after[list]) continue;
      after[list]->GetCellAtId(c, b);
      if (!std::equal(a->begin(), a->end(), b->begin(), b->end()))
        return invalid_input(place(), "the cell has different points in the two steps");
    }
  }
  return Success{};
}

Status check_positions(vtkPolyData* mesh) {
  for (vtkIdType p = 0; p < mesh->GetNumberOfPoints(); ++p) {
    const double* const x = mesh->GetPoint(p);
    if (!std::isfinite(x[0]) || !std::isfinite(x[1]) || !std::isfinite(x[2]))
      return invalid_input("point " + std::to_string(p), "a coordinate of the point is NaN or infinite");
  }
  return Success{};
}

// The polygons of a mesh and the triangles of its strips, each with the cell to which it belongs.
struct Faces {
  Topology topology;
  std::vector<std::uint32_t> cells;
};

Faces find_faces(vtkPolyData* mesh) {
  std::vector<std::uint32_t> offsets = {0}, corners, cells;
  const auto number = [](vtkIdType n) { return static_cast<std::uint32_t>(n); };
  const auto end_face = [&](vtkIdType cell) {
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
    cells.push_back(number(cell));
  };
  corners.reserve(size(mesh->GetPolys()->GetNumberOfConnectivityIds()));
  offsets.reserve(size(mesh->GetNumberOfPolys()) + 1);
  cells.reserve(size(mesh->GetNumberOfPolys()));
  vtkNew<vtkIdList> points;
  vtkIdType cell = mesh->GetNumberOfVerts() + mesh->GetNumberOfLines();
  for (vtkIdType c = 0; c < mesh->GetNumberOfPolys(); ++c, ++cell) {
    mesh->GetPolys()->GetCellAtId(c, points);
    if (points->GetNumberOfIds() < 3) continue;
    for (const vtkIdType point : *points) corners.push_back(number(point));
    end_face(cell);
  }
  for (vtkIdType c = 0; c < mesh->GetNumberOfStrips(); ++c, ++cell) {
    mesh->GetStrips()->GetCellAtId(c, points);
    for (vtkIdType k = 0; k + 2 < points->GetNumberOfIds(); ++k) {
      const vtkIdType turned = k % 2;  // 1 for every second triangle of a strip, which has the opposite winding
      for (const vtkIdType i : {k + turned, k + 1 - turned, k + 2}) corners.push_back(number(points->GetId(i)));
      end_face(cell);
    }
  }
  Result<Topology> topology =
      Topology::polygons(size(mesh->GetNumberOfPoints()), std::move(offsets), std::move(corners));
  return {std::move(topology).value(), std::move(cells)};
}

// Evaluates eq. 5 of docs/theory.md in double, for positions that are not in float. The edges e(t), f(t) of each
// triangle of the fan have the cross product (1-t)^2 e0 x f0 + t(1-t) (e0 x f1 + e1 x f0) + t^2 e1 x f1.
ControlNormals control_normals_in_double(vtkPolyData* from, vtkPolyData* to, std::span<const std::uint32_t> face) {
  struct Edge {
    Vec3d from, to;
  };
  const auto position = [](vtkPolyData* mesh, vtkIdType p) {
    std::array<double, 3> x{};
    mesh->GetPoint(p, x.data());
    return Vec3d{x[0], x[1], x[2]};
  };
  const auto point = [&](std::size_t c) { return Edge{position(from, face[c]), position(to, face[c])}; };
  const Edge origin = point(0);
  CrossSum n0, m, n1;
  for_fan(
      face.size(),
      [&](std::size_t c) {
        const Edge place = point(c);
        return Edge{place.from - origin.from, place.to - origin.to};
      },
      [&](const Edge& e, const Edge& f) {
        n0.add(e.from, f.from);
        m.add(e.from, f.to);
        m.add(e.to, f.from);
        n1.add(e.to, f.to);
      });
  return {n0.without_rounding(), 0.5 * m.without_rounding(), n1.without_rounding()};
}

std::vector<ControlNormals> normals_of_faces(vtkPolyData* from, vtkPolyData* to, const Topology& topology) {
  const std::size_t points = topology.vertex_count(), faces = topology.face_count();
  if (faces == 0) return {};
  vtkFloatArray* const before = vtkFloatArray::SafeDownCast(from->GetPoints()->GetData());
  vtkFloatArray* const after = vtkFloatArray::SafeDownCast(to->GetPoints()->GetData());
  if (before != nullptr && after != nullptr) {
    Segment segment;
    segment.topology = &topology;
    segment.from = VectorView<const float>::packed(before->GetPointer(0), points);
    segment.to = VectorView<const float>::packed(after->GetPointer(0), points);
    return all_face_control_normals(segment);
  }
  std::vector<ControlNormals> result(faces);
  for_elements(faces, [&](std::size_t f) { result[f] = control_normals_in_double(from, to, topology.face(f)); });
  return result;
}

// Adds the terms in the order of their values, so that the sum does not depend on the order of the faces in a mesh or
// in a piece of the mesh.
ControlNormals sum_of(std::vector<ControlNormals>& terms) {
  const auto values = [](const ControlNormals& n) {
    return std::tie(n.n0.x, n.n0.y, n.n0.z, n.m.x, n.m.y, n.m.z, n.n1.x, n.n1.y, n.n1.z);
  };
  std::sort(terms.begin(), terms.end(),
            [&](const ControlNormals& a, const ControlNormals& b) { return values(a) < values(b); });
  ControlNormalsSum sum;
  for (const ControlNormals& term : terms) sum.add(term);
  return sum.without_rounding();
}

// Vectors in an array of VTK, whose numbers are double if in_double is true, otherwise float.
struct Vectors {
  Vectors(std::size_t count, bool in_double)
      : array(vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(in_double ? VTK_DOUBLE : VTK_FLOAT))) {
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(static_cast<vtkIdType>(count));
  }
  void set(std::size_t i, const Vec3d& v) const {
    const std::array values = {v.x, v.y, v.z};
    array->SetTuple(static_cast<vtkIdType>(i), values.data());
  }

  vtkSmartPointer<vtkDataArray> array;
};

// For each element, which is a point or a cell, the faces whose control normals add up to the control normals of the
// element.
struct Groups {
  // Collects the faces of each element. for_pairs(body) is called twice, and must call body(element, face) for each
  // face of each element, in the same order both times.
  template <class ForPairs>
  Groups(std::size_t elements, const ForPairs& for_pairs) : ends(elements + 1, 0) {
    // Sorts by counting: ends[e + 1] first counts the faces of element e. Then ends[e] is the index of the first face
    // of e, and at last the index after its last face.
    for_pairs([this](std::size_t element, std::size_t) { ++ends[element + 1]; });
    for (std::size_t e = 0; e < elements; ++e) ends[e + 1] += ends[e];
    faces.resize(ends.back());
    for_pairs(
        [this](std::size_t element, std::size_t face) { faces[ends[element]++] = static_cast<std::uint32_t>(face); });
  }

  [[nodiscard]] std::size_t size() const { return ends.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t e) const {
    const std::size_t first = e == 0 ? 0 : ends[e - 1];
    return std::span(faces).subspan(first, ends[e] - first);
  }

  std::vector<std::uint32_t> ends, faces;
};

vtkSmartPointer<vtkDataArray> normals_of_groups(const Groups& groups, const std::vector<ControlNormals>& of_faces,
                                                double t, bool in_double) {
  const Vectors result(groups.size(), in_double);
  for_elements(groups.size(), [&](std::size_t e) {
    thread_local std::vector<ControlNormals> terms;
    terms.clear();
    for (const std::uint32_t f : groups.of(e)) terms.push_back(of_faces[f]);
    result.set(e, unit_normal_at(sum_of(terms), t).vector);
  });
  return result.array;
}

bool is_in_double(vtkPolyData* mesh) {
  return mesh->GetPoints() != nullptr && mesh->GetPoints()->GetDataType() == VTK_DOUBLE;
}

// Returns the normals of points, of cells or of both. The normals are in double if in_double is true, otherwise in
// float.
MeshNormals normals_of(vtkPolyData* from, vtkPolyData* to, double t, bool points, bool cells, bool in_double) {
  const Faces faces = find_faces(from);
  const Topology& topology = faces.topology;
  const std::vector<ControlNormals> of_faces = normals_of_faces(from, to, topology);
  MeshNormals result;
  if (points) {
    const Groups groups(topology.vertex_count(), [&](const auto& body) {
      for (std::size_t f = 0; f < topology.face_count(); ++f)
        for (const std::uint32_t point : topology.face(f)) body(point, f);
    });
    result.of_points = normals_of_groups(groups, of_faces, t, in_double);
  }
  if (cells) {
    const Groups groups(size(from->GetNumberOfCells()), [&](const auto& body) {
      for (std::size_t f = 0; f < faces.cells.size(); ++f) body(faces.cells[f], f);
    });
    result.of_cells = normals_of_groups(groups, of_faces, t, in_double);
  }
  return result;
}

}  // namespace

Status check_motion(vtkPolyData* from, vtkPolyData* to) {
  const vtkIdType points = from->GetNumberOfPoints();
  if (points != to->GetNumberOfPoints())
    return invalid_input("", "the two steps have " + std::to_string(points) + " and " +
                                 std::to_string(to->GetNumberOfPoints()) + " points");
  vtkIdType corners = 0;
  for (vtkCellArray* const list : cell_lists(from)) corners += 3 * list->GetNumberOfConnectivityIds();
  if (size(std::max(points, corners)) > std::numeric_limits<std::uint32_t>::max())
    return invalid_input("", "the mesh has more points or corners than 32 bits can count");
  if (Status cells = check_cells(from, to); !cells) return cells;
  if (Status before = check_positions(from); !before) return before;
  return check_positions(to);
}

MeshNormals normals_between(vtkPolyData* from, vtkPolyData* to, double t, bool points, bool cells) {
  return normals_of(from, to, t, points, cells, is_in_double(from));
}

MeshNormals normals_on_curves(vtkPolyData* mesh, const PointCurves& curves, double t, bool points, bool cells) {
  vtkNew<vtkPolyData> placed;
  placed->ShallowCopy(mesh);
  placed->SetPoints(points_at(curves, t, VTK_DOUBLE));
  return normals_of(placed, placed, 0, points, cells, is_in_double(mesh));
}

}  // namespace chronormal::vtk
