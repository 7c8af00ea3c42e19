// Slow twins of the BSDF code: textbook formulas in double precision and plain quadrature.
#pragma once

namespace ql::reference {

// Fresnel's equations for a dielectric, both polarisations from Snell's law.
double fresnel(double cos_i, double eta);

// Directional albedo of a GGX reflector with F = 1 and height-correlated Smith masking: integral
// over the normals.
double ggx_albedo(double cos_o, double alpha);

// Directional albedo of the lobe (n + 2)/(2 pi) cos^n about the mirror direction.
double phong_albedo(double cos_o, double exponent);

} // namespace ql::reference
