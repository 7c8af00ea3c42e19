// The discrete Fourier transform, of any length, in double.
//
//     F(u, v) = sum_x,y f(x, y) exp(-2 pi i (u x / w + v y / h)), not normalised
//
// Frequency -u stands at w - u. Powers of two by Cooley and Tukey 1965, other lengths by Bluestein
// 1970 (a convolution of a power of two), so that primes cost no more than a few times the next
// one.
#pragma once

#include "base/array2d.h"
#include "base/parallel.h"

#include <complex>
#include <span>
#include <vector>

namespace ql {

// A plan for one length. transform() may be called from several threads.
class FourierPlan {
  public:
    explicit FourierPlan(size_t length); // 1 or more

    size_t length() const { return m_length; }
    // In place.
    void transform(std::span<std::complex<double>> values) const;

  private:
    void transform_power_of_two(std::span<std::complex<double>> values) const;
    void transform_bluestein(std::span<std::complex<double>> values) const;

    size_t m_length;
    size_t m_padded;                            // the power of two that is worked on
    std::vector<std::complex<double>> m_roots;  // exp(-2 pi i k / padded), k < padded / 2
    std::vector<std::complex<double>> m_chirp;  // exp(-pi i k^2 / length); empty: not needed
    std::vector<std::complex<double>> m_filter; // transform of the conjugate chirp
};

Array2D<std::complex<double>> fourier(const Array2D<double>& image, const Workers& workers);

} // namespace ql
