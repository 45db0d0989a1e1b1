#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <thread>
#include <utility>
#include <vector>

#include "chronormal/chronormal.h"

// Shows the frame loop of an engine: a flag has 24 keyframes per second (four in all), and is shown 60 times per
// second. Eight jobs write the normals of a frame, each for a range of vertices, while another job prepares the next
// segment. Then a slider changes the shape of the flag.
namespace {

using namespace chronormal;

constexpr std::uint32_t kCells = 200, kRow = kCells + 1;
constexpr std::size_t kJobs = 8;

std::vector<float> flag(double phase) {
  std::vector<float> xyz;
  for (std::uint32_t y = 0; y < kRow; ++y) {
    for (std::uint32_t x = 0; x < kRow; ++x) {
      const double u = x / double{kCells}, v = y / double{kCells};
      xyz.insert(xyz.end(), {static_cast<float>(u), static_cast<float>(v),
                             static_cast<float>(0.2 * u * std::sin(9 * u + 2 * v - phase))});
    }
  }
  return xyz;
}

std::vector<std::uint32_t> triangles() {
  std::vector<std::uint32_t> corners;
  for (std::uint32_t y = 0; y < kCells; ++y) {
    for (std::uint32_t x = 0; x < kCells; ++x) {
      const std::uint32_t a = y * kRow + x, b = a + kRow;
      corners.insert(corners.end(), {a, a + 1, b + 1, a, b + 1, b});
    }
  }
  return corners;
}

// Stands in for the job system of an engine. Each job is a thread here.
template <class Job>
void run_jobs(const Job& job) {
  std::vector<std::thread> threads;
  for (std::size_t j = 0; j < kJobs; ++j) threads.emplace_back(job, j);
  for (std::thread& thread : threads) thread.join();
}

IndexRange share_of(std::size_t job, std::size_t size) {
  const std::size_t first = size * job / kJobs;
  return {first, size * (job + 1) / kJobs - first};
}

}  // namespace

int main() {
  std::vector<std::vector<float>> keyframes;
  for (int k = 0; k < 4; ++k) keyframes.push_back(flag(0.7 * k));
  const auto at = [&](std::size_t k) { return VectorView<const float>::packed(keyframes[k]); };

  // Prepare once. A twentieth of a degree is enough for shading.
  const Topology topology = Topology::triangles(kRow * kRow, triangles()).value();
  MeshNormals normals = MeshNormals::make(topology, {.tolerance = kCompactTolerance}).value();
  if (!normals.set_segment(at(0), at(1))) return 1;

  // The engine's vertex buffer has position and normal side by side, 24 bytes per vertex.
  std::vector<float> buffer(6 * normals.size());
  const auto in_buffer = VectorView<float>::strided(buffer.data() + 3, normals.size(), 24);
  std::size_t segment = 0;
  double largest = 0;
  std::printf("frame  segment     t  without a normal\n");
  for (int frame = 0; frame < 8; ++frame) {
    const double time = frame * 24.0 / 60;  // the time in keyframes
    if (time >= static_cast<double>(segment + 1)) {
      normals.finish_segment();
      ++segment;
    }
    if (time - static_cast<double>(segment) < 24.0 / 60 && segment + 2 < keyframes.size()) {
      if (!normals.begin_segment(at(segment + 1), at(segment + 2))) return 1;
    }
    const double t = time - static_cast<double>(segment);
    std::atomic<std::size_t> zeros = 0;
    run_jobs([&](std::size_t job) {
      if (job == 0) (void)normals.prepare(0.4);  // a segment has 2.5 frames, so 0.4 of the work is due in each
      zeros += normals.unit_normals(t, in_buffer, share_of(job, normals.size()));
    });
    std::printf("%5d %8zu  %.2f %17zu\n", frame, segment, t, zeros.load());

    // Check that the jobs wrote the same normals as one call for all vertices.
    std::vector<float> whole(3 * normals.size());
    normals.unit_normals(t, VectorView<float>::packed(whole));
    for (std::size_t i = 0; i < normals.size(); ++i)
      if (VectorView<float>::packed(whole)[i] != in_buffer[i]) return 1;
  }

  // Make a slider rig of the flag at rest and one morph target. The weights are set once per frame. After that, any
  // thread may write a range of normals.
  std::vector<float> deltas(keyframes[0].size());
  for (std::size_t i = 0; i < deltas.size(); ++i) deltas[i] = keyframes[2][i] - keyframes[0][i];
  if (!normals.set_targets({topology, keyframes[0], {BlendTarget::from_dense(deltas, "blow")}})) return 1;
  std::printf("\nslider  normal of the last vertex\n");
  for (const double slider : {0.0, 0.5, 1.0}) {
    normals.set_weights({&slider, 1});
    run_jobs([&](std::size_t job) { normals.unit_normals(in_buffer, share_of(job, normals.size())); });
    const Vec3f n = in_buffer[normals.size() - 1];
    std::printf("%6.1f  (%.3f, %.3f, %.3f)\n", slider, double{n.x}, double{n.y}, double{n.z});
    largest = std::max(largest, std::fabs(length(to_double(n)) - 1));
  }
  return largest < 1e-6 ? 0 : 1;
}
