#include "bluenoise/offsets.h"

#include "base/array2d.h"

#include <cmath>
#include <numeric>

namespace ql {

namespace {

// The real solution of g^3 = g + 1.
constexpr double kPlastic = 1.32471795724474602596;
constexpr double kRateX = 1 / kPlastic;
constexpr double kRateY = 1 / (kPlastic * kPlastic);
// The golden section, which spreads the jumps evenly at any time.
constexpr double kRateJump = 0.61803398874989484820;

// The number coprime with n that is nearest to n * rate.
int coprime_step(int n, double rate) {
    const double ideal = n * rate;
    int best = 0;
    double distance = INFINITY;
    for (int step = 0; step < n; ++step)
        if (std::gcd(step, n) == 1 && std::abs(step - ideal) < distance) {
            best = step;
            distance = std::abs(step - ideal);
        }
    return best;
}

int r2_offset(int64_t frame, double rate, int n) {
    return int(int64_t(std::floor(double(frame) * n * rate)) % n);
}

} // namespace

Imath::V2i lattice_step(int width, int height) {
    return {coprime_step(width, kRateX), coprime_step(height, kRateY)};
}

MaskOffsets mask_offsets(OffsetKind kind, int width, int height) {
    return {kind, width, height, lattice_step(width, height)};
}

Imath::V2i mask_offset(const MaskOffsets& offsets, int64_t frame) {
    if (offsets.kind == OffsetKind::lattice)
        return {
            int(frame % offsets.width * wrap(offsets.step.x, offsets.width) % offsets.width),
            int(frame % offsets.height * wrap(offsets.step.y, offsets.height) % offsets.height)};
    return {r2_offset(frame, kRateX, offsets.width), r2_offset(frame, kRateY, offsets.height)};
}

Imath::V2i mask_jumps(const MaskOffsets& offsets, int64_t count) {
    return {0,
            int(count % offsets.height * coprime_step(offsets.height, kRateJump) % offsets.height)};
}

Imath::V2i retarget_step(const MaskOffsets& offsets, int64_t frame) {
    if (offsets.kind == OffsetKind::thesis) return mask_offset(offsets, 1);
    const Imath::V2i step = mask_offset(offsets, frame + 1) - mask_offset(offsets, frame);
    return {wrap(step.x, offsets.width), wrap(step.y, offsets.height)};
}

std::vector<Imath::V2i> retarget_steps(const MaskOffsets& offsets) {
    const Imath::V2i first = mask_offset(offsets, 1);
    if (offsets.kind != OffsetKind::r2) return {first};
    std::vector<Imath::V2i> steps;
    for (const int dy : {0, offsets.height > 1 ? 1 : 0})
        for (const int dx : {0, offsets.width > 1 ? 1 : 0}) {
            const Imath::V2i step((first.x + dx) % offsets.width, (first.y + dy) % offsets.height);
            bool known = false;
            for (const Imath::V2i& other : steps)
                known = known || other == step;
            if (!known) steps.push_back(step);
        }
    return steps;
}

} // namespace ql
