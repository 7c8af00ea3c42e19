#include "rsm/samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ql {
namespace {

double wrapped(double x) {
    return x - std::floor(x);
}

// Points of the lattice of n points and a step, in units of 1/n, modulo 1.
bool is_in_lattice(const V2f& v, int n, int step) {
    const double x = double(v.x) * n, y = double(v.y) * n;
    const double off = wrapped((y - x * step) / n);
    return std::abs(x - std::round(x)) < 1e-3 && std::min(off, 1 - off) < 1e-3;
}

TEST(RsmSamples, CellsOfLatticesAreOfAreaOneNthAndTheirSidesArePoints) {
    for (const int n : {1, 2, 3, 4, 8, 12, 32, 50, 97, 200}) {
        const Lattice lattice = rank1_lattice(n);
        EXPECT_EQ(std::gcd(lattice.step, n), 1) << n;
        const LatticeCell& cell = lattice.cell;
        EXPECT_NEAR(
            std::abs(double(cell.first.x) * cell.second.y - double(cell.first.y) * cell.second.x),
            1.0 / n, 1e-6);
        for (const V2f& v : {cell.first, cell.second, cell.along})
            EXPECT_TRUE(is_in_lattice(v, n, lattice.step)) << n << " " << v;
    }
}

TEST(RsmSamples, LatticesAreEven) {
    // No vector is shorter than two thirds of that of the hexagonal lattice.
    for (const int n : {8, 16, 50, 100, 113, 200}) {
        const LatticeCell cell = rank1_lattice(n).cell;
        const float shortest = std::min(cell.first.length(), cell.second.length());
        EXPECT_GT(shortest, 0.66 * std::sqrt(2 / std::sqrt(3.0) / n)) << n;
    }
}

TEST(RsmSamples, ADiscHasOnePointInEachRingHoweverItIsShifted) {
    const DiscPoints disc = pattern_samples(100, 1, 2).disc;
    ASSERT_EQ(disc.size(), 100u);
    for (const float shift : {0.0f, 0.3f, 0.987f}) {
        std::vector<int> rings;
        double squares = 0;
        for (size_t i = 0; i < 100; ++i) {
            const float xi1 = shifted(disc.xi1[i], shift);
            rings.push_back(int(xi1 * 100));
            squares += double(xi1) * double(xi1);
            EXPECT_NEAR(std::hypot(disc.sine[i], disc.cosine[i]), 1, 1e-6);
        }
        std::sort(rings.begin(), rings.end());
        for (int i = 0; i < 100; ++i)
            EXPECT_EQ(rings[size_t(i)], i);
        EXPECT_NEAR(disc.sum_of_squares(shift), squares, 1e-4);
    }
}

TEST(RsmSamples, AShiftByTheSideOfACellChangesNothing) {
    const FluxPoints flux = importance_samples(42, 1, 2).flux;
    const auto sorted = [&](const V2f& shift) {
        std::vector<std::pair<int, int>> points; // in steps of 1/2100, rounded
        for (size_t i = 0; i < flux.size(); ++i)
            points.emplace_back(std::lround(shifted(flux.u[i], shift.x) * 2100) % 2100,
                                std::lround(double(shifted(flux.v[i], shift.y)) * 2100) % 2100);
        std::sort(points.begin(), points.end());
        return points;
    };
    const auto before = sorted({0, 0});
    for (const CellPlace place : {CellPlace{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
        const auto after = sorted(flux.cell.shift(place));
        ASSERT_EQ(after.size(), before.size());
        for (size_t i = 0; i < before.size(); ++i) {
            EXPECT_NEAR(after[i].first, before[i].first, 1);
            EXPECT_NEAR(after[i].second, before[i].second, 1);
        }
    }
    EXPECT_NE(sorted(flux.cell.shift({0.5f, 0.5f, 0})), before);
}

TEST(RsmSamples, PassesAndSeedsHaveSetsOfTheirOwn) {
    EXPECT_EQ(pattern_samples(5, 1, 2).disc.xi1, pattern_samples(5, 1, 2).disc.xi1);
    EXPECT_NE(pattern_samples(5, 1, 2).disc.xi1, pattern_samples(5, 1, 3).disc.xi1);
    EXPECT_NE(pattern_samples(5, 1, 2).disc.sine, pattern_samples(5, 2, 2).disc.sine);
    EXPECT_NE(importance_samples(5, 1, 2).flux.u, importance_samples(5, 1, 3).flux.u);
}

TEST(RsmSamples, ImportanceSplitsItsSamplesInTwo) {
    for (const int n : {1, 2, 7}) {
        const PassSamples samples = importance_samples(n, 0, 0);
        EXPECT_EQ(int(samples.flux.size() + samples.disc.size()), n);
        EXPECT_GE(samples.flux.size(), samples.disc.size());
    }
}

TEST(RsmSamples, ShiftsStayBelowOne) {
    EXPECT_LT(shifted(0x1.fffffep-1f, 0x1.fffffep-1f), 1);
    EXPECT_LT(shifted(1 - 0x1p-53, 0x1.fffffep-1f), 1);
    EXPECT_EQ(shifted(0.75f, 0.5f), 0.25f);
    const Array2D<float> mask(2, 2, 0x1.fffffep-1f);
    const ShiftSource blue{Rotation::blue, &mask, 0}, white{Rotation::white, nullptr, 0};
    const LatticeCell cell = rank1_lattice(3).cell;
    for (uint32_t pass = 0; pass < 1000; ++pass)
        for (const ShiftSource& source : {blue, white}) {
            const V2f shift = cell.shift(source.place(3, 5, pass));
            for (const float s : {shift.x, shift.y}) {
                EXPECT_GE(s, 0);
                EXPECT_LT(s, 1);
            }
        }
}

TEST(RsmSamples, NoRotationIsNoShift) {
    EXPECT_EQ((ShiftSource{}.place(3, 4, 5)), CellPlace{});
}

TEST(RsmSamples, AMaskRepeatsAndWhiteNoiseDoesNot) {
    Array2D<float> mask(4, 3);
    for (size_t i = 0; i < mask.size(); ++i)
        mask[i] = float(i) / 12;
    const ShiftSource blue{Rotation::blue, &mask, 0}, white{Rotation::white, nullptr, 0};
    EXPECT_EQ(blue.place(1, 2, 0), blue.place(5, 5, 0));
    EXPECT_NE(blue.place(1, 2, 0), blue.place(2, 2, 0));
    EXPECT_NE(white.place(1, 2, 0), white.place(5, 5, 0));
}

} // namespace
} // namespace ql
