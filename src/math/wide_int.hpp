// Integers of a fixed number of bits, for what double precision and 128 bits can't tell. Heavy:
// for sources that need it only.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>

namespace sightline {

/// Signed, without checks: whoever uses one proves that its values fit.
template <unsigned kBits>
using WideInt = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    kBits, kBits, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;

using Int256 = WideInt<256>;
using Int512 = WideInt<512>;

}  // namespace sightline
