#include "linespace/etendue.h"

#include <array>
#include <cmath>

namespace ql {

namespace {

using Real = long double; // the closed forms lose up to eight digits

struct Interval {
    Real low, high;
    Real length() const { return high - low; }
    Real middle() const { return (low + high) / 2; }
};

// Two-dimensional antiderivative difference: sum of (-1)^(i+j+k+l) f over the corners.
template<class F>
Real corner_sum(const Interval& x, const Interval& xi, const Interval& y, const Interval& eta,
                const F& f) {
    Real sum = 0;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 2; ++k)
                for (int l = 0; l < 2; ++l) {
                    const Real value = f(i ? x.high : x.low, k ? xi.high : xi.low,
                                         j ? y.high : y.low, l ? eta.high : eta.low);
                    sum += (i + j + k + l) % 2 ? -value : value;
                }
    return sum;
}

// p q atan(p / q), and q^2 log terms: continuous at 0.
Real times_atan(Real p, Real q) {
    return q > 0 ? p * q * std::atan(p / q) : 0;
}
Real times_log(Real factor, Real argument) {
    return argument > 0 ? factor * std::log(argument) : 0;
}

// Howell C-13 times pi times the area: rectangles in two planes at distance z.
Real parallel_closed(const Interval& x, const Interval& xi, const Interval& y, const Interval& eta,
                     Real z) {
    return corner_sum(x, xi, y, eta,
                      [&](Real a, Real b, Real c, Real d) {
                          const Real u = a - b, v = c - d;
                          const Real p = std::sqrt(u * u + z * z), q = std::sqrt(v * v + z * z);
                          return times_atan(v, p) + times_atan(u, q) -
                                 times_log(z * z / 2, u * u + v * v + z * z);
                      }) /
           2;
}

// Howell C-15 times pi times the area: x and xi are distances from the line where the planes meet,
// y and eta run along it.
Real perpendicular_closed(const Interval& x, const Interval& xi, const Interval& y,
                          const Interval& eta) {
    return corner_sum(x, xi, y, eta,
                      [&](Real a, Real b, Real c, Real d) {
                          const Real r2 = a * a + b * b, v = c - d;
                          return times_atan(v, std::sqrt(r2)) -
                                 times_log((r2 - v * v) / 4, r2 + v * v);
                      }) /
           2;
}

constexpr std::array<double, 4> kGaussAt = {-0.86113631159405258, -0.33998104358485626,
                                            0.33998104358485626, 0.86113631159405258};
constexpr std::array<double, 4> kGaussWeight = {0.34785484513745386, 0.65214515486254614,
                                                0.65214515486254614, 0.34785484513745386};

// Integral of f over four intervals.
template<class F>
Real gauss(const Interval& x, const Interval& xi, const Interval& y, const Interval& eta,
           const F& f) {
    const auto at = [](const Interval& i, size_t n) {
        return i.middle() + i.length() / 2 * Real(kGaussAt[n]);
    };
    Real sum = 0;
    for (size_t i = 0; i < 4; ++i)
        for (size_t j = 0; j < 4; ++j)
            for (size_t k = 0; k < 4; ++k)
                for (size_t l = 0; l < 4; ++l)
                    sum += Real(kGaussWeight[i] * kGaussWeight[j] * kGaussWeight[k] *
                                kGaussWeight[l]) *
                           f(at(x, i), at(xi, j), at(y, k), at(eta, l));
    return sum * x.length() * xi.length() * y.length() * eta.length() / 16;
}

// Patches much smaller than their distance.
bool is_far(Real distance2, const Interval& x, const Interval& xi, const Interval& y,
            const Interval& eta) {
    constexpr Real kFar = 4;
    const Real size2 = std::max({x.length() * x.length() + y.length() * y.length(),
                                 xi.length() * xi.length() + eta.length() * eta.length()});
    return distance2 > kFar * kFar * size2;
}

Real squared(Real x) {
    return x * x;
}

Real parallel_etendue(const Interval& x, const Interval& xi, const Interval& y, const Interval& eta,
                      Real z) {
    const Real distance2 =
        squared(x.middle() - xi.middle()) + squared(y.middle() - eta.middle()) + z * z;
    if (!is_far(distance2, x, xi, y, eta)) return parallel_closed(x, xi, y, eta, z);
    return gauss(x, xi, y, eta, [&](Real a, Real b, Real c, Real d) {
        return z * z / squared(squared(a - b) + squared(c - d) + z * z);
    });
}

Real perpendicular_etendue(const Interval& x, const Interval& xi, const Interval& y,
                           const Interval& eta) {
    const Real distance2 =
        squared(x.middle()) + squared(xi.middle()) + squared(y.middle() - eta.middle());
    if (!is_far(distance2, x, xi, y, eta)) return perpendicular_closed(x, xi, y, eta);
    return gauss(x, xi, y, eta, [&](Real a, Real b, Real c, Real d) {
        return a * b / squared(a * a + b * b + squared(c - d));
    });
}

} // namespace

EtendueTable::EtendueTable(const V3d& voxel, int patches) : m_patches(patches) {
    const auto n = size_t(patches);
    m_parallel.resize(3 * n * n);
    m_perpendicular.resize(3 * n * n * n);
    for (int axis = 0; axis < 3; ++axis) {
        const Real su = Real(voxel[detail::kAxisU[axis]]) / patches;
        const Real sv = Real(voxel[detail::kAxisV[axis]]) / patches;
        const auto cell = [](int i, Real size) { return Interval{i * size, (i + 1) * size}; };
        for (int i = 0; i < patches; ++i)
            for (int j = 0; j < patches; ++j) {
                parallel(axis, i, j) = double(parallel_etendue(
                    cell(0, su), cell(i, su), cell(0, sv), cell(j, sv), Real(voxel[axis])));
                // The edge runs along this axis; the faces reach away from it along the others.
                for (int k = 0; k < patches; ++k) {
                    const Real along = Real(voxel[axis]) / patches;
                    perpendicular(axis, i, j, k) = double(perpendicular_etendue(
                        cell(i, su), cell(j, sv), cell(0, along), cell(k, along)));
                }
            }
    }
}

double& EtendueTable::parallel(int axis, int du, int dv) {
    return m_parallel[(size_t(axis) * size_t(m_patches) + size_t(du)) * size_t(m_patches) +
                      size_t(dv)];
}

double& EtendueTable::perpendicular(int axis, int depth_a, int depth_b, int along) {
    const auto n = size_t(m_patches);
    return m_perpendicular[((size_t(axis) * n + size_t(depth_a)) * n + size_t(depth_b)) * n +
                           size_t(along)];
}

double EtendueTable::operator()(const ShaftEnds& ends) const {
    auto& self = const_cast<EtendueTable&>(*this);
    const int n = m_patches;
    const int axis_a = ends.entry_face / 2, axis_b = ends.exit_face / 2;
    // Coordinates of both patches along all three axes.
    const auto coordinate = [&](int face, int patch, int axis) {
        return axis == detail::kAxisU[face / 2] ? patch % n : patch / n;
    };
    if (axis_a == axis_b) {
        const int du = std::abs(ends.entry_patch % n - ends.exit_patch % n);
        const int dv = std::abs(ends.entry_patch / n - ends.exit_patch / n);
        return self.parallel(axis_a, du, dv);
    }
    // Depth of a patch: how far from the face that it meets at the edge, counted along the axis of
    // that face.
    const auto depth = [&](int face, int patch, int other_face) {
        const int c = coordinate(face, patch, other_face / 2);
        return other_face % 2 ? n - 1 - c : c;
    };
    const int edge = 3 - axis_a - axis_b;
    const int depth_a = depth(ends.entry_face, ends.entry_patch, ends.exit_face);
    const int depth_b = depth(ends.exit_face, ends.exit_patch, ends.entry_face);
    const int along = std::abs(coordinate(ends.entry_face, ends.entry_patch, edge) -
                               coordinate(ends.exit_face, ends.exit_patch, edge));
    // The first index of the table belongs to the face that reaches along the axis after the edge.
    return axis_b == detail::kAxisU[edge] ? self.perpendicular(edge, depth_a, depth_b, along)
                                          : self.perpendicular(edge, depth_b, depth_a, along);
}

} // namespace ql
