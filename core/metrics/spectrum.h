// Spectra of noise, and the figures that say how blue it is.
//
// Power is that of the mean-free image, so scaled that its mean over all frequencies is the
// variance: white noise has power = variance everywhere. Frequencies are in cycles per pixel, up to
// 1/2 along an axis. Several frames are averaged (Bartlett's method).
// Sources: Ulichney 1988 (radial mean, anisotropy); Belcour and Heitz 2021 (filtered variance).
#pragma once

#include "base/array2d.h"
#include "base/parallel.h"

#include <span>
#include <vector>

namespace ql {

enum class Window { none, hann };

struct Spectrum {
    Array2D<double> power; // frequency u stands at u, -u at width - u; 0 at (0, 0)
    int frames = 0;
    double mean = 0;     // of the image, over frames
    double variance = 0; // mean of power over all frequencies
};

// All frames are of one size. At least one.
Spectrum mean_spectrum(std::span<const Array2D<float>> frames, Window window,
                       const Workers& workers);

// |f|^2 in (cycles per pixel)^2 at an entry of `power`.
double squared_frequency(const Spectrum& spectrum, int u, int v);

// An annulus of radius |f| = ring / n, rounded, where n is the shorter side.
struct RadialBin {
    double frequency = 0; // ring / n
    int samples = 0;      // entries of the spectrum
    double power = 0;     // mean, relative to white noise of the same variance
    double anisotropy =
        0; // dB; 10 log10(variance / mean^2) of the power. -10 log10(frames) if isotropic
};

// From ring 1 on; rings with less than two entries have no anisotropy (NaN).
std::vector<RadialBin> radial_profile(const Spectrum& spectrum);

// Share of the variance at frequencies below f. White: pi f^2 for f up to 1/2.
double low_frequency_share(const Spectrum& spectrum, double f);

// Mean power below f, relative to white noise of the same variance.
double low_frequency_power(const Spectrum& spectrum, double f);

struct FilteredVariance {
    double share = 0;    // of the variance that is left; white: 1 / (4 pi sigma^2)
    double to_white = 0; // the same relative to white noise on this grid
};
// Behind a Gaussian of sigma_px, which is exp(-2 pi^2 sigma^2 |f|^2) on amplitudes.
FilteredVariance filtered_variance(const Spectrum& spectrum, double sigma_px);

// Of the image, around its borders, at a distance of dx, dy pixels; 1 at 0, 0.
double autocorrelation(const Spectrum& spectrum, int dx, int dy);

} // namespace ql
