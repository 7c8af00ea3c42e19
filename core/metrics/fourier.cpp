#include "metrics/fourier.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace ql {

namespace {

using Complex = std::complex<double>;

// exp(-2 pi i k / n)
Complex root(size_t k, size_t n) {
    const double angle = -2 * std::numbers::pi * double(k) / double(n);
    return {std::cos(angle), std::sin(angle)};
}

void reverse_bits(std::span<Complex> values) {
    for (size_t i = 1, j = 0; i < values.size(); ++i) {
        size_t bit = values.size() >> 1;
        for (; j & bit; bit >>= 1)
            j ^= bit;
        j ^= bit;
        if (i < j) std::swap(values[i], values[j]);
    }
}

// Without the checks for infinities that operator* makes.
Complex product(Complex a, Complex b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

} // namespace

FourierPlan::FourierPlan(size_t length)
    : m_length(length),
      m_padded(std::has_single_bit(length) ? length : std::bit_ceil(2 * length - 1)) {
    QL_CHECK(length > 0);
    for (size_t k = 0; k < m_padded / 2; ++k)
        m_roots.push_back(root(k, m_padded));
    if (m_padded == m_length) return;
    // k^2 modulo 2 n, so that the angle stays small and exact
    for (size_t k = 0; k < length; ++k)
        m_chirp.push_back(root(k * k % (2 * length), 2 * length));
    m_filter.assign(m_padded, 0);
    for (size_t k = 0; k < length; ++k) {
        m_filter[k] = std::conj(m_chirp[k]);
        m_filter[(m_padded - k) % m_padded] = std::conj(m_chirp[k]);
    }
    transform_power_of_two(m_filter);
}

void FourierPlan::transform(std::span<Complex> values) const {
    QL_CHECK_EQ(values.size(), m_length);
    if (m_chirp.empty())
        transform_power_of_two(values);
    else
        transform_bluestein(values);
}

void FourierPlan::transform_power_of_two(std::span<Complex> values) const {
    const size_t n = values.size();
    reverse_bits(values);
    for (size_t half = 1; half < n; half *= 2) {
        const size_t stride = n / (2 * half);
        for (size_t start = 0; start < n; start += 2 * half)
            for (size_t k = 0; k < half; ++k) {
                const Complex odd = product(values[start + half + k], m_roots[k * stride]);
                const Complex even = values[start + k];
                values[start + k] = even + odd;
                values[start + half + k] = even - odd;
            }
    }
}

void FourierPlan::transform_bluestein(std::span<Complex> values) const {
    std::vector<Complex> work(m_padded, 0);
    for (size_t k = 0; k < m_length; ++k)
        work[k] = product(values[k], m_chirp[k]);
    transform_power_of_two(work);
    // The inverse transform is the conjugate of the transform of the conjugate
    for (size_t k = 0; k < m_padded; ++k)
        work[k] = std::conj(product(work[k], m_filter[k]));
    transform_power_of_two(work);
    for (size_t k = 0; k < m_length; ++k)
        values[k] = product(std::conj(work[k]), m_chirp[k]) / double(m_padded);
}

Array2D<Complex> fourier(const Array2D<double>& image, const Workers& workers) {
    QL_CHECK(!image.empty());
    Array2D<Complex> result(image.width(), image.height());
    std::copy(image.values().begin(), image.values().end(), result.values().begin());

    const FourierPlan rows{size_t(image.width())};
    workers.for_each(size_t(image.height()), [&](size_t y) { rows.transform(result.row(int(y))); });

    // Columns, a few at a time: neighbours share cache lines
    constexpr size_t kColumns = 8;
    const FourierPlan columns{size_t(image.height())};
    const size_t width = size_t(image.width()), height = size_t(image.height());
    workers.for_each((width + kColumns - 1) / kColumns, [&](size_t group) {
        const size_t first = group * kColumns;
        const size_t count = std::min(kColumns, width - first);
        std::vector<Complex> lines(count * height);
        for (size_t y = 0; y < height; ++y)
            for (size_t c = 0; c < count; ++c)
                lines[c * height + y] = result[y * width + first + c];
        for (size_t c = 0; c < count; ++c)
            columns.transform(std::span(lines).subspan(c * height, height));
        for (size_t y = 0; y < height; ++y)
            for (size_t c = 0; c < count; ++c)
                result[y * width + first + c] = lines[c * height + y];
    });
    return result;
}

} // namespace ql
