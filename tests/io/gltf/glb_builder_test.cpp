// Checks that GlbBuilder writes the same bytes, whether it keeps arrays in memory or on disk.
#include "io/gltf/glb/glb_builder.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace chronormal::glb_builder_test {
namespace {

constexpr std::size_t kVertices = 3000;

std::vector<float> vectors(float first, std::size_t nonzero) {
  std::vector<float> result(3 * kVertices);
  for (std::size_t i = 0; i < nonzero; ++i) result[i] = first + static_cast<float>(i);
  return result;
}

// Adds arrays of every kind: dense arrays, sparse arrays, arrays of zeros, repetitions, and arrays with the same
// numbers and bounds in a different order. Returns the indices of their accessors.
std::vector<std::size_t> add_all(GlbBuilder& builder) {
  std::vector<std::size_t> accessors = {builder.set_triangles(std::vector<std::uint32_t>{0, 1, 2}, kVertices)};
  std::vector<float> dense = vectors(1, 3 * kVertices), sparse = vectors(1, 30);
  for (std::vector<float>* const values : {&dense, &sparse}) std::swap((*values)[9], (*values)[12]);
  for (int time = 0; time < 2; ++time) {
    for (const auto& values : {vectors(1, 3 * kVertices), vectors(1, 30), dense, sparse, vectors(1, 0)})
      accessors.push_back(builder.add_vectors(values, {true, false}));
    accessors.push_back(builder.add_vectors(vectors(1, 30), {false, true}));
    accessors.push_back(builder.add_scalars(std::vector<float>{0, 1, 2}, {true, true}));
  }
  accessors.push_back(builder.add_table(5, 2, [](std::size_t row, std::span<float> values) {
    EXPECT_EQ(values[1], 0);
    values[1] = static_cast<float>(row);
  }));
  return accessors;
}

TEST(GlbBuilder, a_spool_in_a_file_makes_the_same_bytes_as_one_in_memory) {
  const test::TemporaryFolder folder;
  GlbBuilder in_memory;
  GlbBuilder in_file({}, Spool::beside(folder / "out", "out").value());
  EXPECT_EQ(add_all(in_memory), add_all(in_file));
  EXPECT_EQ(in_memory.byte_count(), in_file.byte_count());
  const std::string expected = in_memory.finish().value();
  std::string found;
  const Result<std::size_t> size = in_file.finish([&](std::string_view bytes, std::size_t file_size) -> Status {
    EXPECT_EQ(file_size, expected.size());
    found += bytes;
    return Success{};
  });
  ASSERT_TRUE(size.ok());
  EXPECT_EQ(size.value(), expected.size());
  EXPECT_TRUE(found == expected);
}

TEST(GlbBuilder, an_array_is_stored_once_and_no_other_for_it) {
  const test::TemporaryFolder folder;
  GlbBuilder builder({}, Spool::beside(folder / "out", "out").value());
  const std::vector<std::size_t> accessors = add_all(builder);
  EXPECT_EQ(accessors, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7, 1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST(GlbBuilder, arrays_in_another_order_are_those_that_were_added_in_that_order) {
  const std::vector<std::vector<float>> arrays = {vectors(1, 3 * kVertices), vectors(7, 30), vectors(3, 3 * kVertices),
                                                  vectors(9, 40), vectors(5, 0)};
  const std::vector<std::size_t> order = {3, 1, 5, 2, 4};  // indices of accessors
  GlbBuilder sorted, expected;
  for (GlbBuilder* const builder : {&sorted, &expected})
    (void)builder->set_triangles(std::vector<std::uint32_t>{0, 1, 2}, kVertices);
  for (const std::vector<float>& values : arrays) (void)sorted.add_vectors(values, {true, false});
  for (const std::size_t accessor : order) (void)expected.add_vectors(arrays[accessor - 1], {true, false});
  sorted.put_in_order(order);
  EXPECT_TRUE(sorted.finish().value() == expected.finish().value());
}

TEST(GlbBuilder, a_spool_can_be_used_again) {
  const test::TemporaryFolder folder;
  GlbBuilder first({}, Spool::beside(folder / "out", "out").value()), expected;
  (void)add_all(first);
  (void)first.add_vectors(vectors(77, 3 * kVertices), {true, false});
  Spool spool = std::move(first).take_spool();
  spool.clear();
  GlbBuilder second({}, std::move(spool));
  EXPECT_EQ(add_all(second), add_all(expected));
  EXPECT_TRUE(second.finish().value() == expected.finish().value());
}

TEST(GlbBuilder, a_table_is_what_its_rows_are_one_after_the_other) {
  GlbBuilder of_rows, of_scalars;
  std::vector<float> scalars;
  for (std::size_t i = 0; i < 700000; ++i) scalars.push_back(static_cast<float>(i % 1000));
  (void)of_rows.add_table(1000, 700, [&](std::size_t row, std::span<float> values) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = scalars[row * 700 + i];
  });
  (void)of_scalars.add_scalars(scalars, {false, true});
  EXPECT_TRUE(of_rows.finish().value() == of_scalars.finish().value());
}

TEST(GlbBuilder, a_file_that_may_not_have_so_many_bytes_gives_none) {
  GlbBuilder builder(1000);
  (void)add_all(builder);
  const Result<std::size_t> size = builder.finish([](std::string_view, std::size_t) -> Status {
    ADD_FAILURE() << "it gives bytes";
    return Success{};
  });
  ASSERT_FALSE(size.ok());
  EXPECT_NE(size.error().message.find("but may have at most 1,000"), std::string::npos) << size.error().message;
}

}  // namespace
}  // namespace chronormal::glb_builder_test
