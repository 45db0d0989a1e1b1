// Tests that the normals at t always have the same bytes. The bytes must not depend on other times that are requested
// before, after or together with t, on the instruction set, on the number of threads, or on the way to compute normals;
// the C interface is one of these ways. The meshes are random and hard, and the true normals are computed from integers
// of any size.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/mesh_normals.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal_c.h"
#include "io/mesh/obj.h"
#include "normals/blend/blend_normals.h"
#include "normals/recompute/recompute.h"
#include "simd/targets.h"
#include "tests/support/blend_oracle.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"
#include "tests/support/large_polygons.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::times_test {
namespace {

using fixtures::Random;
using test::IntegerNormals;
using test::IntegerTime;
using test::IntegerVector;

using Normals = std::vector<float>;

// A way to compute the normals of some elements of a segment. The function returns the normals at each of the given
// times, in the same order.
using Way = std::function<std::vector<Normals>(const std::vector<double>& times)>;

struct NamedWay {
  std::string name;
  std::function<Way()> make;  // prepares the way anew
};

// The elements of a mesh whose normals are computed: its faces, vertices or corners.
struct Elements {
  chronormal_elements kind;
  const NormalGroups* groups;  // nullptr for faces
  double crease_angle;         // in degrees, for corners
};

// A group of ways that must all give the same bytes, and whose normals must have errors within `tolerance`.
struct Kin {
  double tolerance;  // in radians; infinite if these normals are not compared with true normals
  std::vector<NamedWay> ways;
};

template <class Object>
Way one_by_one(Object made, Threads threads) {
  const auto object = std::make_shared<Object>(std::move(made));
  return [object, threads](const std::vector<double>& times) {
    std::vector<Normals> results(times.size(), Normals(3 * object->size()));
    for (std::size_t i = 0; i < times.size(); ++i)
      object->unit_normals(times[i], VectorView<float>::packed(results[i].data(), object->size()), threads);
    return results;
  };
}

Way all_together(NormalCurves made, Threads threads) {
  const auto curves = std::make_shared<NormalCurves>(std::move(made));
  return [curves, threads](const std::vector<double>& times) {
    std::vector<Normals> results(times.size(), Normals(3 * curves->size()));
    std::vector<VectorView<float>> views;
    for (Normals& normals : results) views.push_back(VectorView<float>::packed(normals.data(), curves->size()));
    curves->unit_normals(times, views, threads);
    return results;
  };
}

// Makes a way that blends shapes with one target, whose weight is t.
Way blended(BlendNormals made, Threads threads) {
  const auto normals = std::make_shared<BlendNormals>(std::move(made));
  return [=](const std::vector<double>& times) {
    std::vector<Normals> results(times.size(), Normals(3 * normals->size()));
    for (std::size_t i = 0; i < times.size(); ++i)
      normals->unit_normals({&times[i], 1}, VectorView<float>::packed(results[i]), threads);
    return results;
  };
}

// ---- the C interface -----------------------------------------------------------------------------------------------

void expect_done(chronormal_status status) {
  if (status != CHRONORMAL_DONE) throw std::runtime_error(chronormal_last_message());
}

// A mesh and its positions at both ends of a segment, in the types of the C interface, together with the options for
// some elements.
struct MeshInC {
  std::vector<std::uint32_t> offsets{0};
  chronormal_mesh mesh;
  chronormal_vectors from, to;
  chronormal_options options;

  MeshInC(const Motion& motion, const Elements& elements, double tolerance, Threads threads) {
    const Topology& topology = motion.topology;
    for (std::size_t f = 0; f < topology.face_count(); ++f)
      offsets.push_back(offsets.back() + static_cast<std::uint32_t>(topology.face(f).size()));
    mesh = {topology.vertex_count(), topology.face_count(), topology.corners().data(), offsets.data()};
    from = {motion.keyframes[0].positions.data(), 0};
    to = {motion.keyframes[1].positions.data(), 0};
    chronormal_options_init(&options);
    options.elements = elements.kind;
    options.separate = 1;
    options.crease_angle = elements.crease_angle;
    options.tolerance = tolerance;
    options.all_threads = threads == Threads::kAll ? 1 : 0;
  }
};

// Makes a way from a function of the C interface. write(t, where) must write the normals of `size` elements at the time
// t.
template <class Write>
Way written_in_c(std::size_t size, Write write) {
  return [=](const std::vector<double>& times) {
    std::vector<Normals> results(times.size(), Normals(3 * size));
    for (std::size_t i = 0; i < times.size(); ++i)
      expect_done(write(times[i], chronormal_result{results[i].data(), 0}));
    return results;
  };
}

// Makes a way from curves of the C interface. If is_next, first makes curves for vertices that stay at `from`, and then
// prepares the segment as the next segment of these curves.
Way curves_in_c(const MeshInC& in, bool is_next) {
  chronormal_curves* made = nullptr;
  expect_done(chronormal_curves_create(&in.mesh, in.from, is_next ? in.from : in.to, &in.options, &made));
  const std::shared_ptr<chronormal_curves> curves(made, chronormal_curves_destroy);
  if (is_next) expect_done(chronormal_curves_next(made, in.from, in.to));
  return written_in_c(chronormal_curves_size(made), [curves](double t, chronormal_result result) {
    return chronormal_curves_unit_normals(curves.get(), t, result, nullptr);
  });
}

Way blend_in_c(const MeshInC& in, const std::vector<float>& deltas) {
  chronormal_blend* made = nullptr;
  const chronormal_target target{in.mesh.vertex_count, nullptr, {deltas.data(), 0}};
  expect_done(chronormal_blend_create(&in.mesh, in.from, &target, 1, &in.options, &made));
  const std::shared_ptr<chronormal_blend> blend(made, chronormal_blend_destroy);
  return written_in_c(chronormal_blend_size(made), [blend](double t, chronormal_result result) {
    return chronormal_blend_unit_normals(blend.get(), &t, result, nullptr);
  });
}

Way motion_in_c(const MeshInC& in, const std::shared_ptr<test::TemporaryFolder>& folder,
                const std::vector<std::string>& files, const char* path) {
  chronormal_motion* made = nullptr;
  const std::vector<const char*> names{files[0].c_str(), files[1].c_str()};
  expect_done(chronormal_motion_read(names.data(), names.size(), &in.options, &made));
  const std::shared_ptr<chronormal_motion> motion(made, chronormal_motion_destroy);
  expect_done(chronormal_motion_follow(made, path));
  return written_in_c(chronormal_motion_size(made), [motion, folder](double t, chronormal_result result) {
    return chronormal_motion_unit_normals(motion.get(), t, result);
  });
}

MeshNormals mesh_normals(const Motion& motion, const Elements& elements, double tolerance, bool in_slices) {
  MeshNormalsOptions options;
  options.elements = {static_cast<ElementKind>(elements.kind), false, elements.crease_angle};
  options.tolerance = tolerance;
  MeshNormals normals = MeshNormals::make(motion.topology, options).value();
  const Segment segment = motion.segment(0);
  if (!in_slices) {
    EXPECT_TRUE(normals.set_segment(segment));
    return normals;
  }
  EXPECT_TRUE(normals.begin_segment(segment.from, segment.to));
  while (!normals.prepare(0.3)) {
  }
  normals.finish_segment();
  return normals;
}

// Adds ways of MeshNormals and of the C interface. If C and C++ have the same elements, adds the ways to `curves`,
// which has the ways of C++. Otherwise, adds the ways to `all` as a separate group.
void add_ways_of_outputs(const Motion& motion, const Elements& elements, double tolerance, Kin& curves,
                         std::vector<Kin>& all) {
  Kin own{std::numeric_limits<double>::infinity(), {}};  // in C, each corner has its own normal
  Kin& kin = elements.kind == CHRONORMAL_CORNERS ? own : curves;
  for (const bool in_slices : {false, true})
    kin.ways.push_back({"the normals of a mesh", [=, &motion] {
                          return one_by_one(mesh_normals(motion, elements, tolerance, in_slices), Threads::kOne);
                        }});
  for (const Threads threads : {Threads::kOne, Threads::kAll}) {
    for (const bool is_next : {false, true}) {
      kin.ways.push_back({is_next ? "the next curves in C" : "curves in C", [=, &motion] {
                            return curves_in_c(MeshInC(motion, elements, tolerance, threads), is_next);
                          }});
    }
  }
  if (!own.ways.empty()) all.push_back(std::move(own));
}

// Adds the ways to compute normals in C that blend targets or read files.
void add_files_and_blends_of_c(const Motion& motion, const Elements& elements, std::vector<Kin>& all) {
  constexpr double kNotJudged = std::numeric_limits<double>::infinity();
  std::vector<float> deltas = motion.keyframes[1].positions;
  for (std::size_t i = 0; i < deltas.size(); ++i) deltas[i] -= motion.keyframes[0].positions[i];
  Kin& blend = all.emplace_back(Kin{kNotJudged, {}});
  for (const Threads threads : {Threads::kOne, Threads::kAll}) {
    blend.ways.push_back({"blend shapes in C", [=, &motion] {
                            return blend_in_c(MeshInC(motion, elements, kExactTolerance, threads), deltas);
                          }});
  }
  const auto folder = std::make_shared<test::TemporaryFolder>();
  std::vector<std::string> files;
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    const auto positions = VectorView<const float>::packed(keyframe.positions.data(), motion.topology.vertex_count());
    files.push_back(folder->write(std::to_string(files.size()) + ".obj", write_obj(motion.topology, positions)));
  }
  const double judged = elements.kind == CHRONORMAL_CORNERS ? kNotJudged : kExactTolerance;
  for (const char* const path : {"linear", "catmull-rom"}) {
    const bool is_linear = path[0] == 'l';
    Kin& kin = all.emplace_back(Kin{is_linear ? judged : kNotJudged, {}});
    kin.ways.push_back({std::string("files in C, ") + path, [=, &motion] {
                          return motion_in_c(MeshInC(motion, elements, kExactTolerance, Threads::kOne), folder, files,
                                             path);
                        }});
  }
}

// Adds ways that blend a target, whose deltas are differences of positions in float32.
void add_other_ways(const Motion& motion, const NormalGroups* groups, std::vector<Kin>& all) {
  constexpr double kNotJudged = std::numeric_limits<double>::infinity();
  Motion targets = motion;
  targets.connect_as_targets();
  const auto set = std::make_shared<BlendSet>(blend_set_of(targets).value());
  for (const BlendPath forced : {BlendPath::kTerms, BlendPath::kTouched, BlendPath::kWhole}) {
    const BlendNormalsOptions options{.forced = forced};
    Kin& blend = all.emplace_back(Kin{kNotJudged, {}});
    for (const Threads threads : {Threads::kOne, Threads::kAll}) {
      blend.ways.push_back({"blend shapes by " + std::string(test::name_of(forced)), [=] {
                              return blended(groups == nullptr ? BlendNormals::of_faces(*set, options)
                                                               : BlendNormals::of_groups(*set, *groups, options),
                                             threads);
                            }});
    }
  }
}

std::vector<Kin> all_ways(const Motion& motion, const Segment& segment, const Elements& elements) {
  const NormalGroups* const groups = elements.groups;
  std::vector<Kin> all;
  for (const double tolerance : {kExactTolerance, kCompactTolerance, 5e-3}) {
    const CurveOptions options{tolerance};
    const auto made = [=, &segment](Threads threads) {
      return groups == nullptr ? NormalCurves::of_faces(segment, options, threads)
                               : NormalCurves::of_groups(segment, *groups, options, threads);
    };
    Kin kin{tolerance, {}};
    for (const Threads threads : {Threads::kOne, Threads::kAll}) {
      kin.ways.push_back({"curves", [=] { return one_by_one(made(threads), threads); }});
      kin.ways.push_back({"curves, all times together", [=] { return all_together(made(threads), threads); }});
    }
    add_ways_of_outputs(motion, elements, tolerance, kin, all);
    all.push_back(std::move(kin));
  }
  Kin& anew = all.emplace_back(Kin{kExactTolerance, {}});
  for (const Threads threads : {Threads::kOne, Threads::kAll}) {
    anew.ways.push_back(
        {"made anew", [=, &segment] {
           return one_by_one(groups == nullptr ? NormalRecompute(segment) : NormalRecompute(segment, *groups), threads);
         }});
  }
  add_other_ways(motion, groups, all);
  add_files_and_blends_of_c(motion, elements, all);
  return all;
}

// Checks that one way gives the same bytes for any choice of times. `expected` has the normals at each of `times`. If
// `expected` is empty, fills it with the results of this way. Describes the first fault, or returns "".
std::string fault_in_bytes(const NamedWay& way, const std::vector<double>& times, Random& random,
                           std::vector<Normals>& expected) {
  const auto same = [](const Normals& a, const Normals& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
  };
  // First, a new object computes the normals at each time alone.
  std::vector<Normals> alone;
  for (const double t : times) alone.push_back(way.make()({t})[0]);
  if (expected.empty()) expected = alone;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!same(alone[i], expected[i])) return way.name + ": other bytes at t = " + std::to_string(times[i]);
  }
  // Then, a single object computes two times together, and after that all times in random order.
  std::vector<std::size_t> order(times.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  const Way kept = way.make();
  for (const std::size_t count : {std::size_t{2}, order.size()}) {
    std::vector<double> asked;
    for (std::size_t i = 0; i < count; ++i) asked.push_back(times[order[i]]);
    const std::vector<Normals> found = kept(asked);
    for (std::size_t i = 0; i < count; ++i) {
      if (!same(found[i], expected[order[i]]))
        return way.name + ": other bytes among " + std::to_string(count) + " times at t = " + std::to_string(asked[i]);
    }
  }
  return "";
}

// Compares the normals of all elements at all times with true normals that are computed in integers. Describes the
// first fault, or returns "".
std::string fault_in_directions(double tolerance, const std::vector<double>& times, const std::vector<Normals>& found,
                                const IntegerNormals& oracle, const NormalGroups* groups) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    const IntegerTime time = IntegerTime::of(times[i]);
    const std::vector<IntegerVector> here = oracle.at(time), beside = oracle.at(time.moved(times[i] == 0 ? 1 : -1));
    for (std::size_t e = 0; e < found[i].size() / 3; ++e) {
      const auto of_element = [&](const std::vector<IntegerVector>& of_faces) {
        return groups == nullptr ? of_faces[e] : test::sum_of(of_faces, groups->faces(e));
      };
      IntegerVector n = of_element(here);
      if (test::is_zero(n)) n = of_element(beside);
      const Vec3f u{found[i][3 * e], found[i][3 * e + 1], found[i][3 * e + 2]};
      const double angle = test::is_zero(n) ? 0 : test::angle_between(u, test::direction_of(n));
      const bool is_right = test::is_zero(n) ? u.x == 0 && u.y == 0 && u.z == 0 : angle <= tolerance;
      if (!is_right)
        return "element " + std::to_string(e) + " at t = " + std::to_string(times[i]) + " is off by " +
               std::to_string(angle) + " rad";
    }
  }
  return "";
}

std::string fault_of(const Motion& motion, const Elements& elements, Random& random) {
  const Segment segment = motion.segment(0);
  const IntegerNormals oracle(segment);
  const std::vector<double> times{0, 1, random.uniform(0, 1), 0.5};
  for (const Kin& kin : all_ways(motion, segment, elements)) {
    std::vector<Normals> expected;
    for (const std::int64_t target : supported_targets()) {
      const ScopedTarget scoped(target);
      const ThreadLimit limit(1 + random.below(4));
      for (const NamedWay& way : kin.ways) {
        const std::string fault = fault_in_bytes(way, times, random, expected);
        if (!fault.empty()) return fault + " on " + target_name(target);
      }
    }
    if (std::isinf(kin.tolerance)) continue;
    const std::string fault = fault_in_directions(kin.tolerance, times, expected, oracle, elements.groups);
    if (!fault.empty()) return kin.ways[0].name + " to " + std::to_string(kin.tolerance) + ": " + fault;
  }
  return "";
}

TEST(Times, do_not_change_each_others_bytes) {
  constexpr std::uint64_t kSeed = 49001;
  constexpr std::size_t kOfFamily = 3, kOfStars = 40;
  std::vector<test::HardMotions> families = test::hard_motions();
  families.push_back({"large polygons that share their vertices", [](Random& r) {
                        const auto kind = static_cast<test::LargePolygons>(r.below(3));
                        return test::large_polygons(kind, static_cast<std::uint32_t>(60 + r.below(60)), r);
                      }});
  std::size_t wrong = 0, meshes = 0;
  for (std::size_t k = 0; k < families.size(); ++k) {
    Random random(kSeed + k);
    std::size_t wrong_here = 0;
    std::string first;
    const std::size_t count = families[k].make == test::cancelling_star ? kOfStars : kOfFamily;
    for (std::size_t i = 0; i < count; ++i) {
      const Motion motion = families[k].make(random);
      const Points points = separate_points(motion.topology.vertex_count());
      const NormalGroups vertices = NormalGroups::of_vertices(motion.topology, points);
      const double crease = random.uniform(0, 180);
      const NormalGroups corners = NormalGroups::by_crease_angle(motion, points, crease).value();
      for (const Elements& elements : {Elements{CHRONORMAL_FACES, nullptr, 180},
                                       {CHRONORMAL_VERTICES, &vertices, 180},
                                       {CHRONORMAL_CORNERS, &corners, crease}}) {
        const std::string fault = fault_of(motion, elements, random);
        if (fault.empty()) continue;
        if (wrong_here++ == 0) {
          first = std::array{"faces", "vertices", "corners"}[elements.kind];
          first += " of mesh " + std::to_string(i) + ": " + fault;
        }
      }
    }
    std::cout << "  " << families[k].name << ": " << count << " meshes from seed " << kSeed + k << ", " << wrong_here
              << " wrong" << (first.empty() ? "" : ", first: " + first) << '\n';
    EXPECT_EQ(wrong_here, 0u) << first;
    wrong += wrong_here;
    meshes += count;
  }
  std::cout << "  " << meshes << " meshes, " << wrong << " wrong\n";
}

}  // namespace
}  // namespace chronormal::times_test
