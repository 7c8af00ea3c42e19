// Sums of many doubles that lose no digits and come out the same on every run.
//
// Neumaier's compensated summation (ZAMM 54, 1974): the rounding error of each addition is kept and
// added at the end. A non-finite term makes the result non-finite.
#pragma once

#include <cmath>

namespace ql {

class Sum {
  public:
    void add(double term) {
        const double total = m_total + term;
        m_rest += std::abs(m_total) >= std::abs(term) ? (m_total - total) + term
                                                      : (term - total) + m_total;
        m_total = total;
    }
    void add(const Sum& other) {
        add(other.m_total);
        m_rest += other.m_rest;
    }
    double value() const { return std::isfinite(m_rest) ? m_total + m_rest : m_total; }

  private:
    double m_total = 0;
    double m_rest = 0;
};

} // namespace ql
