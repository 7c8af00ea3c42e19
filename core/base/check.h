// Checks for programmer mistakes. Both values are part of the message, and the check stays in
// release builds; keep it out of per-sample code, where QL_DCHECK is for debug builds only.
#pragma once

#include "base/error.h"

namespace ql::detail {

template<class A, class B>
void check_equal(const A& a, const B& b, const char* expression, const char* file, int line) {
    if (!(a == b))
        throw Error(ErrorKind::internal,
                    fmt::format("{}:{}: {} failed ({} against {})", file, line, expression, a, b));
}

inline void check_true(bool holds, const char* expression, const char* file, int line) {
    if (!holds)
        throw Error(ErrorKind::internal, fmt::format("{}:{}: {} failed", file, line, expression));
}

} // namespace ql::detail

#define QL_CHECK(condition) ::ql::detail::check_true((condition), #condition, __FILE__, __LINE__)
#define QL_CHECK_EQ(a, b) ::ql::detail::check_equal((a), (b), #a " == " #b, __FILE__, __LINE__)
#ifdef NDEBUG
#define QL_DCHECK(condition) ((void)0)
#else
#define QL_DCHECK(condition) QL_CHECK(condition)
#endif
