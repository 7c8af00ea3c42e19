// Marks a function whose loops gain from wide vectors.
//
// It is compiled twice, for any processor of its kind and for those with AVX2, and the linker's
// resolver takes the one that fits. Both give the same bits: no operation is fused or reordered.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define QL_WIDE_KERNEL __attribute__((target_clones("avx2", "default")))
#else
#define QL_WIDE_KERNEL
#endif
