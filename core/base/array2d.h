// A row-major rectangle of values: (x, y) with x to the right and y downwards.
#pragma once

#include "base/check.h"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace ql {

template<class T>
class Array2D {
  public:
    Array2D() = default;
    Array2D(int width, int height, T value = T())
        : m_width(width), m_height(height), m_values(size_t(width) * size_t(height), value) {}
    Array2D(int width, int height, std::vector<T> values)
        : m_width(width), m_height(height), m_values(std::move(values)) {
        QL_CHECK_EQ(m_values.size(), size_t(width) * size_t(height));
    }

    int width() const { return m_width; }
    int height() const { return m_height; }
    size_t size() const { return m_values.size(); }
    bool empty() const { return m_values.empty(); }

    T& operator()(int x, int y) { return m_values[size_t(y) * size_t(m_width) + size_t(x)]; }
    const T& operator()(int x, int y) const {
        return m_values[size_t(y) * size_t(m_width) + size_t(x)];
    }
    T& operator[](size_t i) { return m_values[i]; }
    const T& operator[](size_t i) const { return m_values[i]; }

    std::span<T> row(int y) { return {&m_values[size_t(y) * size_t(m_width)], size_t(m_width)}; }
    std::span<const T> row(int y) const {
        return {&m_values[size_t(y) * size_t(m_width)], size_t(m_width)};
    }
    std::vector<T>& values() & { return m_values; }
    const std::vector<T>& values() const& { return m_values; }
    // Of a temporary by value: for (v : make().values()) must not walk through what is gone.
    std::vector<T> values() && { return std::move(m_values); }

    bool operator==(const Array2D&) const = default;

  private:
    int m_width = 0;
    int m_height = 0;
    std::vector<T> m_values;
};

// Remainder in [0, n) for any sign of i: toroidal pixel coordinates.
constexpr int wrap(int i, int n) {
    const int r = i % n;
    return r < 0 ? r + n : r;
}

} // namespace ql
