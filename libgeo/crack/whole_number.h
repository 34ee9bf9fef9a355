// Whole numbers of any size, and the few operations of crack/points.cpp on them: GMP's, or those of
// Boost.Multiprecision in a build without GMP. Both give the same numbers.
#pragma once

#include <cstdint>

#ifdef KERF_BOOST_INTEGERS
#include <boost/multiprecision/cpp_int.hpp>
#else
#include <gmpxx.h>
#endif

namespace geo::crack {

#ifdef KERF_BOOST_INTEGERS

// Numbers up to 512 bits need no memory of their own: nearly all coordinates of a point have fewer.
using WholeBackend = boost::multiprecision::cpp_int_backend<512, 0, boost::multiprecision::signed_magnitude,
                                                            boost::multiprecision::unchecked,
                                                            std::allocator<boost::multiprecision::limb_type>>;
using Whole = boost::multiprecision::number<WholeBackend, boost::multiprecision::et_off>;

/// −1, 0 or 1.
inline int sign_of(const Whole& x) { return x.sign(); }
/// Number of bits of |x|. Precondition: x is not 0.
inline long bit_length(const Whole& x) { return static_cast<long>(boost::multiprecision::msb(abs(x))) + 1; }
/// x · 2^by.
inline Whole shifted(const Whole& x, long by) { return x << by; }
/// Quotient and remainder. Preconditions: a ≥ 0, b > 0.
inline void divide(const Whole& a, const Whole& b, Whole& quotient, Whole& remainder) {
  boost::multiprecision::divide_qr(a, b, quotient, remainder);
}
/// A number from 0 to 2⁶⁴ − 1.
inline std::uint64_t small(const Whole& x) { return static_cast<std::uint64_t>(x); }

#else

using Whole = mpz_class;
static_assert(sizeof(long) == 8);

/// −1, 0 or 1.
inline int sign_of(const Whole& x) { return sgn(x); }
/// Number of bits of |x|. Precondition: x is not 0.
inline long bit_length(const Whole& x) { return static_cast<long>(mpz_sizeinbase(x.get_mpz_t(), 2)); }
/// x · 2^by.
inline Whole shifted(const Whole& x, long by) { return Whole(x << static_cast<mp_bitcnt_t>(by)); }
/// Quotient and remainder. Preconditions: a ≥ 0, b > 0.
inline void divide(const Whole& a, const Whole& b, Whole& quotient, Whole& remainder) {
  mpz_tdiv_qr(quotient.get_mpz_t(), remainder.get_mpz_t(), a.get_mpz_t(), b.get_mpz_t());
}
/// A number from 0 to 2⁶⁴ − 1.
inline std::uint64_t small(const Whole& x) { return x.get_ui(); }

#endif

}  // namespace geo::crack
