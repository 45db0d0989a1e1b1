// Makes the cases of chronormal's own functions: the call to be timed, and the check of its result.
#include "paths/ours.h"

#include <memory>
#include <optional>
#include <vector>

#include "chronormal/normals/float_recompute.h"
#include "chronormal/normals/normal_curves.h"
#include "memory/bare_loop.h"
#include "normals/recompute/recompute.h"

namespace chronormal::bench {
namespace {

// The error bounds in radians that normals/normal_curves.h promises.
constexpr double kOctahedralError = 7e-5, kRgb10A2Error = 1.7e-3;
// A case that evaluates many t is left out if its results would take more bytes than this.
constexpr std::size_t kManyTimesBytes = std::size_t{3} << 30;

Vector to_vector(const Vec3f& v) { return {double{v.x}, double{v.y}, double{v.z}}; }

// The data that the cases of one mesh share. Curves are made when a case asks for them.
struct Shared {
  Segment segment;
  const NormalGroups* groups = nullptr;
  std::size_t count = 0;

  [[nodiscard]] NormalCurves prepared(double tolerance, Threads threads = Threads::kOne,
                                      NormalCurves* reuse = nullptr) const {
    const CurveOptions options{tolerance};
    return groups == nullptr ? NormalCurves::of_faces(segment, options, threads, reuse)
                             : NormalCurves::of_groups(segment, *groups, options, threads, reuse);
  }
  [[nodiscard]] const NormalCurves& curves(double tolerance) {
    std::optional<NormalCurves>& kept = tolerance == kExactTolerance ? exact_ : compact_;
    if (!kept) kept = prepared(tolerance, Threads::kAll);
    return *kept;
  }
  // Returns memory for one result: packed vectors, or three planes that each begin at the start of a cache line.
  [[nodiscard]] float* result() {
    if (result_.size() == 0) result_ = AlignedArray<float>(3 * plane_size());
    return result_.data();
  }
  [[nodiscard]] VectorView<float> packed() { return VectorView<float>::packed(result(), count); }
  [[nodiscard]] VectorView<float> planes() {
    return VectorView<float>::planes(result(), result() + plane_size(), result() + 2 * plane_size(), count);
  }
  template <class Encoded>
  [[nodiscard]] std::span<Encoded> encoded() {
    static_assert(sizeof(Encoded) == sizeof(float));
    return {reinterpret_cast<Encoded*>(result()), count};
  }

 private:
  [[nodiscard]] std::size_t plane_size() const { return (count + 15) / 16 * 16; }

  std::optional<NormalCurves> exact_, compact_;
  AlignedArray<float> result_;
};

using SharedPointer = std::shared_ptr<Shared>;

Case recompute_case(const SharedPointer& shared, std::size_t bytes, Threads threads) {
  auto rival = shared->groups == nullptr ? std::make_shared<NormalRecompute>(shared->segment)
                                         : std::make_shared<NormalRecompute>(shared->segment, *shared->groups);
  Case one;
  one.run = [shared, rival, threads] { (void)rival->unit_normals(double{kTime}, shared->packed(), threads); };
  one.checks = {packed_check(double{kTime}, shared->result())};
  one.limit = kExactTolerance;
  if (bytes != 0) one.bytes_read = bytes, one.bytes_written = 12 * shared->count;
  return one;
}

// Makes the case of normals from positions in float32, with a limit in radians. Float32 rounds positions relative to
// the size of the whole mesh. In a mesh of more elements the edges are shorter, so the error of a normal is larger, and
// the limit grows. An element without a normal in float32 gets (0, 0, 0), and the oracle leaves out such an element.
Case float_case(const SharedPointer& shared, std::size_t bytes, double limit, Threads threads) {
  const Topology& topology = *shared->segment.topology;
  auto rival = shared->groups == nullptr ? std::make_shared<FloatRecompute>(topology)
                                         : std::make_shared<FloatRecompute>(topology, *shared->groups);
  Case one;
  one.run = [shared, rival, threads] {
    (void)rival->unit_normals(shared->segment, double{kTime}, shared->packed(), threads);
  };
  one.checks = {packed_check(double{kTime}, shared->result())};
  one.limit = limit;
  if (bytes != 0) one.bytes_read = bytes, one.bytes_written = 12 * shared->count;
  return one;
}

Case prepare_case(const SharedPointer& shared, double tolerance, Threads threads) {
  auto made = std::make_shared<NormalCurves>();
  Case one;
  one.run = [shared, made, tolerance, threads] {
    // The memory of the previous segment is reused, as in a program that prepares one segment after the other.
    *made = shared->prepared(tolerance, threads, made.get());
  };
  auto evaluated = std::make_shared<std::vector<float>>();
  const auto normal_of = [shared, made, evaluated](std::size_t element) {
    if (evaluated->empty()) {
      evaluated->resize(3 * shared->count);
      (void)made->unit_normals(double{kTime}, VectorView<float>::packed(evaluated->data(), shared->count));
    }
    const float* const n = evaluated->data() + 3 * element;
    return Vector{double{n[0]}, double{n[1]}, double{n[2]}};
  };
  one.checks = {{double{kTime}, normal_of, {}}};
  one.limit = tolerance;
  return one;
}

Case planes_case(const SharedPointer& shared, double tolerance) {
  const NormalCurves& curves = shared->curves(tolerance);
  Case one;
  one.run = [shared, &curves] { (void)curves.unit_normals(double{kTime}, shared->planes()); };
  one.checks = {{double{kTime}, [shared](std::size_t element) { return to_vector(shared->planes()[element]); }, {}}};
  one.limit = tolerance;
  one.bytes_read = curves.bytes(), one.bytes_written = 12 * shared->count;
  return one;
}

Case packed_case(const SharedPointer& shared, double tolerance, Threads threads) {
  const NormalCurves& curves = shared->curves(tolerance);
  Case one;
  one.run = [shared, &curves, threads] { (void)curves.unit_normals(double{kTime}, shared->packed(), threads); };
  one.checks = {packed_check(double{kTime}, shared->result())};
  one.limit = tolerance;
  one.bytes_read = curves.bytes(), one.bytes_written = 12 * shared->count;
  return one;
}

template <class Encoded>
Case encoded_case(const SharedPointer& shared, double tolerance, double encoding_error) {
  const NormalCurves& curves = shared->curves(tolerance);
  Case one;
  one.run = [shared, &curves] { (void)curves.unit_normals(double{kTime}, shared->encoded<Encoded>()); };
  one.checks = {{double{kTime},
                 [shared](std::size_t element) { return to_vector(decode(shared->encoded<Encoded>()[element])); },
                 {}}};
  one.limit = tolerance + encoding_error;
  one.bytes_read = curves.bytes(), one.bytes_written = 4 * shared->count;
  return one;
}

// Makes a case that evaluates many t in one call, and writes the normals at each t to a separate array.
Case many_times_case(const SharedPointer& shared, double tolerance, std::size_t evaluations, Threads threads) {
  struct Many {
    std::vector<AlignedArray<float>> arrays;
    std::vector<double> times;
    std::vector<VectorView<float>> results;
  };
  const NormalCurves& curves = shared->curves(tolerance);
  auto many = std::make_shared<Many>();
  for (std::size_t k = 0; k < evaluations; ++k) {
    many->arrays.emplace_back(3 * shared->count);
    many->times.push_back((static_cast<double>(k) + 0.5) / static_cast<double>(evaluations));
    many->results.push_back(VectorView<float>::packed(many->arrays.back().data(), shared->count));
  }
  Case one;
  one.evaluations = evaluations;
  one.run = [many, &curves, shared, threads] { (void)curves.unit_normals(many->times, many->results, threads); };
  for (const std::size_t k : {std::size_t{0}, evaluations / 2, evaluations - 1})
    one.checks.push_back(
        {many->times[k], [many, k](std::size_t element) { return to_vector(many->results[k][element]); }, {}});
  one.limit = tolerance;
  one.bytes_read = curves.bytes(), one.bytes_written = 12 * shared->count * evaluations;
  return one;
}

Case bare_case(BareLoop::Reads reads, std::size_t count, std::size_t evaluations, Threads threads) {
  Case one;
  one.evaluations = evaluations;
  one.run = [loop = std::make_shared<BareLoop>(reads, count * evaluations, threads)] { loop->run(); };
  one.note = "no normals";
  return one;
}

}  // namespace

Check packed_check(double t, const float* normals) {
  return {t,
          [normals](std::size_t element) {
            const float* const n = normals + 3 * element;
            return Vector{double{n[0]}, double{n[1]}, double{n[2]}};
          },
          {}};
}

void add_ours(CaseList& list, const Segment& segment, const NormalGroups* groups, std::size_t recompute_bytes,
              double float_limit) {
  const auto shared = std::make_shared<Shared>();
  shared->segment = segment;
  shared->groups = groups;
  shared->count = groups == nullptr ? segment.topology->face_count() : groups->size();
  const std::size_t threads = list.suite().options().threads;

  struct Form {
    const char* name;
    double tolerance;
  };
  constexpr Form kForms[] = {{"exact", kExactTolerance}, {"compact", kCompactTolerance}};
  for (const std::size_t count : {std::size_t{1}, threads}) {
    const Threads mode = count == 1 ? Threads::kOne : Threads::kAll;
    const std::string suffix = count == 1 ? "" : ", " + std::to_string(count) + " threads";
    const auto add = [&](const std::string& name, const auto& make) {
      list.add(name + suffix, [&] {
        Case one = make();
        one.threads = count;
        return one;
      });
    };
    add("recompute", [&] { return recompute_case(shared, recompute_bytes, mode); });
    add("recompute in float32", [&] { return float_case(shared, recompute_bytes, float_limit, mode); });
    for (const Form& form : kForms) {
      add(std::string("prepare ") + form.name, [&] { return prepare_case(shared, form.tolerance, mode); });
      add(std::string(form.name) + " to float3", [&] { return packed_case(shared, form.tolerance, mode); });
    }
    add("bare loop as exact", [&] { return bare_case(BareLoop::Reads::kExact, shared->count, 1, mode); });
    add("bare loop as compact", [&] { return bare_case(BareLoop::Reads::kCompact, shared->count, 1, mode); });
    if (threads == 1) break;
  }
  list.add("exact to planes", [&] { return planes_case(shared, kExactTolerance); });
  for (const Form& form : kForms)
    list.add(std::string(form.name) + " to octahedral",
             [&] { return encoded_case<Octahedral>(shared, form.tolerance, kOctahedralError); });
  list.add("exact to rgb10a2", [&] { return encoded_case<Rgb10A2>(shared, kExactTolerance, kRgb10A2Error); });
  for (const std::size_t evaluations : {std::size_t{8}, std::size_t{64}}) {
    if (12 * shared->count * evaluations > kManyTimesBytes) continue;
    const std::string suffix = ", " + std::to_string(evaluations) + " t";
    for (const Form& form : kForms)
      list.add(std::string(form.name) + " to float3" + suffix,
               [&] { return many_times_case(shared, form.tolerance, evaluations, Threads::kOne); });
    list.add("bare loop that writes" + suffix,
             [&] { return bare_case(BareLoop::Reads::kNothing, shared->count, evaluations, Threads::kOne); });
  }
}

}  // namespace chronormal::bench
