// The cache as a deep OpenEXR file: a pixel is a voxel, its samples are directed shafts.
//
// x runs along the width; y and z are stacked along the height (row z * ny + y). Channels: shaft,
// count, R.hi, R.lo, G.hi ... (halves of the 64-bit sums) and, for `energy`, measure. Groups of
// shafts (groups.h) follow the shafts of their voxel with shaft = 60 N^4 C + group and a measure;
// their sums are those of their shafts and are left 0. The header says everything else as ql:*
// attributes, among them a digest of header and samples, so that no damage goes unnoticed. Same
// cache, same bytes.
#pragma once

#include "linespace/cache.h"

namespace ql {

inline constexpr int kCacheVersion = 2;

// path "-" is standard output. date_time goes into the header, never the clock.
// Errors: ErrorKind::output.
void write_cache(const std::string& path, const LightCache& cache,
                 const std::string& date_time = "1970:01:01 00:00:00");

// path "-" is standard input. Errors: ErrorKind::input, one line.
LightCache read_cache(const std::string& path);

} // namespace ql
