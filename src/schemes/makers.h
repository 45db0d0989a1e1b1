/// The functions that create schemes, one or more for each file of this folder. scheme.cpp calls them by the name of a
/// scheme.
#ifndef CHRONORMAL_SCHEMES_MAKERS_H_
#define CHRONORMAL_SCHEMES_MAKERS_H_

#include <cstdint>
#include <memory>

#include "chronormal/schemes/scheme.h"

namespace chronormal::inline internal {

std::unique_ptr<Scheme> make_recompute();                             // recompute_scheme.cpp
std::unique_ptr<Scheme> make_polynomial();                            // polynomial.cpp
std::unique_ptr<Scheme> make_rational();                              // rational.cpp
std::unique_ptr<Scheme> make_lagrange(std::size_t degree);            // lagrange.cpp
std::unique_ptr<Scheme> make_scaled_linear();                         // linear_scaled.cpp
std::unique_ptr<Scheme> make_slerp();                                 // slerp.cpp
std::unique_ptr<Scheme> make_de_casteljau(std::size_t normal_count);  // de_casteljau.cpp
std::unique_ptr<Scheme> make_quaternion_matrix();                     // quaternion.cpp
std::unique_ptr<Scheme> make_quaternion_edge();
std::unique_ptr<Scheme> make_quaternion_polar();
std::unique_ptr<Scheme> make_quaternion_random(std::uint64_t seed);
std::unique_ptr<Scheme> make_quaternion_optimal();  // quaternion_optimal.cpp
std::unique_ptr<Scheme> make_circle();              // circle.cpp
std::unique_ptr<Scheme> make_timed_circle();

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_MAKERS_H_
